#pragma once

/// @file
/// Nominal arms as JSON files, their number of joints read at run time.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "vernier/io/json.hpp"
#include "vernier/kinematics/convert.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier {

/// A nominal arm in the standard convention, standing in a base frame (identity unless it came in the modified one).
template <int N>
struct NominalArm {
  /// Its name.
  std::string name;
  /// In the standard convention.
  DhChain<N> chain;
  /// Where the chain stands: identity, or the first row of a modified chain.
  Isometry3 base = Isometry3::Identity();
  /// Joint limits.
  JointLimits<N> limits{};
};

/// A nominal arm whose number of joints is only known at run time.
struct RobotDescription {
  /// Its name.
  std::string name;
  bool modified = false;                            ///< rows are in Craig's convention
  std::vector<DhRow> rows{};                        ///< one a joint [m, rad]
  std::vector<std::pair<double, double>> limits{};  ///< lower and upper, one a joint [rad, m]; infinite where not given

  /// Of an arm of the catalogue.
  template <int N, class Convention>
  static RobotDescription of(const Robot<N, Convention>& robot) {
    RobotDescription out{std::string(robot.name), Convention::order.front() == DhParameter::alpha, {}, {}};
    for (int i = 0; i < N; ++i) {
      out.rows.push_back(robot.chain.row(i));
      out.limits.emplace_back(robot.limits.lower(i), robot.limits.upper(i));
    }
    return out;
  }

  /// Number of joints.
  int dof() const { return static_cast<int>(rows.size()); }

  /// The arm with N fixed; a modified chain is converted exactly.
  /// @throws std::invalid_argument unless N is `dof()`
  template <int N>
  NominalArm<N> arm() const {
    require(dof() == N && limits.size() == rows.size(), "RobotDescription: ", dof(), " joints, asked for ", N);
    std::array<DhRow, N> table{};
    JointLimits<N> bounds;
    for (int i = 0; i < N; ++i) {
      const auto k = static_cast<std::size_t>(i);
      table[k] = rows[k];
      bounds.lower(i) = limits[k].first;
      bounds.upper(i) = limits[k].second;
    }
    if (!modified) return {name, DhChain<N>::from_rows(table), Isometry3::Identity(), bounds};
    const auto standard = to_standard(DhChain<N, ModifiedDh>::from_rows(table));
    return {name, standard.model(), standard.base(), bounds};
  }
};

namespace detail {

/// One joint of a robot file.
inline void read_joint(const JsonNode& joint, RobotDescription& robot) {
  joint.allow_only({"type", "a_mm", "a_m", "alpha_deg", "alpha_rad", "d_mm", "d_m", "theta_deg", "theta_rad",
                    "beta_deg", "beta_rad", "lower_deg", "lower_rad", "lower_mm", "lower_m", "upper_deg", "upper_rad",
                    "upper_mm", "upper_m"});
  DhRow row;
  const std::string type = joint.has("type") ? joint.at("type").text() : "revolute";
  if (type != "revolute" && type != "prismatic")
    joint.at("type").fail("'" + quotable(type) + "' is neither revolute nor prismatic");
  row.joint = type == "revolute" ? JointType::revolute : JointType::prismatic;
  row.a = joint.length("a");
  row.alpha = joint.angle("alpha");
  row.d = joint.length("d");
  row.theta = joint.angle("theta");
  if (joint.has_quantity("beta")) row.beta = joint.angle("beta");
  constexpr double largest_length = 100, largest_angle = 100;
  for (const double length : {row.a, row.d})
    if (std::abs(length) > largest_length) joint.fail(message("a length of ", length, " m; is the unit right?"));
  for (const double angle : {row.alpha, row.theta, row.beta})
    if (std::abs(angle) > largest_angle) joint.fail(message("an angle of ", angle, " rad; is the unit right?"));
  std::pair<double, double> bounds{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const bool revolute = row.joint == JointType::revolute;
  if (joint.has_quantity("lower")) bounds.first = revolute ? joint.angle("lower") : joint.length("lower");
  if (joint.has_quantity("upper")) bounds.second = revolute ? joint.angle("upper") : joint.length("upper");
  if (!(bounds.first < bounds.second))
    joint.fail(message("lower limit ", bounds.first, " is not below upper limit ", bounds.second));
  robot.rows.push_back(row);
  robot.limits.push_back(bounds);
}

}  // namespace detail

/// A robot file:
///
///     {"name": "my arm", "convention": "standard",
///      "joints": [{"type": "revolute", "a_mm": 0, "alpha_deg": -90, "d_mm": 290, "theta_deg": 0,
///                  "lower_deg": -165, "upper_deg": 165}, ...]}
///
/// `convention` is standard or modified; `type` is revolute (by default) or prismatic, with limits in `lower_mm`,
/// `upper_mm`; `beta_deg` and limits may be left out; `_m` and `_rad` are understood too. 3 to 9 joints.
/// @throws DataError naming file and key
inline RobotDescription load_robot(const std::filesystem::path& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode root(document, path.string());
  root.allow_only({"name", "convention", "joints", "comment"});
  RobotDescription out;
  out.name = root.at("name").text();
  const std::string convention = root.at("convention").text();
  if (convention != "standard" && convention != "modified")
    root.at("convention").fail("'" + detail::quotable(convention) + "' is neither standard nor modified");
  out.modified = convention == "modified";
  const JsonNode joints = root.at("joints");
  if (joints.size() < 3 || joints.size() > 9) joints.fail(message("has ", joints.size(), " joints, must have 3 to 9"));
  for (std::size_t i = 0; i < joints.size(); ++i) detail::read_joint(joints.at(i), out);
  return out;
}

}  // namespace vernier
