// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What else is wrong with an actual arm and its measurement: joint errors drawn from a seed, backlash, outliers.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier {

/// Standard deviations of joint errors, whose coefficients are drawn from normal distributions; 0 leaves a source out.
/// The defaults add up to a few tenths of a milliradian, as those of a small industrial arm do.
struct JointErrorSizes {
  double gear_ratio = 1e-4;  ///< [rad/rad]
  double coupling = 1e-4;    ///< of joint i - 1 into joint i [rad/rad]
  double compliance =
      0.2e-3;                ///< of the products of `GravityCompliance` [rad/m], each made positive: a spring gives way
  double harmonic = 0.2e-3;  ///< of cos q and sin q [rad]; revolute joints alone have harmonics
  int harmonics = 3;         ///< number of harmonics; harmonic k has the size `harmonic / k^decay`
  double decay = 1;          ///< how fast higher harmonics die out
  double ripple = 0;         ///< of one more harmonic, that of the meshing teeth [rad]
  int ripple_harmonic = 100;   ///< periods a turn of the joint; above `harmonics`
  double payload = 0;          ///< compliance of each joint to payload, made positive [rad/(N m), m/N]
  Vector3 down{0, 0, -1};      ///< direction of gravity in the base frame of the chain; a unit vector
  ControllerMap controller{};  ///< whose motors err, if it says so (`ControllerMap::motor_errors`)
};

namespace detail {

VERNIER_API JointErrors draw_joint_errors(const ChainTable& chain, const JointErrorSizes& sizes, std::uint64_t seed);

}  // namespace detail

/// Joint errors drawn at random. Sources and joints are drawn independently, and so are harmonics in ascending order:
/// switching one off, or adding harmonics, leaves all others as they were. The arm is then
/// `Framed(WithJointErrors<Chain>(chain, errors), base, tool)`.
/// @param chain whose links give the torques of gravity
/// @param sizes standard deviations
/// @param seed  same seed, same errors
/// @throws std::invalid_argument on a size that is negative or not finite, or harmonics outside 0 .. 500
template <int N, class Convention>
JointErrors draw_joint_errors(const DhChain<N, Convention>& chain, const JointErrorSizes& sizes = {},
                              std::uint64_t seed = 0) {
  return detail::draw_joint_errors(detail::ChainTable(chain.view()), sizes, seed);
}

/// From which side each joint comes when the rows are visited in order, n x N: +1 rising, -1 falling. A joint that
/// stands still keeps its last direction; one that has not moved yet has none, 0.
/// @param joints visited configurations
/// @param start  where the arm stands before the first
template <int N>
JointRows<N> approach_directions(const JointRows<N>& joints,
                                 const std::type_identity_t<JointVector<N>>& start = JointVector<N>::Zero()) {
  JointRows<N> out(joints.rows(), N);
  for (int j = 0; j < N; ++j) {
    double before = start(j), direction = 0;
    for (Index i = 0; i < joints.rows(); ++i) {
      if (joints(i, j) != before) direction = joints(i, j) > before ? 1 : -1;
      before = joints(i, j);
      out(i, j) = direction;
    }
  }
  return out;
}

/// What a sensor sees of an arm whose gears have play: an arm moved upwards lags by half the gap, so it stands at
/// `q_i - direction_i backlash_i`. The data hold the commanded q. Without play it is `measure` bit for bit.
/// @param actual   any model; its own joint errors come on top
/// @param joints   commanded, n x N
/// @param backlash half a gap a joint, 0 or more [rad, m]
/// @param approach n x N of +1, -1, or 0 for the middle of the gap: `approach_directions(joints)`, or one's own
/// @param noise    of the sensor
/// @param seed     of the noise
/// @throws std::invalid_argument on a gap that is negative or not finite, or directions other than those
template <KinematicModel Actual>
Dataset<Actual::dof> measure_with_backlash(const Actual& actual, const JointRows<Actual::dof>& joints,
                                           const JointVector<Actual::dof>& backlash,
                                           const JointRows<Actual::dof>& approach, const MeasurementNoise& noise = {},
                                           std::uint64_t seed = 0) {
  for (int j = 0; j < Actual::dof; ++j)
    demand(backlash(j) >= 0 && std::isfinite(backlash(j)), "measure_with_backlash: the backlash of joint ", j + 1,
           " is ", backlash(j), ", must be 0 or more and finite");
  demand(approach.rows() == joints.rows(), "measure_with_backlash: ", approach.rows(), " rows of directions for ",
         joints.rows(), " rows of joints");
  for (Index i = 0; i < approach.rows(); ++i)
    for (int j = 0; j < Actual::dof; ++j)
      demand(approach(i, j) == 0 || std::abs(approach(i, j)) == 1, "measure_with_backlash: row ", i, ", joint ", j + 1,
             " is approached from ", approach(i, j), ", must be -1, 0 or 1");
  JointRows<Actual::dof> effective = joints;
  for (int j = 0; j < Actual::dof; ++j)
    for (Index i = 0; i < joints.rows(); ++i) effective(i, j) -= approach(i, j) * backlash(j);
  const Dataset<Actual::dof> seen = measure(actual, effective, noise, seed);
  return {joints, seen.positions(), seen.orientations()};
}

/// Measured poses of which some are wrong, and which.
template <int N>
struct WithOutliers {
  Dataset<N> data;          ///< all samples, in their order
  std::vector<Index> rows;  ///< those that were moved, ascending
};

/// Moves a random share of the positions, each in a random direction. Joints and orientations stay as they are.
/// @param data  measured poses
/// @param share of all n samples, in [0, 1]; the nearest whole number of them is moved
/// @param size  how far [m]
/// @param seed  same seed, same outliers
/// @throws std::invalid_argument on a share outside [0, 1] or a size that is negative or not finite
template <int N>
WithOutliers<N> with_outliers(const Dataset<N>& data, double share, double size, std::uint64_t seed) {
  demand(share >= 0 && share <= 1, "with_outliers: the share is ", share, ", must lie in [0, 1]");
  demand(size >= 0 && std::isfinite(size), "with_outliers: the size is ", size, " m, must be 0 or more and finite");
  Rng rng(seed);
  std::vector<Index> rows = rng.permutation(data.size());
  rows.resize(static_cast<std::size_t>(std::lround(share * static_cast<double>(data.size()))));
  std::sort(rows.begin(), rows.end());
  PointRows positions = data.positions();
  for (const Index row : rows) {
    const Vector3 direction{rng.normal(), rng.normal(), rng.normal()};  // braces: left to right
    const Vector3 shift = size * direction.normalized();
    set_point(positions, row, point(positions, row) + shift);
  }
  return {{data.joints(), positions, data.orientations()}, std::move(rows)};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/error_sources.ipp"
#endif
