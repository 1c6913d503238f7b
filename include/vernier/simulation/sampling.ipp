// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/simulation/sampling.hpp"

#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"

namespace vernier {

VERNIER_IMPL void detail::sample_rows(const ConstVectorRef& lower, const ConstVectorRef& upper, std::uint64_t seed,
                                      FunctionRef<bool(const double*)> accept, MatrixRef out) {
  for (Index j = 0; j < lower.size(); ++j)
    demand(std::isfinite(lower(j)) && std::isfinite(upper(j)) && lower(j) <= upper(j),
           "sample_joints: the limits must be finite, lower below upper");
  Rng rng(seed);
  VectorX q(lower.size());
  for (Index i = 0, tries = 0; i < out.rows();) {
    demand(++tries <= 1000 * (out.rows() + 10),
           "sample_joints: fewer than one configuration in a thousand is accepted");
    for (Index j = 0; j < q.size(); ++j) q(j) = rng.uniform(lower(j), upper(j));
    if (!accept(q.data())) continue;
    for (Index j = 0; j < q.size(); ++j) out(i, j) = q(j);
    ++i;
  }
}

VERNIER_IMPL OperatingRegion<6> abb_irb120_operating_region() {
  constexpr double degree = std::numbers::pi / 180;
  OperatingRegion<6> region;
  region.limits.lower << -90, -60, -60, -90, 20, -180;
  region.limits.upper << 90, 60, 50, 90, 110, 180;
  region.limits.lower *= degree;
  region.limits.upper *= degree;
  region.wrist_clearance = 0.12;
  return region;
}

}  // namespace vernier
