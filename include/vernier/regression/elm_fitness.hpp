#pragma once

/// @file
/// What a search over an ELM's hidden weights minimises: the training error, or the error of samples held out.

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/normal_equations.hpp"

namespace vernier::detail {

/// Fitness of hidden weights; columns of a population are independent. Training error:
/// `min over beta of (|H beta - T|^2 + lambda |beta|^2) / n`. With samples held out that beta is found from the others,
/// and `|H beta - T|^2 / n` is that of the held-out ones; products of theirs give it, at the price of a training sample
/// each.
/// (A template, so that only its users pay for compiling it.)
template <class Scalar>
class ElmFitnessOf {
 public:
  /// @param layer           the nodes
  /// @param features        n x f, scaled
  /// @param targets         n x m, scaled
  /// @param relative_lambda ridge, relative to tr(H'H) / nodes
  /// @param hold_out_every  each so-manieth sample is held out; 0: none
  /// @param weights         of the samples; null: all the same
  ElmFitnessOf(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets, double relative_lambda,
               int hold_out_every, const VectorX* weights)
      : layer_(layer), relative_lambda_(relative_lambda) {
    std::vector<Index> fitted, held_out;
    for (Index i = 0; i < features.rows(); ++i)
      (hold_out_every > 0 && (i + 1) % hold_out_every == 0 ? held_out : fitted).push_back(i);
    fitted_ = Samples(features, targets, weights, fitted);
    held_out_ = Samples(features, targets, weights, held_out);
  }

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  template <class Population, class Fitness>
  void operator()(const Eigen::MatrixBase<Population>& population, Fitness&& fitness) const {
    const bool holds_out = held_out_.targets.rows() > 0, fast = NormalEquations::supports(layer_.activation);
    std::optional<NormalEquations> equations, judge;
    if (fast) equations.emplace(fitted_.equations(layer_));
    if (fast && holds_out) judge.emplace(held_out_.equations(layer_));
    for (Index k = 0; k < population.cols(); ++k) {
      double error = -1;
      if (fast) {
        equations->form(population.col(k));
        if (holds_out) judge->form(population.col(k));
        error = from_products(*equations, judge);
      }
      // too nearly perfect or too badly conditioned to be told from the products
      if (!(error >= 0)) error = from_samples(population.col(k), holds_out);
      fitness(k) = error / (holds_out ? held_out_ : fitted_).total_weight;
    }
  }

 private:
  /// Some of the samples, their rows multiplied by the roots of their weights.
  struct Samples {
    MatrixX features, targets;
    VectorX roots;  // empty: all weights are 1
    double total_weight = 0;

    Samples() = default;
    Samples(const MatrixX& all_features, const MatrixX& all_targets, const VectorX* weights,
            const std::vector<Index>& rows)
        : features(all_features(rows, Eigen::all)), targets(all_targets(rows, Eigen::all)) {
      total_weight = static_cast<double>(rows.size());
      if (weights == nullptr) return;
      roots = (*weights)(rows).cwiseSqrt();
      total_weight = roots.squaredNorm();
    }

    NormalEquations equations(const HiddenLayer& layer) const {
      return {layer, features, targets, widest_instruction_set(), false, roots.size() > 0 ? roots.data() : nullptr};
    }

    std::pair<MatrixX, MatrixX> outputs_and_targets(const HiddenLayer& layer,
                                                    const Eigen::Ref<const VectorX>& theta) const {
      std::pair<MatrixX, MatrixX> out{{}, targets};
      layer.outputs(features, theta, out.first);
      if (roots.size() > 0) {
        out.first = roots.asDiagonal() * out.first;
        out.second = roots.asDiagonal() * out.second;
      }
      return out;
    }
  };

  double from_products(const NormalEquations& equations, const std::optional<NormalEquations>& judge) const {
    if (!judge)
      return relative_ridge_objective(equations.gram(), equations.right(), equations.target_square(), relative_lambda_);
    const double lambda = relative_lambda_ * equations.gram().trace() / static_cast<double>(layer_.nodes);
    return objective_from_products(judge->gram(), judge->right(), judge->target_square(),
                                   ridge_weights(equations.gram(), equations.right(), lambda), 0,
                                   judge->gram().trace());
  }

  double from_samples(const Eigen::Ref<const VectorX>& theta, bool holds_out) const {
    const auto [h, t] = fitted_.outputs_and_targets(layer_, theta);
    const RidgeSolution found = relative_ridge(h, t, relative_lambda_);
    if (!holds_out) return found.objective;
    const auto [held_h, held_t] = held_out_.outputs_and_targets(layer_, theta);
    return (held_h * found.beta - held_t).squaredNorm();
  }

  HiddenLayer layer_;
  Samples fitted_, held_out_;
  double relative_lambda_;
};

/// In double precision.
using ElmFitness = ElmFitnessOf<double>;

}  // namespace vernier::detail
