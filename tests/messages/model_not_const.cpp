// SPDX-License-Identifier: BSD-3-Clause
// A model whose `pose` is not const.
// expect: `pose(q)` must be const and noexcept and return vernier::Isometry3
#include <vernier/kinematics/inverse_kinematics.hpp>

namespace vn = vernier;

#ifdef MISTAKE
#define CONST
#else
#define CONST const
#endif

struct Scara {
  static constexpr int dof = 4;
  vn::Isometry3 pose(const vn::JointVector<4>& q) CONST noexcept;
  vn::Vector3 position(const vn::JointVector<4>& q) const noexcept;
  vn::Jacobian<4> jacobian(const vn::JointVector<4>& q) const noexcept;
  vn::PoseAndJacobian<4> pose_and_jacobian(const vn::JointVector<4>& q) const noexcept;
};

double solved(const Scara& scara, const vn::Isometry3& target, const vn::JointVector<4>& seed) {
  return vn::inverse_kinematics(scara, target, seed, {.restarts = 2}).joints(0);
}
