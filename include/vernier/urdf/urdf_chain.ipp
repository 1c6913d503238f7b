// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/json.hpp"
#include "vernier/kinematics/detail/rows_of_axes.hpp"
#include "vernier/urdf/detail/urdf_document.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier {

namespace detail {

/// Names for a message, the first few.
VERNIER_LOCAL std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 8;
  std::string out;
  for (std::size_t i = 0; i < (std::min)(names.size(), most); ++i)
    out += (i > 0 ? ", '" : "'") + quotable(names[i]) + "'";
  return names.size() > most ? message(out, ", ... (", names.size(), ")") : out;
}

/// The only link that is an end of the tree.
/// @param root whether that without a parent, else that without a child
VERNIER_LOCAL std::string only_end(const UrdfDocument& document, bool root, const std::string& file) {
  std::set<std::string> inner;
  for (const UrdfJoint& joint : document.joints) inner.insert(root ? joint.child : joint.parent);
  std::vector<std::string> ends = document.links;
  std::erase_if(ends, [&](const std::string& link) { return inner.contains(link); });
  if (ends.size() != 1)
    throw DataError(message(file, ": which link is the ", root ? "base" : "tip", "? There are ", listed(ends)));
  return ends.front();
}

/// The joints from base to tip.
VERNIER_LOCAL std::vector<const UrdfJoint*> joints_from_base(const UrdfDocument& document, const std::string& base,
                                                             const std::string& tip, const std::string& file) {
  for (const std::string* link : {&base, &tip})
    if (std::find(document.links.begin(), document.links.end(), *link) == document.links.end())
      throw DataError(file + ": there is no link '" + quotable(*link) + "'; there are " + listed(document.links));
  std::map<std::string, const UrdfJoint*> above;
  for (const UrdfJoint& joint : document.joints) above[joint.child] = &joint;
  std::vector<const UrdfJoint*> out;
  std::vector<std::string> passed;
  for (std::string link = tip; link != base;) {
    const auto found = above.find(link);
    if (found == above.end())
      throw DataError(file + ": link '" + quotable(tip) + "' is not behind link '" + quotable(base) +
                      "'; it is behind " + (passed.empty() ? "none" : listed(passed)));
    out.push_back(found->second);
    link = found->second->parent;
    passed.push_back(link);
  }
  std::reverse(out.begin(), out.end());
  return out;
}

/// A joint of the chain that rows cannot describe.
VERNIER_LOCAL void require_movable(const UrdfJoint& joint, const std::string& file) {
  const auto fail = [&](const auto&... parts) {
    throw DataError(
        message(file, ", line ", joint.line, ": joint '", quotable(joint.name), "' of the chain ", parts...));
  };
  if (!joint.unreadable.empty()) throw DataError(joint.unreadable);
  if (joint.type == "floating" || joint.type == "planar")
    fail("is ", joint.type, "; it must be revolute, continuous, prismatic or fixed");
}

/// The controller of an arm some of whose joints follow others: these are joints of the chain alone.
/// @param joints those of the chain that move
VERNIER_LOCAL ControllerMap controller_of(const std::vector<const UrdfJoint*>& joints, const std::string& file) {
  std::map<std::string, Index> moved;  // joints of the controller, by name
  for (const UrdfJoint* joint : joints)
    if (!joint->mimics) moved.emplace(joint->name, static_cast<Index>(moved.size()));
  const auto n = static_cast<Index>(joints.size()), m = static_cast<Index>(moved.size());
  if (n == m) return {};
  MatrixX factors = MatrixX::Zero(n, m);
  VectorX zeros = VectorX::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const UrdfJoint& joint = *joints[static_cast<std::size_t>(i)];
    if (!joint.mimics) {
      factors(i, moved.at(joint.name)) = 1;
      continue;
    }
    const auto fail = [&](const auto&... parts) {
      throw DataError(message(file, ", line ", joint.line, ": joint '", quotable(joint.name), "' mimics '",
                              quotable(joint.mimicked), "', ", parts...));
    };
    const auto leader = moved.find(joint.mimicked);
    if (leader == moved.end()) fail("which is no joint of the chain that moves by itself");
    if (!same_value(joint.multiplier, std::floor(joint.multiplier)) || std::abs(joint.multiplier) < 0.5)
      fail("by a multiplier of ", joint.multiplier, "; it must be a whole number, and not 0");
    factors(i, leader->second) = joint.multiplier;
    zeros(i) = joint.offset;
  }
  ControllerMap out(factors, zeros);
  std::vector<JointType> types;
  for (const UrdfJoint* joint : joints)
    types.push_back(joint->type == "prismatic" ? JointType::prismatic : JointType::revolute);
  try {
    (void)out.types(types);
  } catch (const std::invalid_argument& error) {
    throw DataError(file + ": " + error.what());
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL UrdfChain read_urdf(const std::string& path, const std::string& base_link, const std::string& tip_link) {
  std::string text;
  try {
    text = read_file(path);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
  UrdfChain out = parse_urdf(text, path, base_link, tip_link);
  out.robot.files.push_back({path, sha256(text)});
  return out;
}

VERNIER_IMPL UrdfChain parse_urdf(const std::string& text, const std::string& file, const std::string& base_link,
                                  const std::string& tip_link) {
  const detail::UrdfDocument document = detail::read_urdf_document(text, file);
  UrdfChain out;
  out.text = text;
  out.base_link = base_link.empty() ? detail::only_end(document, true, file) : base_link;
  out.tip_link = tip_link.empty() ? detail::only_end(document, false, file) : tip_link;
  out.robot.name = document.name;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<detail::JointAxis> axes;
  std::vector<Isometry3> links;
  Isometry3 at = Isometry3::Identity();
  std::vector<const detail::UrdfJoint*> moving;
  for (const detail::UrdfJoint* joint : detail::joints_from_base(document, out.base_link, out.tip_link, file)) {
    detail::require_movable(*joint, file);
    at = at * joint->origin;
    for (const std::string& what : joint->ignored)
      out.remarks.push_back("joint '" + detail::quotable(joint->name) + "': " + what + " is ignored");
    if (joint->moves()) {
      const bool revolute = joint->type != "prismatic";
      axes.push_back(
          {at.linear() * joint->axis, at.translation(), revolute ? JointType::revolute : JointType::prismatic});
      links.push_back(at);
      out.moving.push_back(static_cast<int>(out.joints.size()));
      out.robot.joint_names.push_back(joint->name);
      moving.push_back(joint);
      if (joint->mimics) {
        if (joint->limited)
          out.remarks.push_back("joint '" + detail::quotable(joint->name) +
                                "': its limit is ignored, for it follows another joint");
      } else if (joint->limited) {
        out.robot.limits.emplace_back(joint->lower, joint->upper);
      } else {
        out.robot.limits.emplace_back(-infinity, infinity);
      }
    }
    out.joints.push_back(joint->name);
    out.origins.push_back(joint->origin);
  }
  if (axes.empty() || axes.size() > max_joints)
    throw DataError(message(file, ": ", axes.size(), " joints move between link '", detail::quotable(out.base_link),
                            "' and link '", detail::quotable(out.tip_link), "'; there must be 1 to ", max_joints));
  const detail::AxisRows found = detail::rows_of_axes(axes);
  out.robot.rows = found.rows;
  out.robot.controller = detail::controller_of(moving, file);
  out.robot.base = found.base;
  out.robot.down = -found.base.linear().row(2).transpose();  // -z of the base link
  out.robot.down_stated = true;
  out.robot.drives.resize(axes.size());
  for (std::size_t i = 0; i < links.size(); ++i) out.link_in_row.push_back(found.frames[i].inverse() * links[i]);
  out.robot.tool = found.frames.back().inverse() * at;
  return out;
}

VERNIER_IMPL std::vector<Isometry3> joint_origins(const UrdfChain& chain, const ArmGeometry& geometry) {
  const std::size_t n = chain.robot.rows.size();
  bool same = geometry.joints() == chain.robot.dof() && !geometry.chain().modified();
  for (std::size_t i = 0; same && i < n; ++i) same = geometry.chain().rows()[i].joint == chain.robot.rows[i].joint;
  demand(same, "joint_origins: the geometry is not of the chain to '", chain.tip_link, "', ", chain.robot.dof(),
         " joints");
  const auto turn = [](const DhRow& row) { return Isometry3(Eigen::AngleAxisd(row.theta, Vector3::UnitZ())); };
  const auto advance = [](const DhRow& row) {
    return Isometry3(Eigen::Translation3d(row.a, 0, row.d) * Eigen::AngleAxisd(row.alpha, Vector3::UnitX()) *
                     Eigen::AngleAxisd(row.beta, Vector3::UnitY()));
  };
  std::vector<Isometry3> out = chain.origins;
  const std::vector<DhRow>& rows = geometry.chain().rows();
  Isometry3 from_link = geometry.base().isometry();  // the row's frame in the link before
  std::size_t next = 0;                              // joint behind that link
  for (std::size_t i = 0; i < n; ++i) {
    Isometry3 fixed = Isometry3::Identity();
    const auto joint = static_cast<std::size_t>(chain.moving[i]);
    for (; next < joint; ++next) fixed = fixed * chain.origins[next];
    const Isometry3& link = chain.link_in_row[i];
    out[joint] = fixed.inverse() * from_link * turn(rows[i]) * link;
    next = joint + 1;
    from_link = link.inverse() * advance(rows[i]);
  }
  Isometry3 before_last = Isometry3::Identity(), nominal = Isometry3::Identity();
  for (std::size_t k = next; k < out.size(); ++k) {
    before_last = nominal;
    nominal = nominal * chain.origins[k];
  }
  const Isometry3 tip = from_link * geometry.tool().isometry();
  if ((tip.matrix() - nominal.matrix()).cwiseAbs().maxCoeff() <= 1e-14) return out;
  demand(next < out.size(), "joint_origins: no fixed joint in front of '", chain.tip_link,
         "' that could hold the tool");
  out.back() = before_last.inverse() * tip;
  return out;
}

}  // namespace vernier
