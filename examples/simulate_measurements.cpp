// SPDX-License-Identifier: BSD-3-Clause
// Measures a virtual arm: an arm of the catalogue or of a file with drawn errors, at given joint values.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "cli.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "payload_option.hpp"
#include "robot_choice.hpp"
#include "simulation.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/reflectors.hpp"

namespace {

namespace vn = vernier;

struct Settings {
  support::RobotOptions robot;
  support::CsvOptions csv;
  support::PayloadOption payload{};
  std::string poses;
  double noise_mm = 0.03, noise_mrad = 0.05, backlash_mrad = 0.02, gears_urad = 200;
  bool positions_only = false, in_turn = false;
  int points = 1;
};

/// What the arm carries at each pose; no rows for nothing that is known.
/// @throws UsageError where both the poses and the command line say so
template <int N>
vn::MatrixX payloads_of(const Settings& o, const vn::PlannedVisits<N>& visits) {
  if (!o.payload.mass) return visits.payloads;
  if (visits.payloads.rows() > 0) throw support::UsageError("--payload-kg: " + o.poses + " states payload_kg");
  const vn::Payload payload = o.payload.payload();
  const vn::Index poses = visits.joints.rows();
  vn::MatrixX out(poses, 4);
  for (vn::Index i = 0; i < poses; ++i)
    for (vn::Index k = 0; k < 4; ++k) out(i, k) = k == 0 ? payload.mass : payload.centre(k - 1);
  return out;
}

template <int N>
vn::Index simulate(const Settings& o, const vn::RobotDescription& description, const std::string& out,
                   std::uint64_t seed) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const auto types = robot.arm.model().joint_types();
  const vn::PlannedVisits<N> visits = vn::read_visits<N>(o.poses, types, o.csv.format());
  const vn::JointRows<N>& joints = visits.joints;
  const support::SimulationSettings settings{o.noise_mm * 1e-3, o.noise_mrad * 1e-3, o.backlash_mrad * 1e-3,
                                             o.gears_urad * 1e-6, !o.positions_only};
  const std::vector<vn::Dataset<N>> measured =
      support::simulated(robot, joints, settings, seed, o.points, payloads_of(o, visits));
  if (o.points == 1) {
    vn::write_dataset(out, measured.front(), types, robot.controller);
    return joints.rows();
  }
  std::vector<vn::ReflectorPoses<N>> reflectors;
  for (int point = 0; point < o.points; ++point) {
    std::vector<vn::Index> rows;
    for (vn::Index i = 0; i < joints.rows(); ++i)
      if (!o.in_turn || i % o.points == point) rows.push_back(i);
    reflectors.push_back({vn::message(point + 1), measured[static_cast<std::size_t>(point)].rows(rows)});
  }
  vn::write_reflectors<N>(out, reflectors, types, robot.controller);
  return joints.rows();
}

int run(support::Program& program) {
  Settings o;
  o.robot.add_to(program).required();
  program
      .add_option("--poses", o.poses,
                  "joints q1_rad.. (q1_m.. of prismatic ones), visited in their order; may have payload_kg", "FILE")
      .required();
  o.csv.add_to(program);
  program.group(support::Group::model);
  program.add_setting("--noise-mm", o.noise_mm, "standard deviation of a position, per component", "MM").not_negative();
  program.add_setting("--noise-mrad", o.noise_mrad, "standard deviation of an orientation, per component", "MRAD")
      .not_negative();
  program.add_setting("--backlash-mrad", o.backlash_mrad, "half the play of every gear", "MRAD").not_negative();
  program
      .add_setting("--gears-urad", o.gears_urad,
                   "standard deviation of the errors of gears and encoders once a turn, per coefficient; order k up to "
                   "30 has 1/k of it, the meshing teeth (order 100) a twentieth; 0: none",
                   "URAD")
      .not_negative();
  o.payload.add_to(program,
                   "what the arm carries in all poses; by default what their column payload_kg says, else nothing");
  program.add_flag("--positions-only", o.positions_only, "orientations are not measured");
  program
      .add_setting("--points", o.points,
                   "number of reflectors on the flange, whose positions alone are measured (column point)", "N")
      .within(1, 20);
  program.add_flag("--in-turn", o.in_turn, "each pose is measured with one of these reflectors, in turn");
  program.parse("", "write the measured poses to this file", "FILE");
  const std::string out = program.common().out;
  if (o.in_turn && o.points < 2) throw support::UsageError("--in-turn needs --points of two or more");
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.csv.controller = robot.controller;
  const vn::Index rows =
      support::dispatch_dof(robot.dof(), [&](auto n) { return simulate<n()>(o, robot, out, program.common().seed); });
  fmt::print("{} {}: {} poses of the virtual arm of seed {} measured: {}\n", robot.name,
             o.points > 1       ? fmt::format("({} reflectors{})", o.points, o.in_turn ? " in turn" : "")
             : o.positions_only ? "(positions)"
                                : "(poses)",
             rows, program.common().seed, support::shown(out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "simulate_measurements",
      "Simulates the measurement of an arm whose links, gears and encoders have errors and whose joints give way.",
      {"simulate_measurements --robot abb_irb120 --poses poses.csv --out measured.csv",
       "simulate_measurements --robot rail.json --poses poses.csv --noise-mm 0.1 --positions-only --out measured.csv"}};
  return support::run_program(about, argc, argv, run);
}
