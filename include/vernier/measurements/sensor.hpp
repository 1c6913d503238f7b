// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The concept of a sensor: how its measurements depend on the pose of an arm's tool point. A new sensor is one type
/// that satisfies it, in one file; `Measurements::add` takes it.

#include <array>
#include <concepts>
#include <span>
#include <string>

#include "vernier/core/types.hpp"

namespace vernier {

/// One measurement at a modelled pose of the tool point. Rows 0 to 2 are lengths, rows 3 to 5 are angles; rows that the
/// sensor does not measure are zero.
struct SensedRows {
  Vector6 residual;  ///< modelled minus measured [m, rad]
  /// Derivative of the residual by a small motion of the pose: shift of the tool point [m], then rotation about it
  /// [rad], both in the sensor's frame.
  Matrix6 motion;
};

/// Standard deviations of a measurement, per component.
struct SensorSigma {
  double length = 1;  ///< of rows 0 to 2 [m]
  double angle = 1;   ///< of rows 3 to 5 [rad]
};

/// When measurements cannot be of this arm, and how a message says so.
struct Plausibility {
  double rms;             ///< largest root mean square of registered lengths that a real arm may leave [m]
  const char* complaint;  ///< "no fixed point is consistent with these distances, the best one is off by"
  const char* causes;     ///< "wrong units, columns or rows?"
};

/// A sensor, or an object of known shape, with n measurements. It has a frame of its own, in which the arm's base
/// stands somewhere: P = base * FK(q) * tool is the pose of the tool point in that frame.
///
/// - `kind()`: its name in messages and reports, e.g. "distances"
/// - `size()`: n; `values()`: 1 for one length in row 0, 3 for rows 0 to 2, 6 for all rows
/// - `sigma()`: standard deviations of its values
/// - `sense(i, P, rows)`: measurement i at the pose P: the residual and its exact derivative
/// - `unknown_frame()`: which of the base frame's x, y, z and rotation vector measurements determine. The others are
///   either without effect (a plane cannot see motions in itself) or known
/// - `base_from(poses)`: the base frame that fits n poses in the arm's own base frame, in closed form: a start
/// - `plausibility()`: see `Plausibility`
///
/// Optional: `with(SensorModel)` is the sensor with the accuracy that a user states for its kind; `positions()` are
/// measured positions, n x 3, if it measures these; `covariances()` are n covariances of the rows in place of
/// `sigma()`, or none.
///
/// `testing::sensor_violations` checks what types cannot express.
template <class S>
concept Sensor = std::copy_constructible<S> &&
    requires(const S& sensor, Index i, const Isometry3& pose, std::span<const Isometry3> poses, SensedRows& rows) {
  { sensor.kind() } -> std::convertible_to<std::string>;
  { sensor.size() } -> std::convertible_to<Index>;
  { sensor.values() } -> std::convertible_to<Index>;
  { sensor.sigma() } -> std::same_as<SensorSigma>;
  sensor.sense(i, pose, rows);
  { sensor.unknown_frame() } -> std::same_as<std::array<bool, 6>>;
  { sensor.base_from(poses) } -> std::same_as<Isometry3>;
  { sensor.plausibility() } -> std::same_as<Plausibility>;
};

namespace detail {

/// Positions of poses, n x 3 [m].
VERNIER_API PointRows positions_of(std::span<const Isometry3> poses);
/// Sets rows of one length.
/// @param along gradient of that length by the tool point
VERNIER_API void one_length(double residual, const Vector3& along, SensedRows& rows);
/// Sets rows of three lengths.
VERNIER_API void three_lengths(const Vector3& residual, SensedRows& rows);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/sensor.ipp"
#endif
