// SPDX-License-Identifier: BSD-3-Clause
// A search that does not say when it has ended, tuning a regressor.
// expect: `done(state)` must be const and return bool
#include <vernier/regression/elm.hpp>
#include <vernier/search/tuned.hpp>

namespace vn = vernier;

struct Strategy {
  struct State {
    vn::VectorX best;
    double best_fitness;
    vn::Index generation;
  };
  State start(const vn::Box& box, std::uint64_t seed, vn::Evaluate evaluate) const;
  void step(State& state, const vn::Box& box, vn::Evaluate evaluate) const;
#ifndef MISTAKE
  bool done(const State& state) const;
#endif
  vn::Index next_evaluations(const State& state) const;
};

const vn::Tuned tuned{vn::Elm{}, Strategy{}};
