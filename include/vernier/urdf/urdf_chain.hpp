// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Arms from URDF files.

#include <string>
#include <vector>

#include "vernier/io/robot_file.hpp"

namespace vernier {

/// A chain of a URDF file as rows of the standard convention, with what the way back needs.
struct UrdfChain {
  RobotDescription robot;             ///< base_link_T_tip_link: rows, frames, limits and names of the joints that move
  std::string base_link;              ///< where it begins
  std::string tip_link;               ///< where it ends
  std::vector<std::string> joints{};  ///< all joints from base to tip, fixed ones among them
  std::vector<Isometry3> origins{};   ///< parent_T_joint of each of those
  std::vector<int> moving{};          ///< which of those move, one a row
  std::vector<Isometry3> link_in_row{};  ///< of each row: pose of the joint's child link in the frame that the row's
                                         ///< joint turns (theta included; z along the axis)
  std::vector<std::string> remarks{};    ///< what was ignored, a sentence each
  std::string text{};                    ///< the file's content
};

/// The chain between two links of a URDF file. Fixed joints are merged. Its rows are exact for any joints: the frame of
/// a joint next to a nearly parallel one has Hayati's beta, see `DhRow`; the last row is zero, what is behind the last
/// axis is the tool. Joint values keep their meaning. A joint that mimics another one is passive: it is a row of the
/// chain, but no joint of the controller (`RobotDescription::controller`). Gravity acts along -z of the base link.
/// Orientations are `rpy`, or `quat_xyzw` in a file of version 1.1. Limits that are not in order, `safety_controller`,
/// `calibration` and elements of joints that are not of URDF are ignored, with a remark; meshes, inertias and other
/// branches without one. Refused is what may move a frame and is not known: attributes and contents of `origin`,
/// `axis`, `parent` and `child`, elements of joints with a place in space.
/// @param path      a file of at most 16 MiB, plain XML; xacro is to be run before
/// @param base_link where the chain begins; empty: the tree's root
/// @param tip_link  where it ends; empty: the only link without a child
/// @throws DataError, one line, for anything that is not such a chain of revolute, continuous, prismatic and fixed
///         joints
VERNIER_API UrdfChain read_urdf(const std::string& path, const std::string& base_link = {},
                                const std::string& tip_link = {});

/// The chain of a URDF text that was read already.
/// @param text      its content
/// @param file      its name in messages
/// @param base_link,tip_link as above
VERNIER_API UrdfChain parse_urdf(const std::string& text, const std::string& file, const std::string& base_link = {},
                                 const std::string& tip_link = {});

/// Origins (parent_T_joint) of all joints of the chain with which it is another geometry of the same arm, e.g. an
/// identified one. Those of the joints that move take up the rows and the base; a tool (or last row) other than the
/// chain's goes into the last joint, which must be a fixed one.
/// @param chain    as read
/// @param geometry as many joints; between the chain's own frames where these are to stay
/// @throws std::invalid_argument for a geometry that is not of this chain, or no fixed joint for another tool
VERNIER_API std::vector<Isometry3> joint_origins(const UrdfChain& chain, const ArmGeometry& geometry);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/urdf_chain.ipp"
#endif
