// SPDX-License-Identifier: BSD-3-Clause
// Measures a virtual arm: an arm of the catalogue or of a file with drawn errors, at given joint values.

#include <fmt/format.h>

#include <bit>
#include <string>

#include "cli.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "robot_choice.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace {

namespace vn = vernier;

struct Settings {
  support::RobotOptions robot;
  support::CsvOptions csv;
  std::string poses;
  double noise_mm = 0.03, noise_mrad = 0.05, backlash_mrad = 0.02, gears_urad = 200;
  bool positions_only = false;
};

/// A number of some joint values: other poses have other noise, the same ones the same.
std::uint64_t digest(const vn::MatrixX& joints) {
  std::uint64_t out = 0;
  for (vn::Index k = 0; k < joints.size(); ++k)
    out = vn::child_seed(out, std::bit_cast<std::uint64_t>(joints.data()[k]));
  return out;
}

template <int N>
vn::Index simulate(const Settings& o, const vn::RobotDescription& description, const std::string& out,
                   std::uint64_t seed) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const auto types = robot.arm.model().joint_types();
  const vn::JointRows<N> joints = vn::read_joints<N>(o.poses, types, o.csv.format());
  const auto chain = vn::with_geometric_errors(robot.arm.model(), {}, vn::child_seed(seed, 0));
  const double gears = o.gears_urad * 1e-6;
  vn::JointErrorSizes sizes{.harmonic = gears, .harmonics = 30, .ripple = gears / 20};
  sizes.down = robot.down;
  const auto errors = vn::draw_joint_errors(chain, sizes, vn::child_seed(seed, 1));
  // the sensor stands somewhere, the reflector is somewhere on the flange
  vn::Rng rng(vn::child_seed(seed, 2));
  const auto drawn = [&](double position, double rotation) {
    vn::Isometry3 frame = vn::Isometry3::Identity();
    for (int k = 0; k < 3; ++k) frame.translation()(k) = rng.uniform(-position, position);
    frame.linear() = vn::exp_so3(vn::Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)) * rotation);
    return frame;
  };
  const vn::Isometry3 base = drawn(3, 1.5) * robot.arm.base(), tool = robot.arm.tool() * drawn(0.1, 1);
  const vn::Framed<vn::WithJointErrors<vn::DhChain<N>>> arm(vn::WithJointErrors<vn::DhChain<N>>(chain, errors), base,
                                                            tool);
  vn::JointVector<N> backlash = vn::JointVector<N>::Zero();
  for (int j = 0; j < N; ++j)
    if (types[static_cast<std::size_t>(j)] == vn::JointType::revolute) backlash(j) = o.backlash_mrad * 1e-3;
  const vn::MeasurementNoise noise{o.noise_mm * 1e-3, o.noise_mrad * 1e-3, !o.positions_only};
  vn::write_dataset(out,
                    vn::measure_with_backlash(arm, joints, backlash, vn::approach_directions<N>(joints), noise,
                                              vn::child_seed(seed, digest(joints))),
                    types, robot.controller);
  return joints.rows();
}

int run(support::Program& program) {
  Settings o;
  o.robot.add_to(program).required();
  program.add_option("--poses", o.poses, "joints q1_rad.. (q1_m.. of prismatic ones), visited in their order", "FILE")
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
  program.add_flag("--positions-only", o.positions_only, "orientations are not measured");
  program.parse("", "write the measured poses to this file", "FILE");
  const std::string out = program.common().out;
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.csv.controller = robot.controller;
  const vn::Index rows =
      support::dispatch_dof(robot.dof(), [&](auto n) { return simulate<n()>(o, robot, out, program.common().seed); });
  fmt::print("{} {}: {} poses of the virtual arm of seed {} measured: {}\n", robot.name,
             o.positions_only ? "(positions)" : "(poses)", rows, program.common().seed, support::shown(out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "simulate_measurements",
      "Simulates the measurement of an arm whose links, gears, encoders and joints have errors.",
      {"simulate_measurements --robot abb_irb120 --poses poses.csv --out measured.csv",
       "simulate_measurements --robot rail.json --poses poses.csv --noise-mm 0.1 --positions-only --out measured.csv"}};
  return support::run_program(about, argc, argv, run);
}
