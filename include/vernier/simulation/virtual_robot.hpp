// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A simulated actual robot: a chain with random geometric errors, and its measurement with sensor noise.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/types.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// Magnitudes of geometric errors: the error of each a, alpha, d, theta of each row is uniform in its range, with a
/// random sign.
struct GeometricErrors {
  double length_min = 0.5e-3;  ///< [m]
  double length_max = 1e-3;    ///< [m]
  double angle_min = 1e-3;     ///< [rad]
  double angle_max = 3e-3;     ///< [rad]
};

/// Standard deviations of measurement noise, per component.
struct MeasurementNoise {
  double position = 0;            ///< [m]
  double orientation = 0;         ///< [rad]
  bool with_orientations = true;  ///< whether orientations are measured at all
};

namespace detail {

/// Adds errors to five parameters per row.
VERNIER_API void add_geometric_errors(VectorRef parameters, const GeometricErrors& errors, std::uint64_t seed);

/// Noisy measurements of poses.
struct MeasuredPoses {
  PointRows positions, orientations;
};
VERNIER_API MeasuredPoses measured_poses(std::span<const Isometry3> poses, const MeasurementNoise& noise,
                                         std::uint64_t seed);
VERNIER_API VectorX measured_distances(const PointRows& positions, const Vector3& anchor, double sigma,
                                       std::uint64_t seed);

}  // namespace detail

/// A chain with geometric errors. Hayati's beta is unchanged.
/// @throws std::invalid_argument on a range with a negative or decreasing bound
template <int N, class Convention>
DhChain<N, Convention> with_geometric_errors(const DhChain<N, Convention>& nominal, const GeometricErrors& errors,
                                             std::uint64_t seed) {
  auto parameters = nominal.parameters();
  detail::add_geometric_errors(parameters, errors, seed);
  return nominal.with_parameters(parameters);
}

/// Measured poses of an arm at n joint configurations.
template <KinematicModel Actual>
Dataset<Actual::dof> measure(const Actual& actual, const JointRows<Actual::dof>& joints,
                             const MeasurementNoise& noise = {}, std::uint64_t seed = 0) {
  detail::MeasuredPoses measured = detail::measured_poses(poses(actual, joints), noise, seed);
  return {joints, std::move(measured.positions), std::move(measured.orientations)};
}

/// Measured poses of an arm at configurations in a matrix whose size is known at run time only.
/// @throws std::invalid_argument on another number of columns
template <KinematicModel Actual, ColumnsAtRunTime Rows>
Dataset<Actual::dof> measure(const Actual& actual, const Rows& joints, const MeasurementNoise& noise = {},
                             std::uint64_t seed = 0) {
  return measure(actual, detail::joint_rows<Actual::dof>(joints), noise, seed);
}

/// Measured distances of an arm's tool point from a fixed point at n joint configurations, as by a draw-wire encoder or
/// a ball-bar.
/// @param actual the arm
/// @param anchor the fixed point, in the arm's base frame [m]
/// @param joints n x N [rad, m]
/// @param sigma  standard deviation of a distance [m]
/// @param seed   of the noise
template <KinematicModel Actual>
Distances<Actual::dof> measure_distances(const Actual& actual, const Vector3& anchor,
                                         const JointRows<Actual::dof>& joints, double sigma = 0,
                                         std::uint64_t seed = 0) {
  return {joints, detail::measured_distances(positions(actual, joints), anchor, sigma, seed)};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/virtual_robot.ipp"
#endif
