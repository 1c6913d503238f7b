// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Matrix aliases shared by every folder. Units are metres and radians; samples are rows.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vernier/core/api.hpp"
#include "vernier/core/same_value.hpp"

/// Calibration and error compensation of serial robot arms.
namespace vernier {

using Eigen::Index;

/// A point or direction in space.
using Vector3 = Eigen::Vector3d;
/// A twist, linear part first, or six frame parameters.
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// 3 x 3.
using Matrix3 = Eigen::Matrix3d;
/// 6 x 6.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Any size, column-major.
using MatrixX = Eigen::MatrixXd;
/// Any length.
using VectorX = Eigen::VectorXd;

/// Read-only matrix argument: a matrix, or columns and rows of one, without a copy.
using ConstMatrixRef = Eigen::Ref<const MatrixX>;
/// Writable matrix argument.
using MatrixRef = Eigen::Ref<MatrixX>;
/// Read-only vector argument.
using ConstVectorRef = Eigen::Ref<const VectorX>;
/// Writable vector argument.
using VectorRef = Eigen::Ref<VectorX>;

/// Rigid motion; `base_T_tool` maps tool coordinates to base coordinates.
template <class Scalar>
using IsometryOf = Eigen::Transform<Scalar, 3, Eigen::Isometry>;
/// Rigid motion in double precision.
using Isometry3 = IsometryOf<double>;

/// Type of a joint, by what its value is: an angle or a displacement.
enum class JointType { revolute, prismatic };

/// Joint values of one configuration: rad (revolute) or m (prismatic).
template <int N>
using JointVector = Eigen::Matrix<double, N, 1>;

/// Most joints of an arm that files and programs have, of which the library has instances, whose paths are corrected,
/// and of which tables are kept that grow as a power of their number. A chain may have more (`max_joints`).
inline constexpr int max_arm_joints = 9;

/// A closed range of joint values [rad, m].
struct JointRange {
  double lower;  ///< minimum
  double upper;  ///< maximum

  /// Equal at both ends.
  constexpr bool operator==(const JointRange& other) const {
    return same_value(lower, other.lower) && same_value(upper, other.upper);
  }
};

/// Joint values of n configurations, n x N.
template <int N>
using JointRows = Eigen::Matrix<double, Eigen::Dynamic, N>;

/// n points in metres, n x 3.
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Geometric Jacobian, 6 x N: linear rows first, in the base frame, at the tool point.
template <int N>
using Jacobian = Eigen::Matrix<double, 6, N>;

/// Jacobian with respect to P model parameters, 6 x P, same rows as `Jacobian`.
template <int P>
using ParameterJacobian = Eigen::Matrix<double, 6, P>;

}  // namespace vernier
