#pragma once

/// @file
/// Matrix aliases shared by every folder. Units are metres and radians; samples are rows.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vernier/core/api.hpp"

/// Calibration and error compensation of serial robot arms.
namespace vernier {

using Eigen::Index;

/// A point or direction in space.
using Vector3 = Eigen::Vector3d;
/// A twist, linear part first, or six frame parameters.
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// 3 x 3.
using Matrix3 = Eigen::Matrix3d;
/// Any size, column-major.
using MatrixX = Eigen::MatrixXd;
/// Any length.
using VectorX = Eigen::VectorXd;

/// A matrix argument that is read: a matrix, or columns and rows of one, without a copy.
using ConstMatrixRef = Eigen::Ref<const MatrixX>;
/// A matrix argument that is written.
using MatrixRef = Eigen::Ref<MatrixX>;
/// A vector argument that is read.
using ConstVectorRef = Eigen::Ref<const VectorX>;
/// A vector argument that is written.
using VectorRef = Eigen::Ref<VectorX>;

/// Rigid motion; `base_T_tool` maps tool coordinates to base coordinates.
template <class Scalar>
using IsometryOf = Eigen::Transform<Scalar, 3, Eigen::Isometry>;
/// Rigid motion in double precision.
using Isometry3 = IsometryOf<double>;

/// Joint values of one configuration: rad (revolute) or m (prismatic).
template <int N>
using JointVector = Eigen::Matrix<double, N, 1>;

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

/// 6 x P Jacobians of n configurations, n x 6P: each row is one of them, column by column, so that an entry of all n
/// lies side by side. `rows.row(i).reshaped(6, P)` is the Jacobian of configuration i.
template <int P>
using JacobianRows = Eigen::Matrix<double, Eigen::Dynamic, 6 * P>;

}  // namespace vernier
