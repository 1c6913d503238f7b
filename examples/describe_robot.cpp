// SPDX-License-Identifier: BSD-3-Clause
// Prints an arm as it is understood: rows, joints of the controller, axes and poses, to be compared with the pendant.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "cli.hpp"
#include "figures.hpp"
#include "json_file.hpp"
#include "robot_choice.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"

namespace {

namespace vn = vernier;

constexpr double degrees = 180 / std::numbers::pi;

/// An arm with its joints as the controller counts them.
class ShownArm {
 public:
  explicit ShownArm(const vn::RobotDescription& robot)
      : robot_(robot), geometry_(robot.geometry()), types_(robot.controller.types(robot.joint_types())) {}

  int joints() const { return static_cast<int>(types_.size()); }
  bool revolute(int joint) const { return types_[static_cast<std::size_t>(joint)] == vn::JointType::revolute; }
  double unit(int joint) const { return revolute(joint) ? degrees : 1e3; }
  const char* unit_name(int joint) const { return revolute(joint) ? "deg" : "mm"; }
  vn::VectorX chain_joints(const vn::VectorX& q) const {
    return robot_.controller.to_chain(q.transpose()).row(0).transpose();
  }
  vn::Isometry3 pose(const vn::VectorX& q) const { return geometry_.poses(chain_joints(q).transpose()).front(); }
  /// Base, origins of the links' frames, tool [m].
  std::vector<vn::Vector3> links(const vn::VectorX& q) const {
    const Lines found = lines(q);
    std::vector<vn::Vector3> out{vn::translation(geometry_.base().isometry())};
    for (vn::Index i = 0; i < found.origins.cols(); ++i) out.emplace_back(found.origins.col(i));
    out.emplace_back(pose(q).translation());
    return out;
  }
  /// Axes of the rows' joints in the base frame, a column each: directions, points [m], and origins behind them.
  struct Lines {
    vn::MatrixX directions, points, origins;
  };
  Lines lines(const vn::VectorX& q) const {
    const vn::Index n = geometry_.joints();
    const vn::VectorX values = chain_joints(q);
    Lines out{vn::MatrixX(3, n), vn::MatrixX(3, n), vn::MatrixX(3, n)};
    vn::detail::chain_links(geometry_.chain().view(), values.data(), out.directions.data(), out.points.data(),
                            out.origins.data());
    const vn::Isometry3& base = geometry_.base().isometry();
    for (vn::Index i = 0; i < n; ++i) {
      out.directions.col(i) = base.linear() * vn::Vector3(out.directions.col(i));
      out.points.col(i) = base * vn::Vector3(out.points.col(i));
      out.origins.col(i) = base * vn::Vector3(out.origins.col(i));
    }
    return out;
  }

 private:
  const vn::RobotDescription& robot_;
  vn::ArmGeometry geometry_;
  std::vector<vn::JointType> types_;
};

std::string numbers(const vn::Vector3& v, double factor, int decimals = 3) {
  const auto one = [&](double x) { return std::abs(x * factor) < 0.5 * std::pow(10, -decimals) ? 0.0 : x * factor; };
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", one(v.x()), decimals, one(v.y()), decimals, one(v.z()), decimals);
}

/// How the joint values of a pose are found.
std::string inverse_kinematics_of(const vn::RobotDescription& robot) {
  if (robot.dof() < 6) return "positions by iteration, of an arm with fewer than six joints";
  if (robot.dof() > 6) return "poses by iteration, near given joint values, of an arm with more than six joints";
  try {
    return vn::ClosedForm<6>(robot.arm<6>().arm).mirrored() ? "closed form, solved from the tool to the base"
                                                            : "closed form";
  } catch (const std::invalid_argument& reason) {
    return fmt::format("by a polynomial or by iteration; no closed form: {}", reason.what());
  }
}

/// Farthest and nearest distance of the tool from the base, of random joint values within the limits [m].
std::pair<double, double> reach_of(const ShownArm& arm, const vn::RobotDescription& robot, std::uint64_t seed) {
  vn::Rng rng(seed);
  std::pair<double, double> out{std::numeric_limits<double>::infinity(), 0};
  const vn::Vector3 base = arm.links(vn::VectorX::Zero(arm.joints())).front();
  for (int k = 0; k < 20000; ++k) {
    vn::VectorX q(arm.joints());
    for (int j = 0; j < arm.joints(); ++j) {
      const auto [lower, upper] = robot.limits[static_cast<std::size_t>(j)];
      const double widest = arm.revolute(j) ? std::numbers::pi : 1;
      q(j) = rng.uniform(std::max(lower, -widest), std::min(upper, widest));
    }
    const double distance = (vn::Vector3(arm.pose(q).translation()) - base).norm();
    out = {std::min(out.first, distance), std::max(out.second, distance)};
  }
  return out;
}

support::Json to_json(const vn::Isometry3& pose) {
  const vn::Vector3 position = 1e3 * pose.translation(), turn = degrees * vn::log_so3(pose.linear());
  return {{"position_mm", {position.x(), position.y(), position.z()}},
          {"rotation_vector_deg", {turn.x(), turn.y(), turn.z()}}};
}

void print_pose(const char* where, const vn::Isometry3& pose) {
  fmt::print("{}: tool at {} mm, rotation vector {} deg\n", where, numbers(pose.translation(), 1e3),
             numbers(vn::log_so3(vn::Matrix3(pose.linear())), degrees));
}

void print_rows(const vn::RobotDescription& robot) {
  fmt::print("{}: {} rows, {} convention\n\n  row  type       {:>10} {:>10} {:>10} {:>10}\n", robot.name, robot.dof(),
             robot.modified ? "modified" : "standard", "a mm", "alpha deg", "d mm", "theta deg");
  for (int i = 0; i < robot.dof(); ++i) {
    const vn::DhRow& row = robot.rows[static_cast<std::size_t>(i)];
    fmt::print("  {:>3}  {:<10} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}\n", i + 1,
               row.joint == vn::JointType::revolute ? "revolute" : "prismatic", row.a * 1e3, row.alpha * degrees,
               row.d * 1e3, row.theta * degrees);
  }
  const auto frame = [](const char* name, const vn::Isometry3& pose, bool known) {
    if (pose.isApprox(vn::Isometry3::Identity(), 1e-12) && !known) return;
    fmt::print("{} frame, {}: at {} mm, rotation vector {} deg\n", name, known ? "known" : "a starting value",
               numbers(pose.translation(), 1e3), numbers(vn::log_so3(vn::Matrix3(pose.linear())), degrees));
  };
  fmt::print("\n");
  frame("Base", robot.base, robot.base_known);
  frame("Tool", robot.tool, robot.tool_known);
  fmt::print("Gravity where the first row stands: {}\n", numbers(robot.down, 1));
}

void print_joints(const ShownArm& arm, const vn::RobotDescription& robot) {
  const std::vector<std::string> formulas = robot.controller.formulas(robot.joint_types());
  fmt::print("\nThe controller has {} joints{}\n", arm.joints(),
             robot.controller.same() ? ", those of the rows" : "; the rows follow from them:");
  for (std::size_t i = 0; i < formulas.size() && !robot.controller.same(); ++i)
    fmt::print("  row {}: {}\n", i + 1, formulas[i]);
  if (robot.controller.motor_errors()) {
    std::string motors;
    for (const std::string& joint : robot.controller.erring_joints(robot.joint_types()))
      motors += (motors.empty() ? "" : ", ") + joint;
    fmt::print("Gears err with the angles of motors: {}\n", motors);
  }
  fmt::print("Limits\n");
  for (int j = 0; j < arm.joints(); ++j) {
    const auto [lower, upper] = robot.limits[static_cast<std::size_t>(j)];
    fmt::print("  J{}: {} {}\n", j + 1,
               std::isfinite(lower) || std::isfinite(upper)
                   ? fmt::format("{:.6g} .. {:.6g}", lower * arm.unit(j), upper * arm.unit(j))
                   : std::string("none,"),
               arm.unit_name(j));
  }
}

/// The arm seen from the side and from above, at two configurations.
bool draw(const std::filesystem::path& path, const ShownArm& arm, const std::vector<vn::VectorX>& joints) {
  support::Panel side{"from the side: z over x", {}}, above{"from above: y over x", {}};
  const char* const names[] = {"at zero", "at the other joint values"};
  for (std::size_t k = 0; k < joints.size(); ++k) {
    support::Series in_side{names[k], {}, {}, support::Style::lines, k == 0 ? 0 : 4};
    support::Series in_above = in_side;
    for (const vn::Vector3& point : arm.links(joints[k])) {
      in_side.x.push_back(point.x());
      in_side.y.push_back(point.z());
      in_above.x.push_back(point.x());
      in_above.y.push_back(point.y());
    }
    side.series.push_back(in_side);
    above.series.push_back(in_above);
  }
  return support::panels_svg(path, "The arm: base, frames behind the joints, tool", "x [m]", "z, y [m]", {side, above},
                             {.equal_axes = true});
}

int run(support::Program& program) {
  support::RobotOptions options;
  std::vector<double> at;
  options.add_to(program).required();
  program.add_option("--joints", at, "joint values of the controller, of a pose to be compared [deg, mm]", "Q1,..")
      .delimiter(',');
  program.parse("describe_robot_out");
  program.require_output_folder();
  const vn::RobotDescription robot = support::choose_robot(options);
  const ShownArm arm(robot);
  if (!at.empty() && static_cast<int>(at.size()) != arm.joints())
    throw support::UsageError(fmt::format("--joints needs {} values", arm.joints()));
  const vn::VectorX zero = vn::VectorX::Zero(arm.joints());
  vn::VectorX other(arm.joints());
  for (int j = 0; j < arm.joints(); ++j)
    other(j) =
        at.empty() ? (arm.revolute(j) ? 20.0 : 100.0) / arm.unit(j) : at[static_cast<std::size_t>(j)] / arm.unit(j);

  print_rows(robot);
  print_joints(arm, robot);
  fmt::print("\nAxes of the rows at zero of the controller\n");
  const ShownArm::Lines lines = arm.lines(zero);
  for (int i = 0; i < robot.dof(); ++i)
    fmt::print("  row {}: direction {}, through {} mm\n", i + 1, numbers(vn::Vector3(lines.directions.col(i)), 1),
               numbers(vn::Vector3(lines.points.col(i)), 1e3));
  fmt::print("\n");
  print_pose("At zero", arm.pose(zero));
  std::string shown;
  for (int j = 0; j < arm.joints(); ++j) shown += fmt::format("{}{:.6g}", j > 0 ? ", " : "", other(j) * arm.unit(j));
  print_pose(fmt::format("At {}", shown).c_str(), arm.pose(other));
  const auto [nearest, farthest] = reach_of(arm, robot, program.common().seed);
  fmt::print("Tool from the base: {:.0f} to {:.0f} mm, of 20,000 random joint values within the limits\n",
             nearest * 1e3, farthest * 1e3);
  const std::string inverse = inverse_kinematics_of(robot);
  fmt::print("Inverse kinematics: {}\n", inverse);
  fmt::print(
      "\nCompare with the pendant, its tool frame zero: both poses above; and from zero, one joint at a time:\n");
  support::Json moves = support::Json::array();
  for (int j = 0; j < arm.joints(); ++j) {
    vn::VectorX q = zero;
    q(j) = 10 / arm.unit(j);
    const vn::Vector3 moved = arm.pose(q).translation() - arm.pose(zero).translation();
    const vn::Vector3 turned = vn::log_so3(vn::Matrix3(arm.pose(q).linear() * arm.pose(zero).linear().transpose()));
    fmt::print("  J{} +10 {}: the tool moves by {} mm and turns by {} deg\n", j + 1, arm.unit_name(j),
               numbers(moved, 1e3, 2), numbers(turned, degrees, 2));
    moves.push_back({{"joint", j + 1},
                     {"moved_mm", {moved.x() * 1e3, moved.y() * 1e3, moved.z() * 1e3}},
                     {"turned_deg", {turned.x() * degrees, turned.y() * degrees, turned.z() * degrees}}});
  }
  const std::filesystem::path figure = program.output_folder() / "arm.svg";
  if (draw(figure, arm, {zero, other})) fmt::print("Picture: {}\n", figure.string());
  if (!program.common().json.empty())
    support::write_json(program.common().json, {{"robot", robot.name},
                                                {"rows", robot.dof()},
                                                {"controller_joints", arm.joints()},
                                                {"formulas", robot.controller.formulas(robot.joint_types())},
                                                {"errors", robot.controller.motor_errors() ? "motors" : "chain"},
                                                {"at_zero", to_json(arm.pose(zero))},
                                                {"joints", std::vector<double>(other.begin(), other.end())},
                                                {"at_joints", to_json(arm.pose(other))},
                                                {"reach_mm", {nearest * 1e3, farthest * 1e3}},
                                                {"inverse_kinematics", inverse},
                                                {"moves", moves}});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"describe_robot",
                             "Prints an arm as it is understood, to be compared with the pendant of the controller.",
                             {"describe_robot --robot abb_irb120 --joints 10,20,30,0,45,0",
                              "describe_robot --robot my_arm.urdf --base-link base_link --tip-link tool0"}};
  return support::run_program(about, argc, argv, run);
}
