// SPDX-License-Identifier: BSD-3-Clause
// What most programs call, header-only: ./dev check headers compiles it with a careful user's warnings, so that the
// templates are seen with their arguments. Nothing runs it.

#include <cstdio>
#include <exception>
#include <string>
#include <vernier/compensation/correct_path.hpp>
#include <vernier/io.hpp>
#include <vernier/planning/plan_measurements.hpp>
#include <vernier/registration/reregister.hpp>
#include <vernier/robot_programs/correct_program.hpp>
#include <vernier/urdf.hpp>
#include <vernier/vernier.hpp>

namespace vn = vernier;

namespace {

vn::Measurements<6> measured() {
  vn::Measurements<6> out(vn::read_dataset<6>("poses.csv"));
  out.add(vn::read_distances<6>("wire.csv"));
  for (const vn::Contact& touches : vn::read_contacts("contacts.csv", 6)) out.add(touches);
  return out;
}

void calibrate_and_save(const vn::Robot<6>& robot) {
  const auto [train, test] = vn::split(vn::read_dataset<6>("poses.csv"), {.test_fraction = 0.2, .seed = 1});
  std::puts(vn::audit_data(robot, train).summary().c_str());
  const auto calibration = vn::calibrate(robot, train);
  const auto report = vn::evaluate(calibration, test, robot.limits);
  std::puts(report.summary().c_str());
  std::printf("held out: %.3f mm\n", 1e3 * vn::prediction_error(calibration.model(), test).mean);
  vn::save("model.json", calibration, {.name = "UR10", .limits = robot.limits});
}

void correct(const vn::Robot<6>& robot) {
  const auto saved = vn::load<6>("model.json");
  const vn::JointVector<6> q = vn::JointVector<6>::Constant(0.3);
  const vn::Isometry3 target = saved.nominal().pose(q);
  std::printf("send joint 1 to %.6f rad\n", saved.correct(q).command(0));
  const vn::ClosedForm closed_form(saved.nominal());
  const auto branches = vn::all_branches(closed_form, saved, target, {.limits = saved.limits(), .close_to = q});
  const vn::CorrectedPath<6> path =
      vn::correct_path(saved, closed_form, {{.pose = target}, {.pose = target}}, {.limits = robot.limits});
  std::printf("%zu branches, %zu points\n", branches.branches.size(), path.points.size());
  const std::string text = vn::read_file("part.mod");
  const auto program = vn::parse_program(vn::program_language("part.mod"), text, "part.mod");
  vn::write_file("corrected.mod", vn::replace_targets(text, program, vn::correct_program(program, saved).replaced()));
  std::puts(vn::c_source(saved).c_str());
  const auto moved = vn::reregister(saved.model(), vn::read_dataset<6>("six.csv"), {.base = true, .tool = false});
  std::puts(moved.summary().c_str());
}

void learn(const vn::Robot<6>& robot, const vn::Dataset<6>& data) {
  const auto tuned = vn::Tuned{vn::Elm{.hidden_nodes = 20}, vn::Pso{.particles = 10}, {.max_generations = 5}};
  const auto learned = vn::CartesianCompensation{tuned}.fit(robot.chain, data, {.seed = 1});
  std::printf("%.3f mm\n", 1e3 * vn::prediction_error(learned, data).mean);
}

}  // namespace

int main() try {
  const vn::Robot<6> robot = vn::robots::ur10();
  std::printf("%.3f mm\n", 1e3 * vn::identify(robot.chain, measured(), {}, {}, vn::own_solver).rms_after);
  calibrate_and_save(robot);
  correct(robot);
  learn(robot, vn::read_dataset<6>("poses.csv"));
  const auto candidates = vn::sample_candidates(robot.chain, robot.limits, {}, 500, 1);
  std::printf("%zu poses\n", vn::plan_measurements(robot.chain, candidates, {.count = 40}).chosen.size());
  const vn::UrdfChain urdf = vn::read_urdf("arm.urdf", "", "");
  std::puts(vn::export_urdf(urdf, urdf.robot.geometry(), {}).c_str());
  return robot.chain == vn::robots::ur10().chain && robot.limits.lower == robot.limits.upper ? 0 : 1;
} catch (const std::exception& e) {
  std::puts(e.what());
  return 1;
}
