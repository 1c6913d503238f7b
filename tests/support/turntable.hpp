// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The smallest kinematic model: one joint that turns the tool in place.

#include "vernier/kinematics/concepts.hpp"

namespace vernier_test {

/// Turns about z; neither parameters nor blocks of poses.
struct Turntable {
  static constexpr int dof = 1;
  vernier::Isometry3 pose(const vernier::JointVector<1>& q) const noexcept {
    return vernier::Isometry3(Eigen::AngleAxisd(q(0), vernier::Vector3::UnitZ()));
  }
  vernier::Vector3 position(const vernier::JointVector<1>&) const noexcept { return vernier::Vector3::Zero(); }
  vernier::Jacobian<1> jacobian(const vernier::JointVector<1>&) const noexcept { return vernier::Vector6::Unit(5); }
  vernier::PoseAndJacobian<1> pose_and_jacobian(const vernier::JointVector<1>& q) const noexcept {
    return {pose(q), jacobian(q)};
  }
};

}  // namespace vernier_test
