#pragma once

/// @file
/// A virtual actual robot: a chain with errors drawn from a seed, seen through a noisy sensor.

#include <cmath>
#include <cstdint>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// Sizes of geometric errors: each of a, alpha, d, theta of each row is off by an amount uniform in its range, with a
/// random sign.
struct GeometricErrors {
  double length_min = 0.5e-3;  ///< [m]
  double length_max = 1e-3;    ///< [m]
  double angle_min = 1e-3;     ///< [rad]
  double angle_max = 3e-3;     ///< [rad]
};

/// A chain with geometric errors. Hayati's beta stays as it is.
/// @throws std::invalid_argument on a range that is negative or upside down
template <int N, class Convention>
DhChain<N, Convention> with_geometric_errors(const DhChain<N, Convention>& nominal, const GeometricErrors& errors,
                                             std::uint64_t seed) {
  require(errors.length_min >= 0 && errors.length_min <= errors.length_max && errors.angle_min >= 0 &&
              errors.angle_min <= errors.angle_max,
          "GeometricErrors: lengths [", errors.length_min, ", ", errors.length_max, "] m and angles [",
          errors.angle_min, ", ", errors.angle_max, "] rad must be ranges of sizes");
  Rng rng(seed);
  auto p = nominal.parameters();
  for (int i = 0; i < N; ++i) {
    const auto length = [&] { return rng.sign() * rng.uniform(errors.length_min, errors.length_max); };
    const auto angle = [&] { return rng.sign() * rng.uniform(errors.angle_min, errors.angle_max); };
    p(5 * i) += length();
    p(5 * i + 1) += angle();
    p(5 * i + 2) += length();
    p(5 * i + 3) += angle();
  }
  return nominal.with_parameters(p);
}

/// Standard deviations of a measurement, per component.
struct MeasurementNoise {
  double position = 0;            ///< [m]
  double orientation = 0;         ///< [rad]
  bool with_orientations = true;  ///< whether orientations are measured at all
};

/// What a sensor sees of an arm at n joint combinations.
template <KinematicModel Actual>
Dataset<Actual::dof> measure(const Actual& actual, const JointRows<Actual::dof>& joints,
                             const MeasurementNoise& noise = {}, std::uint64_t seed = 0) {
  Rng rng(seed);
  const auto normal3 = [&](double sigma) {
    return Vector3{sigma * rng.normal(), sigma * rng.normal(), sigma * rng.normal()};
  };  // braces: left to right
  PointRows positions(joints.rows(), 3), orientations(noise.with_orientations ? joints.rows() : 0, 3);
  const std::vector<Isometry3> all = poses(actual, joints);
  for (Index i = 0; i < joints.rows(); ++i) {
    const Isometry3& pose = all[static_cast<std::size_t>(i)];
    positions.row(i) = (pose.translation() + normal3(noise.position)).transpose();
    if (noise.with_orientations)
      orientations.row(i) = log_so3(exp_so3(normal3(noise.orientation)) * pose.linear()).transpose();
  }
  return {joints, positions, orientations};
}

/// What a draw-wire encoder or a ball-bar sees of an arm at n joint combinations: distances from a fixed point.
/// @param actual the arm
/// @param anchor the fixed point, in the arm's base frame [m]
/// @param joints n x N [rad, m]
/// @param sigma  standard deviation of a distance [m]
/// @param seed   of the noise
template <KinematicModel Actual>
Distances<Actual::dof> measure_distances(const Actual& actual, const Vector3& anchor,
                                         const JointRows<Actual::dof>& joints, double sigma = 0,
                                         std::uint64_t seed = 0) {
  Rng rng(seed);
  VectorX lengths = (positions(actual, joints).rowwise() - anchor.transpose()).rowwise().norm();
  for (double& length : lengths) length += sigma * rng.normal();
  return {joints, lengths};
}

}  // namespace vernier
