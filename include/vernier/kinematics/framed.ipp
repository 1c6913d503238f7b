#pragma once

#include <algorithm>
#include <utility>

#include "vernier/kinematics/framed.hpp"

namespace vernier::detail {

VERNIER_IMPL void move_columns(const Isometry3& base, const Vector3& lever, const double* inner, Index columns,
                               double* out) noexcept {
  const Matrix3 turn = rotation(base);  // copies, since `out` might be anything else
  const Vector3 to = lever;
  for (Index k = 0; k < columns; ++k, inner += 6, out += 6) {
    const Vector3 omega(inner[3], inner[4], inner[5]), carried = omega.cross(to);
    const Vector3 moved = rotated(turn, {inner[0] + carried.x(), inner[1] + carried.y(), inner[2] + carried.z()});
    const Vector3 turned = rotated(turn, omega);
    for (int r = 0; r < 3; ++r) {
      out[r] = moved(r);
      out[3 + r] = turned(r);
    }
  }
}

VERNIER_IMPL void frame_columns(const FrameParameters& base, const FrameParameters& tool, const Isometry3& tool_point,
                                Index columns, double* jacobian) noexcept {
  double *const of_base = jacobian, *const of_tool = jacobian + 6 * (6 + columns);
  const Matrix3& rate = base.rotation_vector_jacobian();
  const Matrix3 turn = rotation(tool_point), turned_rate = times3(turn, tool.rotation_vector_jacobian());
  const Vector3 arm = translation(tool_point) - translation(base.isometry());  // base origin to tool point
  std::fill_n(of_base, 36, 0.0);
  std::fill_n(of_tool, 36, 0.0);
  for (Index c = 0; c < 3; ++c) {
    const Vector3 axis(rate(0, c), rate(1, c), rate(2, c)), moved = axis.cross(arm);
    of_base[6 * c + c] = 1;
    for (Index r = 0; r < 3; ++r) {
      of_base[6 * (3 + c) + r] = moved(r);
      of_base[6 * (3 + c) + 3 + r] = axis(r);
      of_tool[6 * c + r] = turn(r, c);
      of_tool[6 * (3 + c) + 3 + r] = turned_rate(r, c);
    }
  }
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
