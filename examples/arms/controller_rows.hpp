// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows of a controller's joint values, as joint values of the chain and back.

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"

namespace support {

/// Joint values of a chain of N joints from a row of those of its controller, which may have fewer: passive joints
/// follow.
template <int N>
vernier::JointVector<N> chain_joints(const vernier::JointChange<N>& change, const double* row) noexcept {
  vernier::JointVector<N> q = vernier::JointVector<N>::Zero();
  std::copy_n(row, change.moving(), q.data());
  return change.to_chain(q);
}

/// Writes the joint values of the controller to a row.
template <int N>
void controller_joints(const vernier::JointChange<N>& change, const vernier::JointVector<N>& chain,
                       double* row) noexcept {
  const vernier::JointVector<N> q = change.to_controller(chain);
  std::copy_n(q.data(), change.moving(), row);
}

/// A pose of 16 numbers, row by row.
inline vernier::Isometry3 pose_at(const double* row) {
  vernier::Isometry3 out;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) out.matrix()(r, c) = row[4 * r + c];
  return out;
}
/// Writes a pose as 16 numbers, row by row.
inline void set_pose(const vernier::Isometry3& pose, double* row) noexcept {
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) row[4 * r + c] = pose.matrix()(r, c);
}
/// Writes a Jacobian as 6 rows of joints of the controller.
template <int N>
void set_jacobian(const vernier::JointChange<N>& change, const vernier::Jacobian<N>& chain, double* out) noexcept {
  const vernier::Jacobian<N> jacobian = change.derivative(chain);
  for (int r = 0; r < 6; ++r)
    for (int j = 0; j < change.moving(); ++j) *out++ = jacobian(r, j);
}

}  // namespace support
