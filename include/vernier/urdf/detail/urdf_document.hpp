// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Links and joints of a URDF file.

#include <array>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// A joint of a URDF file.
struct UrdfJoint {
  std::string name;
  std::string type;  ///< revolute, continuous, prismatic, fixed, floating or planar
  std::string parent, child;
  int line = 0;  ///< of the file
  Isometry3 origin = Isometry3::Identity();
  Vector3 axis = Vector3::UnitX();     ///< unit vector, in the joint's frame
  bool limited = false;                ///< whether it has limits
  double lower = 0, upper = 0;         ///< limits [rad, m]
  bool mimics = false;                 ///< whether it follows another joint
  std::string mimicked{};              ///< name of that
  double multiplier = 1, offset = 0;   ///< its value is `multiplier mimicked + offset` [rad, m]
  std::vector<std::string> ignored{};  ///< elements that have no effect here
  std::string unreadable{};            ///< why its frame is not known for sure, a message; empty where it is

  bool moves() const { return type != "fixed"; }
};

/// Links and joints, in the order of the file.
struct UrdfDocument {
  std::string name;
  std::vector<std::string> links;
  std::vector<UrdfJoint> joints;
};

/// Reads and checks a file: XML, names, one parent a link, no cycle.
/// @param text its content
/// @param file its name in messages
/// @throws DataError, one line
VERNIER_API UrdfDocument read_urdf_document(const std::string& text, const std::string& file);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/detail/urdf_document.ipp"
#endif
