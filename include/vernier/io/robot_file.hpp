// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Nominal arms as JSON files, their number of joints read at run time.

#include <string>
#include <utility>
#include <vector>

#include "vernier/core/controller_map.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/kinematics/convert.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier {

/// A nominal arm of N joints in the standard convention.
template <int N>
struct DescribedRobot {
  std::string name;        ///< its name
  Framed<DhChain<N>> arm;  ///< the chain between its base and tool frames; what precedes the first joint of a
                           ///< modified chain is part of the base frame
  /// Joint limits, of the controller's joints; where it has fewer than N, the further values are held at 0.
  JointLimits<N> limits{};
  std::vector<JointDrive> drives{};  ///< gears and encoders, one a joint; may be empty
  ControllerMap controller{};        ///< how the chain's joints follow from those of the controller
  Vector3 down = -Vector3::UnitZ();  ///< direction of gravity in the base frame of the chain; a unit vector
};

/// A file that was read.
struct SourceFile {
  std::string name;  ///< as it was named
  std::string hash;  ///< SHA-256 of the bytes that were read, see `sha256`
};

/// A nominal arm whose number of joints is only known at run time.
struct RobotDescription {
  std::string name;           ///< its name
  bool modified = false;      ///< rows are in Craig's convention
  std::vector<DhRow> rows{};  ///< one a joint [m, rad]
  /// Lower and upper, one a joint of the controller [rad, m]; infinite where not given.
  std::vector<std::pair<double, double>> limits{};

  std::vector<JointDrive> drives{};           ///< gears and encoders, one a joint; of motors where those err
  Isometry3 base = Isometry3::Identity();     ///< frame in which the first row stands
  Isometry3 tool = Isometry3::Identity();     ///< tool frame after the last row
  std::vector<std::string> joint_names = {};  ///< one a joint; may be empty
  std::vector<SourceFile> files = {};         ///< from which it was read
  ControllerMap controller = {};              ///< how the chain's joints follow from those of the controller
  bool base_known = false;                    ///< whether the base frame is known, not a starting value
  bool tool_known = false;                    ///< likewise the tool frame
  Vector3 down = -Vector3::UnitZ();           ///< direction of gravity where the first row stands; a unit vector
  bool down_stated = false;                   ///< whether the user stated it; else it is taken to be that default

  /// Of an arm of the catalogue.
  template <int N, class Convention>
  static RobotDescription of(const Robot<N, Convention>& robot) {
    RobotDescription out{std::string(robot.name), Convention::modified, {}, {}, {}};
    for (int i = 0; i < N; ++i) {
      out.rows.push_back(robot.chain.row(i));
      out.drives.push_back(robot.drives[static_cast<std::size_t>(i)]);
    }
    out.controller = robot.controller;
    for (int j = 0; j < out.controller_joints(); ++j)
      out.limits.emplace_back(robot.limits.lower(j), robot.limits.upper(j));
    return out;
  }

  /// Number of joints of the chain.
  int dof() const { return static_cast<int>(rows.size()); }
  /// Number of joints of the controller.
  int controller_joints() const { return controller.joints(dof()); }
  /// Types of the chain's joints.
  std::vector<JointType> joint_types() const {
    std::vector<JointType> out;
    for (const DhRow& row : rows) out.push_back(row.joint);
    return out;
  }

  /// The arm without a type, in the standard convention, between its frames; a modified chain is converted exactly.
  VERNIER_API ArmGeometry geometry() const;
  /// Direction of gravity in the base frame of that arm's chain: a modified chain is turned by its conversion.
  VERNIER_API Vector3 chain_down() const;

  /// The arm with N fixed, in the standard convention, between its frames.
  /// @throws std::invalid_argument unless N is `dof()`
  template <int N>
  DescribedRobot<N> arm() const {
    demand(dof() == N && static_cast<int>(limits.size()) == controller_joints(), "RobotDescription: ", dof(),
           " joints, expected ", N);
    DescribedRobot<N> out{name, geometry().framed(DhChain<N>::from_rows({})), {}, drives, controller, chain_down()};
    for (int j = 0; j < N; ++j) {
      const bool moving = j < controller_joints();
      out.limits.lower(j) = moving ? limits[static_cast<std::size_t>(j)].first : 0;
      out.limits.upper(j) = moving ? limits[static_cast<std::size_t>(j)].second : 0;
    }
    return out;
  }
};

/// A robot file:
///
///     {"name": "my arm", "convention": "standard",
///      "joints": [{"type": "revolute", "a_mm": 0, "alpha_deg": -90, "d_mm": 290, "theta_deg": 0,
///                  "lower_deg": -165, "upper_deg": 165}, ...]}
///
/// `convention` is standard or modified; `type` is revolute (by default) or prismatic, with limits in `lower_mm`,
/// `upper_mm`; `beta_deg` and limits may be omitted; `_m` and `_rad` are accepted too. Revolute
/// joints may have `gear_ratio` and `encoder_periods` (a turn of the joint), see `JointDrive`. 1 to 9 joints.
///
/// Where the controller counts its joints differently, `controller` has a formula for each joint of the chain, see
/// `ControllerMap`, and the limits of its joints:
///
///     "controller": {"chain": ["J1", "J2", "-J2 - J3", "-J4", "-J5", "-J6"],
///                    "limits": [{"lower_deg": -180, "upper_deg": 180}, ...]}
///
/// `"errors": "motors"` there says that gears err as functions of the controller's joints, whose `drives` it may list.
///
/// `base` and `tool` are the frames before the first row and behind the last one: position, and rotation vector or
/// quaternion, both of which may be omitted. They are starting values unless `known` is true. `down` is the direction
/// of gravity in the frame of the first row. See the page on robot files for every key.
/// @throws DataError naming file and key
VERNIER_API RobotDescription load_robot(const std::string& path);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/robot_file.ipp"
#endif
