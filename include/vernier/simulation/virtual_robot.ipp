// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/simulation/virtual_robot.hpp"

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::detail {

VERNIER_IMPL void add_geometric_errors(VectorRef parameters, const GeometricErrors& errors, std::uint64_t seed) {
  demand(errors.length_min >= 0 && errors.length_min <= errors.length_max && errors.angle_min >= 0 &&
             errors.angle_min <= errors.angle_max,
         "GeometricErrors: lengths [", errors.length_min, ", ", errors.length_max, "] m and angles [", errors.angle_min,
         ", ", errors.angle_max, "] rad must be ranges of non-negative magnitudes");
  Rng rng(seed);
  const auto error = [&](double min, double max) {
    const double sign = rng.sign();
    return sign * rng.uniform(min, max);
  };
  const auto length = [&] { return error(errors.length_min, errors.length_max); };
  const auto angle = [&] { return error(errors.angle_min, errors.angle_max); };
  for (Index i = 0; i < parameters.size(); i += 5) {
    parameters(i) += length();
    parameters(i + 1) += angle();
    parameters(i + 2) += length();
    parameters(i + 3) += angle();
  }
}

VERNIER_IMPL MeasuredPoses measured_poses(std::span<const Isometry3> poses, const MeasurementNoise& noise,
                                          std::uint64_t seed) {
  Rng rng(seed);
  const auto normal3 = [&](double sigma) {
    return Vector3{sigma * rng.normal(), sigma * rng.normal(), sigma * rng.normal()};
  };  // braces: left to right
  const auto n = static_cast<Index>(poses.size());
  MeasuredPoses out{PointRows(n, 3), PointRows(noise.with_orientations ? n : 0, 3)};
  for (Index i = 0; i < n; ++i) {
    const Isometry3& pose = poses[static_cast<std::size_t>(i)];
    set_point(out.positions, i, translation(pose) + normal3(noise.position));
    if (noise.with_orientations)
      set_point(out.orientations, i, log_so3(exp_so3(normal3(noise.orientation)) * rotation(pose)));
  }
  return out;
}

VERNIER_IMPL VectorX measured_distances(const PointRows& positions, const Vector3& anchor, double sigma,
                                        std::uint64_t seed) {
  Rng rng(seed);
  VectorX lengths = distances_from(positions, anchor);
  for (double& length : lengths) length += sigma * rng.normal();
  return lengths;
}

}  // namespace vernier::detail
