// SPDX-License-Identifier: BSD-3-Clause
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
  const auto write = [](double* column, const Vector3& linear, const Vector3& angular) {
    for (Index r = 0; r < 3; ++r) {
      column[r] = linear(r);
      column[3 + r] = angular(r);
    }
  };
  const Vector3 none(0, 0, 0);
  for (Index c = 0; c < 3; ++c) {
    const Vector3 axis(rate(0, c), rate(1, c), rate(2, c));
    write(of_base + 6 * c, Vector3(c == 0, c == 1, c == 2), none);
    write(of_base + 6 * (3 + c), axis.cross(arm), axis);
    write(of_tool + 6 * c, Vector3(turn(0, c), turn(1, c), turn(2, c)), none);
    write(of_tool + 6 * (3 + c), none, Vector3(turned_rate(0, c), turned_rate(1, c), turned_rate(2, c)));
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
