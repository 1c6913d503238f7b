// SPDX-License-Identifier: BSD-3-Clause
// A model without Jacobians, compared with data.
// expect: `jacobian(q)` must be const and noexcept and return vernier::Jacobian<dof>
#include <vernier/evaluation/position_errors.hpp>

namespace vn = vernier;

struct Scara {
  static constexpr int dof = 4;
  vn::Isometry3 pose(const vn::JointVector<4>& q) const noexcept;
  vn::Vector3 position(const vn::JointVector<4>& q) const noexcept;
#ifndef MISTAKE
  vn::Jacobian<4> jacobian(const vn::JointVector<4>& q) const noexcept;
  vn::PoseAndJacobian<4> pose_and_jacobian(const vn::JointVector<4>& q) const noexcept;
#endif
};

double error(const Scara& scara, const vn::Dataset<4>& data) { return vn::prediction_error(scara, data).mean; }
