// SPDX-License-Identifier: BSD-3-Clause
#include "learners.hpp"

#include <chrono>
#include <cmath>
#include <limits>

#include "dispatch.hpp"
#include "searches.hpp"
#include "vernier/regression/back_propagation.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ensemble.hpp"
#include "vernier/regression/gaussian_process.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/op_elm.hpp"
#include "vernier/regression/os_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/trigonometric_regression.hpp"
#include "vernier/regression/var_pro_elm.hpp"

namespace support {

namespace {

namespace vn = vernier;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Number of evaluations that take some seconds, estimated from a few random points.
vn::Index evaluations_in(double seconds, const AnyObjective& objective, const vn::Box& box, std::uint64_t seed) {
  vn::Rng rng(seed);
  vn::MatrixX some(box.dimension(), 20);
  for (vn::Index k = 0; k < some.cols(); ++k)
    for (vn::Index d = 0; d < some.rows(); ++d) some(d, k) = rng.uniform(box.lower(d), box.upper(d));
  vn::VectorX fitness(some.cols());
  const auto start = Clock::now();
  objective(some, fitness);
  return std::max<vn::Index>(static_cast<vn::Index>(seconds / seconds_since(start) * 20), 100);
}

template <int N, class Predictor>
LearnedErrors<N> errors_of(Predictor predictor) {
  return [predictor = std::move(predictor)](const vn::JointRows<N>& joints) -> vn::PointRows {
    return predictor.predict(joints);
  };
}

/// A learner on samples of N joints.
template <int N>
class Learning {
 public:
  Learning(const Method& method, const Plan& plan, const vn::JointRows<N>& joints, const vn::PointRows& errors,
           const vn::FitOptions& options, Convergence& record)
      : method_(method), plan_(plan), joints_(joints), errors_(errors), options_(options), record_(record) {}

  LearnedErrors<N> run() const {
    const std::string& name = method_.learner;
    const int nodes = plan_.nodes;
    const bool until_time_is_over = plan_.seconds > 0 && method_.search.empty();
    if (name == "elm") return tunable(mapped(vn::Elm{.hidden_nodes = nodes}));
    if (name == "ridge_elm") return tunable(mapped(vn::RidgeElm{.hidden_nodes = nodes}));
    if (name == "var_pro_elm")
      return tunable(mapped(vn::VarProElm{.hidden_nodes = nodes, .starts = until_time_is_over ? 1000000 : 1}));
    if (name == "bp_lm") return plain(mapped(vn::BackPropagation{.hidden_nodes = nodes}));
    if (name == "bp_adam") return plain(mapped(vn::BackPropagation{.hidden_nodes = nodes, .training = vn::Adam{}}));
    if (name == "kernel_elm") return plain(mapped(vn::KernelElm{}));
    if (name == "gp") return plain(mapped(vn::GaussianProcess{}));
    if (name == "os_elm") return plain(mapped(vn::OsElm{.hidden_nodes = nodes}));
    if (name == "op_elm") return plain(mapped(vn::OpElm{.hidden_nodes = nodes}));
    if (name == "trig") return plain(vn::TrigonometricRegression{});
    if (name == "bagged") return plain(vn::Ensemble{mapped(vn::RidgeElm{.hidden_nodes = nodes}), 20, 0.6, false});
    throw std::logic_error("no learner is called " + name);
  }

 private:
  template <class R>
  R mapped(R recipe) const {
    if (method_.map == "raw") recipe.input_map = vn::InputMap::raw;
    if (method_.map == "sincos") recipe.input_map = vn::InputMap::sines_and_cosines;
    if (method_.map == "products") recipe.input_map = vn::InputMap::sine_cosine_products;
    return recipe;
  }

  /// Fitted as it is, or at the result of a search.
  template <class R>
  LearnedErrors<N> tunable(const R& recipe) const {
    if (method_.search.empty()) return plain(recipe);
    const AnyObjective objective = recipe.objective(joints_, errors_);
    const vn::Box box = recipe.box(N);
    const vn::Index evaluations =
        plan_.seconds > 0 ? evaluations_in(plan_.seconds, objective, box, options_.seed) : plan_.evaluations;
    const auto start = Clock::now();
    const auto watch = [&](const vn::Progress& progress) {
      record_.evaluations.push_back(static_cast<double>(progress.evaluations));
      record_.seconds.push_back(seconds_since(start));
      record_.best.push_back(progress.best);
      // a tenth of grace, so that a schedule that ends with the evaluations does so; what the search itself costs was
      // not counted in them
      return options_.observer(progress) && (plan_.seconds <= 0 || seconds_since(start) < 1.1 * plan_.seconds);
    };
    const vn::SearchResult found = run_search(method_.search, objective, box, evaluations, options_.seed, watch);
    return errors_of<N>(recipe.fit_at(joints_, errors_, found.best));
  }

  template <class R>
  LearnedErrors<N> plain(const R& recipe) const {
    const auto start = Clock::now();
    const auto watch = [&](const vn::Progress& progress) {
      return options_.observer(progress) && (plan_.seconds <= 0 || seconds_since(start) < plan_.seconds);
    };
    return errors_of<N>(recipe.fit(joints_, errors_, {.seed = options_.seed, .observer = watch}));
  }

  const Method& method_;
  const Plan& plan_;
  const vn::JointRows<N>& joints_;
  const vn::PointRows& errors_;
  const vn::FitOptions& options_;
  Convergence& record_;
};

}  // namespace

template <int N>
LearnedErrors<N> learn(const Method& method, const Plan& plan, const vernier::JointRows<N>& joints,
                       const vernier::PointRows& errors, const vernier::FitOptions& options, Convergence& record) {
  return Learning<N>(method, plan, joints, errors, options, record).run();
}

#define VERNIER_INSTANTIATE(N)                                                                 \
  template LearnedErrors<N> learn<N>(const Method&, const Plan&, const vernier::JointRows<N>&, \
                                     const vernier::PointRows&, const vernier::FitOptions&, Convergence&);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
