#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/error_model/detail/visit_noise.hpp"

namespace vernier::detail {

/// Widens noise until the 95 % ellipsoids hold as many of the visits: errors have longer tails than normal ones.
VERNIER_API void widen(const std::vector<LeftOutVisit>& visits, VisitNoise& noise) {
  constexpr std::size_t enough = 100;
  if (visits.size() < enough) return;
  constexpr double within = 7.8147;  // 95 % of chi squared with 3 degrees of freedom
  const auto held = [&](const VisitNoise& wider) {
    std::size_t count = 0;
    for (const LeftOutVisit& v : visits) {
      Matrix3 covariance = wider.model * v.model + wider.joint * wider.joint * v.joint_noise;
      covariance.diagonal().array() += wider.position * wider.position;
      count += v.error.dot(covariance.inverse() * v.error) <= within;
    }
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
    effect += v.joint_noise.trace();
  }
  const double whole = square_sum / (3 * static_cast<double>(visits.size()));  // variance of a component
  const double to_joints = square_sum / std::max(effect, 1e-300);
  VisitNoise out;
  double best = std::numeric_limits<double>::infinity();
  if (!(whole > 0)) return out;
  for (const double scale : {1.0, 0.7, 0.5, 0.35, 0.25})
    for (double of_space = 1.5 * whole; of_space > 1e-3 * whole; of_space /= 1.2)
      for (double share = 0; share < 1.5; share += 0.1) {
        double cost = 0;  // twice the negative logarithm of the likelihood
        for (const LeftOutVisit& v : visits) {
          Matrix3 covariance = scale * v.model + share * to_joints * v.joint_noise;
          covariance.diagonal().array() += of_space;
          cost += std::log(covariance.determinant()) + v.error.dot(covariance.inverse() * v.error);
        }
        if (cost >= best) continue;
        best = cost;
        out = {std::sqrt(of_space), std::sqrt(share * to_joints), scale};
      }
  widen(visits, out);
  return out;
}

}  // namespace vernier::detail
