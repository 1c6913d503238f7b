#pragma once

#include <algorithm>
#include <utility>

#include "vernier/kinematics/framed.hpp"

namespace vernier::detail {

VERNIER_IMPL void move_columns(const Isometry3& base, const Vector3& lever, const double* inner, Index columns,
                               double* out) noexcept {
  for (Index k = 0; k < columns; ++k) {
    const Eigen::Map<const Vector3> linear(inner + 6 * k), omega(inner + 6 * k + 3);
    Eigen::Map<Vector3>(out + 6 * k) = base.linear() * (linear + omega.cross(lever));
    Eigen::Map<Vector3>(out + 6 * k + 3) = base.linear() * omega;
  }
}

VERNIER_IMPL void frame_columns(const FrameParameters& base, const FrameParameters& tool, const Isometry3& tool_point,
                                Index columns, double* jacobian) noexcept {
  using Columns = Eigen::Map<Matrix6>;
  Columns of_base(jacobian), of_tool(jacobian + 6 * (6 + columns));
  const Matrix3& rate = base.rotation_vector_jacobian();
  const Matrix3 rotation = tool_point.linear();
  const Vector3 arm = tool_point.translation() - base.isometry().translation();  // base origin to tool point
  of_base.setZero();
  of_base.block<3, 3>(0, 0).setIdentity();
  of_base.block<3, 3>(0, 3) = -skew(arm) * rate;
  of_base.block<3, 3>(3, 3) = rate;
  of_tool.setZero();
  of_tool.block<3, 3>(0, 0) = rotation;
  of_tool.block<3, 3>(3, 3) = rotation * tool.rotation_vector_jacobian();
}

VERNIER_IMPL std::vector<std::string> framed_names(std::vector<std::string> model) {
  std::vector<std::string> names;
  for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) names.push_back(std::string("base_") + axis);
  for (auto& name : model) names.push_back(std::move(name));
  for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) names.push_back(std::string("tool_") + axis);
  return names;
}

VERNIER_IMPL std::vector<ParameterKind> framed_kinds(const std::vector<ParameterKind>& model) {
  std::vector<ParameterKind> kinds;
  const auto frame = [&] {
    kinds.insert(kinds.end(), 3, ParameterKind::length);
    kinds.insert(kinds.end(), 3, ParameterKind::angle);
  };
  frame();
  kinds.insert(kinds.end(), model.begin(), model.end());
  frame();
  return kinds;
}

}  // namespace vernier::detail
