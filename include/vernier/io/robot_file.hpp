#pragma once

/// @file
/// Nominal arms as JSON files, their number of joints read at run time.

#include <string>
#include <utility>
#include <vector>

#include "vernier/core/data_error.hpp"
#include "vernier/kinematics/convert.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier {

/// A nominal arm of N joints in the standard convention.
template <int N>
struct DescribedRobot {
  std::string name;                  ///< its name
  Framed<DhChain<N>> arm;            ///< the chain between its base and tool frames; what precedes the first joint of a
                                     ///< modified chain is part of the base frame
  JointLimits<N> limits{};           ///< joint limits
  std::vector<JointDrive> drives{};  ///< gears and encoders, one a joint; may be empty
};

/// A file that was read.
struct SourceFile {
  std::string name;  ///< as it was named
  std::string hash;  ///< SHA-256 of the bytes that were read, see `sha256`
};

/// A nominal arm whose number of joints is only known at run time.
struct RobotDescription {
  std::string name;                                 ///< its name
  bool modified = false;                            ///< rows are in Craig's convention
  std::vector<DhRow> rows{};                        ///< one a joint [m, rad]
  std::vector<std::pair<double, double>> limits{};  ///< lower and upper, one a joint [rad, m]; infinite where not given

  std::vector<JointDrive> drives{};           ///< gears and encoders, one a joint
  Isometry3 base = Isometry3::Identity();     ///< frame in which the first row stands
  Isometry3 tool = Isometry3::Identity();     ///< tool frame after the last row
  std::vector<std::string> joint_names = {};  ///< one a joint; may be empty
  std::vector<SourceFile> files = {};         ///< from which it was read

  /// Of an arm of the catalogue.
  template <int N, class Convention>
  static RobotDescription of(const Robot<N, Convention>& robot) {
    RobotDescription out{std::string(robot.name), Convention::modified, {}, {}, {}};
    for (int i = 0; i < N; ++i) {
      out.rows.push_back(robot.chain.row(i));
      out.limits.emplace_back(robot.limits.lower(i), robot.limits.upper(i));
      out.drives.push_back(robot.drives[static_cast<std::size_t>(i)]);
    }
    return out;
  }

  /// Number of joints.
  int dof() const { return static_cast<int>(rows.size()); }

  /// The arm without a type, in the standard convention, between its frames; a modified chain is converted exactly.
  VERNIER_API ArmGeometry geometry() const;

  /// The arm with N fixed, in the standard convention, between its frames.
  /// @throws std::invalid_argument unless N is `dof()`
  template <int N>
  DescribedRobot<N> arm() const {
    demand(dof() == N && limits.size() == rows.size(), "RobotDescription: ", dof(), " joints, expected ", N);
    DescribedRobot<N> out{name, geometry().framed(DhChain<N>::from_rows({})), {}, drives};
    for (int i = 0; i < N; ++i) {
      out.limits.lower(i) = limits[static_cast<std::size_t>(i)].first;
      out.limits.upper(i) = limits[static_cast<std::size_t>(i)].second;
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
/// joints may have `gear_ratio` and `encoder_periods` (a turn of the joint), see `JointDrive`. 3 to 9 joints.
/// @throws DataError naming file and key
VERNIER_API RobotDescription load_robot(const std::string& path);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/robot_file.ipp"
#endif
