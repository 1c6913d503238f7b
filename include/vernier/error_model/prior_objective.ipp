// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/error_model/prior_objective.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier {

VERNIER_IMPL PriorObjective::PriorObjective(const BlockSystem& system, const NormalEquations& normal,
                                            VectorX precisions, VectorX steps, Index num_elastic, VectorX amplitudes,
                                            Index stride)
    : system_(system),
      normal_(normal),
      precisions_(std::move(precisions)),
      steps_(std::move(steps)),
      num_elastic_(num_elastic),
      amplitudes_(std::move(amplitudes)),
      stride_(stride) {}

VERNIER_IMPL Index PriorObjective::dimension() const {
  Index out = num_elastic_ > 0 ? 2 : 1;
  for (const Index count : system_.group_sizes) out += count > 0 ? 1 : 0;
  return out;
}

VERNIER_IMPL Box PriorObjective::box() const {
  Box out{VectorX::Constant(dimension(), -1), VectorX::Constant(dimension(), 4)};
  out.lower(dimension() - 1) = 0.5;
  out.upper(dimension() - 1) = 2;
  return out;
}

VERNIER_IMPL VectorX PriorObjective::precisions(const ConstVectorRef& variables) const {
  VectorX out = precisions_;
  Index next = 0, k = system_.dense;
  if (num_elastic_ > 0) {
    const double elastic = std::pow(10, variables(next++));
    for (Index e = k - num_elastic_; e < k; ++e) out(e) = elastic;
  }
  const double exponent = variables(dimension() - 1);
  for (const Index count : system_.group_sizes) {
    if (count == 0) continue;
    const double precision = std::pow(10, variables(next++));
    for (const Index end = k + count; k < end; ++k)
      out(k) = precision * std::pow(amplitudes_(k - system_.dense), 2 - 2 * exponent);
  }
  return out;
}

VERNIER_IMPL double PriorObjective::error(const VectorX& precisions) const {
  const FactorisedEquations solved(normal_, precisions, steps_);
  return detail::error_norms(leave_one_out(system_, solved, stride_)).mean();
}

VERNIER_IMPL void PriorObjective::operator()(const ConstMatrixRef& population, VectorRef fitness) const {
  for (Index k = 0; k < population.cols(); ++k) fitness(k) = error(precisions(VERNIER_LATER(population).col(k)));
}

}  // namespace vernier
