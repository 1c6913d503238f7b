// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/urdf/detail/origin_patch.hpp"
#include "vernier/urdf/detail/roll_pitch_yaw.hpp"
#include "vernier/urdf/urdf_text.hpp"

namespace vernier {
namespace detail {

/// Begins the element of a joint, up to its origin; the caller ends it.
VERNIER_LOCAL void open_joint(tinyxml2::XMLPrinter& out, const std::string& name, const char* type,
                              const std::string& parent, const std::string& child, const Isometry3& origin) {
  const auto three = [](const Vector3& v) {
    return exact_number(v.x()) + " " + exact_number(v.y()) + " " + exact_number(v.z());
  };
  out.OpenElement("joint");
  out.PushAttribute("name", name.c_str());
  out.PushAttribute("type", type);
  out.OpenElement("parent");
  out.PushAttribute("link", parent.c_str());
  out.CloseElement();
  out.OpenElement("child");
  out.PushAttribute("link", child.c_str());
  out.CloseElement();
  out.OpenElement("origin");
  out.PushAttribute("xyz", three(origin.translation()).c_str());
  out.PushAttribute("rpy", three(roll_pitch_yaw(origin.linear())).c_str());
  out.CloseElement();
}

VERNIER_LOCAL void add_link(tinyxml2::XMLPrinter& out, const std::string& name) {
  out.OpenElement("link");
  out.PushAttribute("name", name.c_str());
  out.CloseElement();
}

}  // namespace detail

VERNIER_IMPL std::string urdf_text(const RobotDescription& robot) {
  const ArmGeometry arm = robot.geometry();
  const std::vector<DhRow>& rows = arm.chain().rows();
  demand(static_cast<int>(robot.limits.size()) == robot.controller_joints(), "urdf_text: limits of ",
         robot.limits.size(), " joints, expected ", robot.controller_joints());
  VectorX lower(robot.limits.size()), upper(robot.limits.size());
  for (std::size_t j = 0; j < robot.limits.size(); ++j) {
    lower(static_cast<Index>(j)) = robot.limits[j].first;
    upper(static_cast<Index>(j)) = robot.limits[j].second;
  }
  const MatrixX limits = robot.controller.chain_limits(lower, upper);
  tinyxml2::XMLPrinter out;
  out.PushHeader(false, true);
  out.OpenElement("robot");
  out.PushAttribute("name", robot.name.c_str());
  std::string parent = "base_link";
  detail::add_link(out, parent);
  Isometry3 origin = arm.base().isometry();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhRow& row = rows[i];
    const auto at = static_cast<Index>(i);
    const bool slides = row.joint == JointType::prismatic,
               limited = std::isfinite(limits(at, 0)) && std::isfinite(limits(at, 1));
    demand(limited || !slides, "urdf_text: joint ", i + 1, " slides and has no limits, which a URDF file needs");
    const std::string link = message("link_", i + 1),
                      name = i < robot.joint_names.size() ? robot.joint_names[i] : message("joint_", i + 1);
    detail::open_joint(out, name, slides ? "prismatic" : limited ? "revolute" : "continuous", parent, link, origin);
    out.OpenElement("axis");
    out.PushAttribute("xyz", "0 0 1");
    out.CloseElement();
    if (limited) {
      out.OpenElement("limit");
      out.PushAttribute("lower", detail::exact_number(limits(at, 0)).c_str());
      out.PushAttribute("upper", detail::exact_number(limits(at, 1)).c_str());
      out.PushAttribute("effort", "0");
      out.PushAttribute("velocity", "0");
      out.CloseElement();
    }
    out.CloseElement();
    detail::add_link(out, link);
    parent = link;
    // the motion of the joint is the first of the row's: a turn about z, or a shift along it
    origin = Eigen::AngleAxisd(row.theta, Vector3::UnitZ()) * Eigen::Translation3d(row.a, 0, row.d) *
             Eigen::AngleAxisd(row.alpha, Vector3::UnitX()) * Eigen::AngleAxisd(row.beta, Vector3::UnitY());
  }
  detail::open_joint(out, "tool_joint", "fixed", parent, "tool", origin * arm.tool().isometry());
  out.CloseElement();
  detail::add_link(out, "tool");
  out.CloseElement();
  return out.CStr();
}

}  // namespace vernier
