#pragma once

/// @file
/// Points drawn at random: the baseline every search has to better.

#include "vernier/search/state.hpp"

namespace vernier {

/// Draws points uniformly from the box and keeps the best.
struct RandomSearch {
  int individuals = 50;     ///< points a generation, at least 1
  Index generations = 300;  ///< after the first population

  /// Between two generations.
  struct State : CommonState {
    /// Whether the sizes of the members agree.
    bool consistent() const { return true; }
  };

  /// The first points.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    require(individuals >= 1, "RandomSearch: individuals is ", individuals, ", must be at least 1");
    require(generations >= 0, "RandomSearch: generations is ", generations, ", must not be negative");
    State s;
    s.rng = Rng(seed);
    look(s, box, evaluate);
    return s;
  }

  /// As many others.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    look(s, box, evaluate);
    ++s.generation;
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

 private:
  void look(State& s, const Box& box, Evaluate evaluate) const {
    const MatrixX points = uniform_points(box, individuals, s.rng);
    VectorX fitness;
    evaluate(points, fitness);
    s.keep_best(points, fitness);
  }
};

}  // namespace vernier
