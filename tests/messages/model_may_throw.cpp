// SPDX-License-Identifier: BSD-3-Clause
// A model whose `pose` may throw, in frames.
// expect: `pose(q)` must be const and noexcept and return vernier::Isometry3
#include <vernier/kinematics/framed.hpp>

namespace vn = vernier;

#ifdef MISTAKE
#define NOEXCEPT
#else
#define NOEXCEPT noexcept
#endif

struct Scara {
  static constexpr int dof = 4;
  vn::Isometry3 pose(const vn::JointVector<4>& q) const NOEXCEPT;
  vn::Vector3 position(const vn::JointVector<4>& q) const noexcept;
  vn::Jacobian<4> jacobian(const vn::JointVector<4>& q) const noexcept;
  vn::PoseAndJacobian<4> pose_and_jacobian(const vn::JointVector<4>& q) const noexcept;
};

vn::Isometry3 placed(const Scara& scara, const vn::JointVector<4>& q) { return vn::Framed{scara}.pose(q); }
