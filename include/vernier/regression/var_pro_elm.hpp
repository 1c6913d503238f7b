#pragma once

/// @file
/// An extreme learning machine whose hidden layer is trained by gradients: variable projection.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "vernier/regression/elm_predictor.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/normal_equations.hpp"
#include "vernier/regression/variable_projection.hpp"

namespace vernier {

namespace detail {

/// Targets less their mean, all columns in one unit, that of their common spread: outputs weigh as they are.
struct CommonScaling {
  VectorX mean;   ///< of each column
  double spread;  ///< root of the mean squared distance from the mean; 1 where that is rounding

  /// Of n x m targets with n weights; null: all the same.
  template <class Targets>
  explicit CommonScaling(const Eigen::MatrixBase<Targets>& targets, const VectorX* weights = nullptr) {
    const auto mean_of = [&](const auto& rows) -> VectorX {
      if (weights == nullptr) return rows.colwise().mean().transpose();
      return rows.transpose() * *weights / weights->sum();
    };
    mean = mean_of(targets);
    spread = std::sqrt(mean_of((targets.rowwise() - mean.transpose()).rowwise().squaredNorm())(0));
    if (!(spread > 1e-12 * targets.cwiseAbs().maxCoeff())) spread = 1;
  }

  template <class Targets>
  MatrixX apply(const Eigen::MatrixBase<Targets>& targets) const {
    return (targets.rowwise() - mean.transpose()) / spread;
  }
};

/// The reduced objective of `VarProElm` for searches: see `VarProElm::objective`.
class VarProTrainingError {
 public:
  VarProTrainingError(const HiddenLayer& layer, MatrixX features, MatrixX targets, double ridge, const VectorX* weights)
      : layer_(layer), features_(std::move(features)), targets_(std::move(targets)), ridge_(ridge) {
    if (weights != nullptr) weights_ = *weights;
  }

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  template <class Population, class Fitness>
  void operator()(const Eigen::MatrixBase<Population>& population, Fitness&& fitness) const {
    const VectorX roots = weights_or_ones(weights(), targets_.rows()).cwiseSqrt();
    const double n = roots.squaredNorm(), target_square = (roots.asDiagonal() * targets_).squaredNorm();
    MatrixX ones_and_targets(targets_.rows(), targets_.cols() + 1);
    ones_and_targets << VectorX::Ones(targets_.rows()), targets_;
    NormalEquations equations(layer_, features_, ones_and_targets, widest_instruction_set(), false,
                              weights_ ? roots.data() : nullptr);
    std::optional<VariableProjection> projection;
    for (Index k = 0; k < population.cols(); ++k) {
      double objective = -1;
      if (NormalEquations::supports(layer_.activation)) {
        equations.form(population.col(k));
        const VectorX sum = equations.right().row(0).transpose();
        MatrixX gram = equations.gram();
        gram -= sum * sum.transpose() / n;
        const auto right = equations.right().bottomRows(targets_.cols());
        objective = objective_from_products(gram, right, target_square, ridge_weights(gram, right, ridge_ * n),
                                            ridge_ * n, equations.gram().trace());
      }
      if (!(objective >= 0)) {  // too nearly perfect or too badly conditioned to be told from the products
        if (!projection) projection.emplace(layer_, features_, targets_, ridge_, weights());
        objective = projection->evaluate(population.col(k)) * n;
      }
      fitness(k) = objective / n;
    }
  }

  /// Its exact gradient with respect to the hidden weights.
  template <class Theta>
  VectorX gradient(const Eigen::MatrixBase<Theta>& theta) const {
    VariableProjection projection(layer_, features_, targets_, ridge_, weights());
    require(theta.size() == projection.dimension(), "VarProElm: ", theta.size(), " hidden weights, expected ",
            projection.dimension());
    projection.evaluate(theta);
    return projection.gradient();
  }

 private:
  const VectorX* weights() const { return weights_ ? &*weights_ : nullptr; }

  HiddenLayer layer_;
  MatrixX features_, targets_;
  double ridge_;
  std::optional<VectorX> weights_;
};

/// Levenberg-Marquardt on the hidden weights. The damping follows the ratio of gained to predicted decrease.
/// @param problem    `evaluate`, `gradient` and `curvature`, as of `VariableProjection`
/// @param theta      where to start; then the best weights found
/// @param iterations steps tried
/// @param tolerance  ten accepted steps that together lower the value by less than this share end it
/// @param watch      `bool(double best)`, called for the start and after every step; false ends it
/// @return           the value at theta
/// @cite Levenberg 1944; Marquardt 1963; Nielsen 1999
template <class Problem, class Watch>
double levenberg_marquardt(Problem& problem, VectorX& theta, int iterations, double tolerance, ExecutorRef executor,
                           Watch&& watch) {
  constexpr double rounding = 1e-26;  // of targets of spread 1
  double value = problem.evaluate(theta), at_check = value;
  double damping = 0.1, raise = 2;
  int accepted = 0;
  bool moved = true;
  VectorX gradient, scale;
  MatrixX curvature, damped;
  bool go_on = watch(value) && std::isfinite(value);
  for (int iteration = 0; go_on && iteration < iterations && value > rounding; ++iteration) {
    if (moved) {
      gradient = problem.gradient();
      problem.curvature(curvature, executor);
      if (!(curvature.diagonal().maxCoeff() > 0)) break;  // every node is saturated or unused
      // Nodes that hardly matter at the moment must not be thrown far away.
      scale = curvature.diagonal().cwiseMax(1e-3 * curvature.diagonal().mean());
      moved = false;
    }
    damped = curvature;
    damped.diagonal() += damping * scale;
    const Eigen::LLT<Eigen::Ref<MatrixX>> factor(damped);  // in place
    if (factor.info() == Eigen::Success) {
      const VectorX step = -factor.solve(gradient);
      const double predicted = 0.5 * (damping * step.dot(scale.cwiseProduct(step)) - gradient.dot(step));
      if (!(predicted > 1e-15 * value)) break;  // the value cannot tell such steps apart
      const VectorX trial = theta + step;
      const double found = problem.evaluate(trial);
      if (found < value) {
        const double surplus = 2 * (value - found) / predicted - 1;
        damping *= std::max(1.0 / 3, 1 - surplus * surplus * surplus);
        raise = 2;
        theta = trial;
        value = found;
        moved = true;
      }
    }
    if (!moved) {
      damping *= raise;
      raise *= 2;
    } else if (++accepted % 10 == 0) {
      go_on = at_check - value >= tolerance * value;
      at_check = value;
    }
    go_on = watch(value) && go_on;
  }
  return value;
}

}  // namespace detail

/// Extreme learning machine with a trained hidden layer. The output weights are always the best ones for the hidden
/// layer, so the training error is a function of the hidden weights alone, and Levenberg-Marquardt lowers it: seconds,
/// where a population search takes minutes and ends higher. Minimises the training error: give it thousands of samples,
/// or `RidgeElm` few. The mean of the targets is not penalised; targets keep their units, so outputs weigh as they are.
/// `Tuned{VarProElm{}, Pso{}}` lets a search choose where the training starts.
/// @complexity an iteration sums up n nodes^2 (features + 1)^2 / 4 products and solves for nodes (features + 1) weights
/// @cite Golub and Pereyra 1973; Kaufman 1975
struct VarProElm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  double weight_limit = 1;  ///< hidden weights and biases start in [-limit, limit]; training may leave it
  double ridge = 1e-10;     ///< of the output weights, for targets of unit spread, per sample; in (0, 1)
  int iterations = 100;     ///< steps tried from each start; 0: the hidden layer as it is drawn
  double tolerance = 1e-4;  ///< ten steps that together lower the objective by less than this share end the training
  int starts = 1;           ///< hidden layers drawn and trained; the best is kept

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Length of the vector of hidden weights that a search moves.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Where a search looks for a start.
  Box box(int inputs) const { return layer().box(inputs); }

  /// What training lowers, as a function of hidden weights: `|H beta + C - T|^2 / n + ridge |beta|^2` at its minimum
  /// over beta and C, whose rows are equal, T being the targets in units of their spread; the mean alone has 1. Its
  /// member `gradient(theta)` is the exact gradient.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::VarProTrainingError objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                        const VectorX* weights = nullptr) const {
    validate(inputs, targets, {.weights = weights});
    const MatrixX mapped = layer().map(inputs);
    return {layer(), layer().scaling(mapped).apply(mapped), detail::CommonScaling(targets, weights).apply(targets),
            ridge, weights};
  }

  /// Training that starts from given hidden weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  /// @param options weights, executor, and observer, which sees every step and the objective so far
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit_at(const Eigen::MatrixBase<X>& inputs,
                                                                  const Eigen::MatrixBase<Y>& targets,
                                                                  const VectorX& theta,
                                                                  const FitOptions& options = {}) const {
    validate(inputs, targets, options);
    require(theta.size() == dimension(X::ColsAtCompileTime), "VarProElm: ", theta.size(), " hidden weights, expected ",
            dimension(X::ColsAtCompileTime));
    return train<X::ColsAtCompileTime, Y::ColsAtCompileTime>(inputs, targets, 1, options,
                                                             [&](int) -> const VectorX& { return theta; });
  }

  /// Training that starts from hidden weights drawn from the seed. The first start is what `Elm` draws.
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    validate(inputs, targets, options);
    return train<X::ColsAtCompileTime, Y::ColsAtCompileTime>(inputs, targets, starts, options, [&](int start) {
      return layer().draw(X::ColsAtCompileTime,
                          start == 0 ? options.seed : child_seed(options.seed, static_cast<std::uint64_t>(start)));
    });
  }

 private:
  template <int Inputs, int Outputs, class X, class Y, class Draw>
  ElmPredictor<Inputs, Outputs> train(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                      int count, const FitOptions& options, Draw&& draw) const {
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling in = layer().scaling(mapped);
    const detail::CommonScaling out(targets, options.weights);
    detail::VariableProjection projection(layer(), in.apply(mapped), out.apply(targets), ridge, options.weights);
    VectorX best;
    double least = std::numeric_limits<double>::infinity();
    Progress progress{-1, 0, least};
    bool go_on = true;
    for (int start = 0; go_on && start < count; ++start) {
      VectorX theta = draw(start);
      const double value =
          detail::levenberg_marquardt(projection, theta, iterations, tolerance, options.executor, [&](double so_far) {
            ++progress.generation;
            ++progress.evaluations;
            progress.best = std::min(least, so_far);
            return go_on = options.observer(progress);
          });
      if (value < least) {
        least = value;
        best = theta;
      }
    }
    require(std::isfinite(least), "VarProElm: the hidden layer is not finite at the weights to start from");
    projection.evaluate(best);  // the last step tried may have been another one
    return {layer(), in, best, out.spread * projection.beta(), out.mean + out.spread * projection.offset()};
  }

  template <class X, class Y>
  void validate(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                const FitOptions& options = {}) const {
    layer().validate("VarProElm");
    require(ridge > 0 && ridge < 1, "VarProElm: ridge is ", ridge, ", must lie in (0, 1)");
    require(iterations >= 0, "VarProElm: iterations is ", iterations, ", must not be negative");
    require(tolerance >= 0 && tolerance < 1, "VarProElm: tolerance is ", tolerance, ", must lie in [0, 1)");
    require(starts >= 1, "VarProElm: starts is ", starts, ", must be at least 1");
    detail::require_samples("VarProElm", inputs, targets, options);
  }
};

}  // namespace vernier
