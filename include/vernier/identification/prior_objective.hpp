#pragma once

/// @file
/// The priors of an error model as something a metaheuristic may tune.

#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/box.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/identification/pose_system.hpp"

namespace vernier {

/// Mean position error of poses left out one at a time [m], as a function of the priors of the joint errors, in closed
/// form at the linearised problem. A batch objective: columns of a population are independent.
///
/// The vector to move: decimal logarithms of tightness (1: the expected sizes; t: sizes divided by sqrt(t)), of the
/// elastic terms where there are any, then of every joint that has transmission terms; last the exponent e by which
/// the expected amplitude falls with the harmonic, k^-e.
/// @cite Allen 1974
class PriorObjective {
 public:
  /// @param system     poses, linearised; outlives this
  /// @param normal     their normal equations; outlives this
  /// @param precisions of all unknowns; those of geometry stay
  /// @param steps      where the unknowns are
  /// @param few        unknowns that are elastic terms, the last of the dense ones
  /// @param relative   expected amplitude of each transmission term beside its joint's first
  /// @param stride     every so many-th pose is left out
  PriorObjective(const detail::PoseSystem& system, const detail::PoseNormalEquations& normal, VectorX precisions,
                 VectorX steps, Index few, VectorX relative, Index stride)
      : system_(system),
        normal_(normal),
        precisions_(std::move(precisions)),
        steps_(std::move(steps)),
        few_(few),
        relative_(std::move(relative)),
        stride_(stride) {}

  /// Length of the vector to move.
  Index dimension() const {
    Index out = few_ > 0 ? 2 : 1;
    for (const Index count : system_.functions_of) out += count > 0 ? 1 : 0;
    return out;
  }
  /// Where to look: tightness 0.1 to 1e4, exponents 0.5 to 2.
  Box box() const {
    Box out{VectorX::Constant(dimension(), -1), VectorX::Constant(dimension(), 4)};
    out.lower(dimension() - 1) = 0.5;
    out.upper(dimension() - 1) = 2;
    return out;
  }

  /// The precisions of all unknowns that a vector stands for.
  template <class Vector>
  VectorX precisions(const Eigen::MatrixBase<Vector>& at) const {
    VectorX out = precisions_;
    Index next = 0, k = system_.dense;
    if (few_ > 0) out.segment(k - few_, few_).setConstant(std::pow(10, at(next++)));
    const double exponent = at(dimension() - 1);
    for (const Index count : system_.functions_of) {
      if (count == 0) continue;
      out.segment(k, count) =
          std::pow(10, at(next++)) * relative_.segment(k - system_.dense, count).array().pow(2 - 2 * exponent);
      k += count;
    }
    return out;
  }

  /// The error with some precisions [m]; infinite where they leave the problem singular.
  template <class Vector>  // a template, so that only its users pay for compiling it
  double error(const Eigen::MatrixBase<Vector>& precisions) const {
    const detail::FactorisedSystem solved(normal_, precisions, steps_);
    return left_out_errors(system_, solved, stride_).colwise().norm().mean();
  }

  /// @param population dimension x particles
  /// @param fitness    one value a particle [m]
  template <class Population, class Fitness>
  void operator()(const Eigen::MatrixBase<Population>& population, Fitness&& fitness) const {
    for (Index k = 0; k < population.cols(); ++k) fitness(k) = error(precisions(population.col(k)));
  }

 private:
  const detail::PoseSystem& system_;
  const detail::PoseNormalEquations& normal_;
  VectorX precisions_, steps_;
  Index few_;
  VectorX relative_;
  Index stride_;
};

/// Finds a vector in the box whose objective is small, e.g. by `minimize`.
using PriorSearch = FunctionRef<VectorX(const PriorObjective&, const Box&)>;

}  // namespace vernier
