#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<Index> contact_unknowns(const Contact& contact) {
  if (contact.kind() == ContactKind::plane) return {2, 3, 4};
  if (contact.kind() == ContactKind::socket && contact.has_length()) return {0, 1, 2, 3, 4};
  return {0, 1, 2};
}

/// The normal of a plane through points at some heights above it; its sign follows from the heights where they differ.
VERNIER_API Vector3 fitted_normal(const PointRows& points, const VectorX& heights) {
  MatrixX from_means(points.rows(), 3);
  Vector3 rise = Vector3::Zero();
  const Vector3 middle = centroid(points);
  const double mean_height = heights.mean();
  for (Index i = 0; i < points.rows(); ++i) {
    Vector3 sum = Vector3::Zero();  // of the face that i is on
    double count = 0;
    for (Index k = 0; k < points.rows(); ++k)
      if (heights(k) == heights(i)) {
        sum += point(points, k);
        ++count;
      }
    for (Index c = 0; c < 3; ++c) from_means(i, c) = points(i, c) - sum(c) / count;
    const Vector3 from_middle = point(points, i) - middle;
    rise += (heights(i) - mean_height) * from_middle;
  }
  const Vector3 normal = symmetric_eigen(transposed_matrix_product(from_means, from_means)).vectors.col(0);
  return normal.dot(rise) < 0 ? Vector3(-normal) : normal;
}

/// The smallest rotation that takes a unit vector with z >= 0 to the z axis.
VERNIER_API Matrix3 rotation_to_z(const Vector3& direction) {
  const Vector3 axis = direction.cross(Vector3::UnitZ());
  const double sine = axis.norm();
  return sine > 0 ? exp_so3(Vector3(axis * (std::atan2(sine, direction.z()) / sine))) : Matrix3(Matrix3::Identity());
}

VERNIER_IMPL ArmGeometry contact_arm(const ArmGeometry& arm, const Contact& contact, Station& station) {
  const PointRows points = arm.with_frames({}, arm.tool()).positions(contact.joints());
  const Vector3 middle = centroid(points);
  if (contact.kind() == ContactKind::ball) {
    const Vector3 shift = -trilaterate(points, contact.known());
    return arm.with_frames(FrameParameters(rigid_motion(Matrix3::Identity(), shift)), arm.tool());
  }
  const double mean = contact.known().mean();
  Vector3 direction = Vector3::UnitZ();
  if (contact.kind() == ContactKind::plane) {
    direction = fitted_normal(points, contact.known());
  } else if (contact.has_length()) {
    Vector3 rise = Vector3::Zero();
    for (Index i = 0; i < points.rows(); ++i) {
      const Vector3 from_middle = point(points, i) - middle;
      rise += (contact.known()(i) - mean) * from_middle;
    }
    direction = rise.normalized();
  }
  station.height_sign = direction.z() < 0 ? -1 : 1;
  const Matrix3 turn = rotation_to_z(station.height_sign * direction);
  const Vector3 turned = turn * middle;
  Vector3 shift(-turned.x(), -turned.y(), station.height_sign * mean - turned.z());
  if (contact.kind() == ContactKind::plane) shift.x() = shift.y() = 0;
  return arm.with_frames(FrameParameters(rigid_motion(turn, shift)), arm.tool());
}

VERNIER_IMPL void require_spread(const ArmGeometry& arm, const Contact& contact) {
  if (contact.kind() != ContactKind::plane) return;
  const PointRows points = arm.positions(contact.joints());
  const MatrixX centred = rows_minus(points, column_means(points)).leftCols(2);
  const VectorX squares = symmetric_eigen(transposed_matrix_product(centred, centred)).values;
  const double width = std::sqrt(std::max(squares(0), 0.0) / static_cast<double>(points.rows()));
  const double length = std::sqrt(squares(1) / static_cast<double>(points.rows()));
  require(width > std::max(1e-3, 0.02 * length), "contact ", contact.name(),
          ": all touches of the plane are along a line (", std::round(width * 1e4) / 10, " mm across, ",
          std::round(length * 1e4) / 10, " mm along), which does not determine its normal; spread them over the plane");
}

VERNIER_IMPL MatrixX touching_joints(const ArmGeometry& arm, const Station& station) {
  MatrixX joints = station.joints();
  PosesAndJacobians at;
  const Index n = joints.rows(), dof = joints.cols();
  MatrixX columns(3, dof);
  for (int iteration = 0; iteration < 6; ++iteration) {
    arm.poses_and_parameter_jacobians(joints, at);
    const PointRows points = arm.positions(joints);
    for (Index i = 0; i < n; ++i) {
      for (int j = 0; j < static_cast<int>(dof); ++j) {  // a joint adds to a parameter of its row
        const Index k = 6 + 5 * j + static_cast<int>(arm.chain().revolute(j) ? DhParameter::theta : DhParameter::d);
        for (int r = 0; r < 3; ++r) columns(r, j) = at.jacobians.data()[(6 * k + r) * n + i];
      }
      const Vector3 reached = point(points, i);
      MatrixX rows = columns;
      VectorX residual(3);
      if (station.projected()) {
        const Vector3 along = station.lengths != nullptr ? Vector3(reached.normalized()) : Vector3(Vector3::UnitZ());
        rows.resize(1, dof);
        for (Index j = 0; j < dof; ++j) rows(0, j) = along.dot(Vector3(columns.col(j)));
        residual.resize(1);
        residual(0) = along.dot(reached) - (station.lengths != nullptr ? (*station.lengths)(i) : station.height(i));
      } else {
        residual = reached - station.position(i);
      }
      MatrixX gram = matrix_product(rows, rows.transpose());
      const double least = 1e-12 * rows.squaredNorm();
      for (Index k = 0; k < gram.cols(); ++k) gram(k, k) += least;
      solve_general(gram, residual);
      const VectorX step = transposed_product(rows, residual);
      if (step.norm() < 0.5)  // so finite
        for (Index j = 0; j < dof; ++j) joints(i, j) -= step(j);
    }
  }
  return joints;
}

}  // namespace vernier::detail
