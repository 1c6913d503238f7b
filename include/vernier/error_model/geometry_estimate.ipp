// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_model/geometry_estimate.hpp"

namespace vernier {

VERNIER_IMPL ErrorModelEstimate geometry_estimate(const ArmGeometry& identified, const IdentificationReport& report,
                                                  double position_sigma, double orientation_sigma) {
  const auto unknowns = static_cast<Index>(report.free.size());
  demand(static_cast<Index>(report.parameters.size()) == identified.num_parameters(),
         "geometry_estimate: ", report.parameters.size(), " parameters, the arm has ", identified.num_parameters());
  demand(report.covariance.rows() == unknowns, "geometry_estimate: the identification has no covariance");
  demand(position_sigma >= 0 && orientation_sigma >= 0, "geometry_estimate: a standard deviation is negative");
  std::vector<GeometricUnknown> free;
  for (const Index k : report.free) {
    const ParameterEstimate& p = report.parameters[static_cast<std::size_t>(k)];
    const double scale = p.scale > 0 ? p.scale : 1e-3, ratio = scale / p.prior_std;
    free.push_back({k, -1, scale, std::isfinite(p.prior_std) ? ratio * ratio : 0});
  }
  ErrorModelEstimate out{.arm = ArmParameterisation({identified}, std::move(free))};
  out.covariance.resize(unknowns, unknowns);
  const VectorX scales = out.arm.scales();
  for (Index i = 0; i < unknowns; ++i)
    for (Index j = 0; j < unknowns; ++j) out.covariance(i, j) = report.covariance(i, j) / (scales(i) * scales(j));
  out.converged = report.converged();
  out.position_sigma = position_sigma;
  out.orientation_sigma = orientation_sigma;
  return out;
}

}  // namespace vernier
