// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Points and configurations among rows, and the parts of a rigid motion, as values: cheaper to compile than
/// expressions of rows and blocks, each of which is a type of its own.

#include "vernier/core/types.hpp"

namespace vernier {

/// The i-th point.
VERNIER_API inline Vector3 point(const PointRows& points, Index i) {
  return {points(i, 0), points(i, 1), points(i, 2)};
}

/// Sets the i-th point.
VERNIER_API inline void set_point(PointRows& points, Index i, const Vector3& value) {
  for (Index c = 0; c < 3; ++c) points(i, c) = value(c);
}

/// Mean of points, of which there is at least one.
VERNIER_API inline Vector3 centroid(const PointRows& points) {
  Vector3 sum(0, 0, 0);
  for (Index i = 0; i < points.rows(); ++i)
    for (Index c = 0; c < 3; ++c) sum(c) += points(i, c);
  for (double& c : sum) c /= static_cast<double>(points.rows());
  return sum;
}

/// Distance of each point from another.
VERNIER_API inline VectorX distances_from(const PointRows& points, const Vector3& from) {
  VectorX out(points.rows());
  for (Index i = 0; i < points.rows(); ++i) out(i) = (VERNIER_LATER(point(points, i)) - from).norm();
  return out;
}

/// The i-th configuration of rows of joint values.
template <int N>
JointVector<N> configuration(const JointRows<N>& joints, Index i) {
  JointVector<N> out(joints.cols());
  for (Index j = 0; j < out.size(); ++j) out(j) = joints(i, j);
  return out;
}

/// Sets the i-th configuration.
template <int N>
void set_configuration(JointRows<N>& joints, Index i, const JointVector<N>& values) {
  for (Index j = 0; j < values.size(); ++j) joints(i, j) = values(j);
}

/// Translation of a rigid motion [m].
VERNIER_API inline Vector3 translation(const Isometry3& pose) { return {pose(0, 3), pose(1, 3), pose(2, 3)}; }

/// Rotation matrix of a rigid motion.
VERNIER_API inline Matrix3 rotation(const Isometry3& pose) {
  Matrix3 out;
  for (Index c = 0; c < 3; ++c)
    for (Index r = 0; r < 3; ++r) out(r, c) = pose(r, c);
  return out;
}

/// Rigid motion of a rotation matrix and a translation [m].
VERNIER_API inline Isometry3 rigid_motion(const Matrix3& rotation, const Vector3& translation) {
  Isometry3 out = VERNIER_LATER(Isometry3::Identity());
  for (Index r = 0; r < 3; ++r) {
    for (Index c = 0; c < 3; ++c) out(r, c) = rotation(r, c);
    out(r, 3) = translation(r);
  }
  return out;
}

/// The product `outer inner` of rigid motions: the inner one, then the outer one.
VERNIER_API inline Isometry3 composed(const Isometry3& outer, const Isometry3& inner) {
  Isometry3 out = VERNIER_LATER(Isometry3::Identity());
  for (Index r = 0; r < 3; ++r)
    for (Index c = 0; c < 4; ++c)
      out(r, c) = outer(r, 0) * inner(0, c) + outer(r, 1) * inner(1, c) + outer(r, 2) * inner(2, c) +
                  (c == 3 ? outer(r, 3) : 0);
  return out;
}

/// The inverse of a rigid motion.
VERNIER_API inline Isometry3 inverse_of(const Isometry3& pose) {
  Isometry3 out = VERNIER_LATER(Isometry3::Identity());
  for (Index r = 0; r < 3; ++r) {
    for (Index c = 0; c < 3; ++c) out(r, c) = pose(c, r);
    out(r, 3) = -(pose(0, r) * pose(0, 3) + pose(1, r) * pose(1, 3) + pose(2, r) * pose(2, 3));
  }
  return out;
}

/// A point after a rigid motion.
VERNIER_API inline Vector3 transformed(const Isometry3& motion, const Vector3& point) {
  Vector3 out;
  for (Index r = 0; r < 3; ++r)
    out(r) = motion(r, 0) * point(0) + motion(r, 1) * point(1) + motion(r, 2) * point(2) + motion(r, 3);
  return out;
}

}  // namespace vernier
