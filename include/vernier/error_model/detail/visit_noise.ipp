// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/error_model/detail/visit_noise.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier::detail {

/// How well some noise explains the error of a visit.
struct ExplainedError {
  double chi_square;   ///< error' covariance^-1 error
  double determinant;  ///< of the covariance
};

/// @param space variance in space, `joints` of every joint
VERNIER_LOCAL inline ExplainedError explained(const LeftOutVisit& visit, double space, double joints, double model) {
  const auto covariance = [&](Index r, Index c) {
    return model * visit.model(r, c) + joints * visit.joint_noise(r, c) + (r == c ? space : 0);
  };
  // by LDL'
  const double c10 = covariance(1, 0), c20 = covariance(2, 0);
  const double d0 = covariance(0, 0), l10 = c10 / d0, l20 = c20 / d0;
  const double d1 = covariance(1, 1) - l10 * c10, l21 = (covariance(2, 1) - l20 * c10) / d1;
  const double d2 = covariance(2, 2) - l20 * c20 - l21 * l21 * d1;
  const double z0 = visit.error(0), z1 = visit.error(1) - l10 * z0, z2 = visit.error(2) - l20 * z0 - l21 * z1;
  return {z0 * z0 / d0 + z1 * z1 / d1 + z2 * z2 / d2, d0 * d1 * d2};
}

/// Widens noise until the 95 % ellipsoids hold as many of the visits: errors have longer tails than normal ones.
VERNIER_LOCAL void widen(const std::vector<LeftOutVisit>& visits, VisitNoise& noise) {
  constexpr std::size_t enough = 100;
  if (visits.size() < enough) return;
  constexpr double within = chi_square_95;
  const auto held = [&](const VisitNoise& wider) {
    std::size_t count = 0;
    for (const LeftOutVisit& v : visits)
      count +=
          explained(v, wider.position * wider.position, wider.joint * wider.joint, wider.model).chi_square <= within;
    return static_cast<double>(count) / static_cast<double>(visits.size());
  };
  const VisitNoise likely = noise;
  for (double factor = 1; factor < 2 && held(noise) < 0.95; factor *= 1.02)
    noise = {likely.position * factor, likely.joint * factor, likely.model};
}

VERNIER_IMPL VisitNoise visit_noise(const std::vector<LeftOutVisit>& visits) {
  double square_sum = 0, effect = 0;
  for (const LeftOutVisit& v : visits) {
    square_sum += v.error.squaredNorm();
    for (Index k = 0; k < 3; ++k) effect += v.joint_noise(k, k);
  }
  const double whole = square_sum / (3 * static_cast<double>(visits.size()));  // variance of a component
  const double to_joints = square_sum / (std::max)(effect, 1e-300);
  VisitNoise out;
  double best = std::numeric_limits<double>::infinity();
  if (!(whole > 0)) return out;
  for (const double scale : {1.0, 0.7, 0.5, 0.35, 0.25})
    for (double of_space = 1.5 * whole; of_space > 1e-3 * whole; of_space /= 1.2)
      for (double share = 0; share < 1.5; share += 0.1) {
        double cost = 0;  // twice the negative logarithm of the likelihood
        for (const LeftOutVisit& v : visits) {
          const ExplainedError error = explained(v, of_space, share * to_joints, scale);
          cost += std::log(error.determinant) + error.chi_square;
        }
        if (cost >= best) continue;
        best = cost;
        out = {std::sqrt(of_space), std::sqrt(share * to_joints), scale};
      }
  widen(visits, out);
  return out;
}

}  // namespace vernier::detail
