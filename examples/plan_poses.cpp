// SPDX-License-Identifier: BSD-3-Clause
// Which poses to measure: joint values for an arm that is to be calibrated, or the most useful rows of a measured file.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "camera_plan.hpp"
#include "cli.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "joint_units.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "plan_figures.hpp"
#include "progress.hpp"
#include "robot_choice.hpp"
#include "sensor_options.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/planning/plan_measurements.hpp"

namespace {

namespace vn = vernier;

/// What the command line says.
struct Settings {
  support::RobotOptions robot;
  support::CsvOptions csv;
  support::JointUnits units;
  support::SensorOptions sensor;
  support::CameraPlan camera;
  vn::BoardPlaces places;  // that were proposed
  std::string data, model, region, from, held_out, out;
  vn::Index count = 0, add = 0, choose = 0, test_every = 0, candidates = 5000;
  std::vector<double> tracker{}, box{}, region_box{};
  double acceptance_deg = 180, link_radius_mm = 0;
  bool orientations = false, bound = false;
  int cover = 0;
};

vn::ToolBox tool_box(const std::vector<double>& mm) {
  return {1e-3 * vn::Vector3(mm[0], mm[2], mm[4]), 1e-3 * vn::Vector3(mm[1], mm[3], mm[5])};
}

/// Keeps the candidates at which the camera sees a board at one of some proposed places.
/// @throws UsageError if there are too few
template <int N>
void require_in_view(Settings& o, const vn::Framed<vn::DhChain<N>>& arm, vn::MeasurementCandidates<N>& candidates) {
  const vn::Framed<vn::DhChain<N>> flange_of(arm.model(), arm.base_frame(), vn::FrameParameters());
  const std::vector<vn::Isometry3> flanges = vn::poses(flange_of, candidates.joints);
  vn::BoardPlaces all = vn::propose_places(o.camera.view(), o.camera.mount == "flange", o.camera.in_flange(), flanges,
                                           candidates.joints, o.camera.places, o.camera.table_mm * 1e-3);
  std::vector<vn::Index> kept;
  for (std::size_t i = 0; i < all.place.size(); ++i)
    if (all.place[i] >= 0) kept.push_back(static_cast<vn::Index>(i));
  const vn::Index wanted = std::max(o.count, o.add);
  if (static_cast<vn::Index>(kept.size()) < wanted)
    throw support::UsageError(fmt::format(
        "{} of {} candidates see the board, {} are wanted; more --candidates or --places, another --carried, "
        "or wider --distances-mm and --tilt-deg",
        kept.size(), all.place.size(), wanted));
  vn::JointRows<N> joints(static_cast<vn::Index>(kept.size()), N);
  o.places = {all.in_base, {}};
  for (std::size_t k = 0; k < kept.size(); ++k) {
    joints.row(static_cast<vn::Index>(k)) = candidates.joints.row(kept[k]);
    o.places.place.push_back(all.place[static_cast<std::size_t>(kept[k])]);
  }
  candidates.joints = joints;
  candidates.previous.resize(0, N);
}

/// The rows to choose, in the order of the file; joints alone are looked at.
template <int N>
support::PlanOutcome choose_rows(const Settings& o, const vn::DescribedRobot<N>& robot, vn::PlanOptions& options) {
  const auto types = robot.arm.model().joint_types();
  vn::Dataset<N> data = vn::read_dataset<N>(o.from, types, o.csv.format()), held_out;
  if (o.test_every > 0) {
    vn::Split<N> parts = vn::split_every(data, o.test_every);
    data = std::move(parts.train);
    held_out = std::move(parts.test);
  }
  options.oriented = data.has_orientations();
  const auto plan = vn::plan_measurements(robot.arm, {data.joints(), data.previous(), {}}, options);
  std::vector<vn::Index> rows = plan.chosen;
  std::sort(rows.begin(), rows.end());
  vn::write_dataset(o.out, data.rows(rows), types, robot.controller);
  if (!o.held_out.empty()) vn::write_dataset(o.held_out, held_out, types, robot.controller);
  return {
      plan, {}, plan.joints, data.joints(), robot.arm.positions(plan.joints), robot.arm.positions(data.joints()), {},
      0,    0};
}

/// New poses, written in the order of their visits.
template <int N>
support::PlanOutcome plan_new(Settings& o, const vn::DescribedRobot<N>& robot, vn::PlanOptions& options,
                              std::uint64_t seed) {
  const auto types = robot.arm.model().joint_types();
  vn::MeasurementConstraints constraints{.controller = robot.controller};
  constexpr double mm = 1e-3;
  if (!o.box.empty()) constraints.tool_box = tool_box(o.box);
  if (!o.tracker.empty())
    constraints.tracker = vn::Tracker{.position = mm * vn::Vector3(o.tracker[0], o.tracker[1], o.tracker[2]),
                                      .acceptance = o.acceptance_deg * std::numbers::pi / 180};
  if (o.link_radius_mm > 0) constraints.link_radii.assign(N, mm * o.link_radius_mm);
  vn::Measurements<N> measured;
  if (!o.data.empty()) {
    measured.add(vn::read_dataset<N>(o.data, types, o.csv.format()));
    o.sensor.remark(o.data, !measured.poses().front().covariances().empty());
    options.oriented = options.oriented || measured.poses().front().has_orientations();
  }
  vn::Framed<vn::DhChain<N>> arm = robot.arm;
  double left_out_error = 0;
  if (!o.model.empty()) {
    const auto model = vn::load<N>(o.model);
    arm = vn::Framed<vn::DhChain<N>>(model.identified().model().chain(), robot.arm.base_frame(),
                                     model.identified().tool_frame());
    left_out_error = model.provenance().left_out_error;
  }
  vn::JointRows<N> region(0, N);
  if (!o.region.empty()) {
    region = vn::read_joints<N>(o.region, types, o.csv.format());
  } else if (!o.region_box.empty()) {
    vn::MeasurementConstraints inside{.controller = robot.controller};
    inside.tool_box = tool_box(o.region_box);
    region = vn::sample_candidates(arm, robot.limits, inside, 200, seed + 1).joints;
  }
  if (region.rows() > 0) options.criterion = vn::DesignCriterion::region_variance;
  auto candidates = vn::sample_candidates(arm, robot.limits, constraints, o.candidates, seed);
  if (o.camera.given()) require_in_view(o, arm, candidates);
  const auto plan = vn::plan_measurements(arm, candidates, options, measured, region);

  std::string text;
  const std::vector<vn::JointType> shown = robot.controller.types(types);
  const vn::MatrixX joints = robot.controller.to_controller(plan.joints);
  text += o.units.header(shown);
  text += o.camera.given() ? "board,visit\n" : "visit\n";
  std::vector<bool> seen(plan.chosen.size(), false);
  for (std::size_t i = 0; i < plan.visits.size(); ++i) {
    const auto row = static_cast<std::size_t>(plan.visits[i]);
    const vn::VectorX values = joints.row(plan.visits[i]).transpose();
    text += o.units.cells({values.data(), shown.size()}, shown);
    if (o.camera.given())
      text +=
          support::place_name(static_cast<std::size_t>(o.places.place[static_cast<std::size_t>(plan.chosen[row])])) +
          ',';
    text += seen[row] ? "check\n" : i < 3 ? "register\n" : "measure\n";
    seen[row] = true;
  }
  vn::write_file(o.out, text);
  return {plan,
          plan.rejected,
          plan.joints,
          candidates.joints,
          arm.positions(plan.joints),
          arm.positions(candidates.joints),
          {},
          measured.size(),
          left_out_error};
}

template <int N>
support::PlanOutcome plan_arm(Settings& o, const vn::RobotDescription& description, std::uint64_t seed,
                              const vn::ObserverRef& observer) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  vn::PlanOptions options{.count = std::max({o.count, o.add, o.choose}),
                          .oriented = o.orientations || o.camera.given()};
  options.errors.drives = robot.drives;
  options.errors.down = robot.down;
  options.errors.controller = robot.controller;
  o.sensor.apply(options.sensors);
  options.bin_count = o.cover;
  options.bound_iterations = o.bound ? 10 : 0;
  options.observer = observer;
  support::PlanOutcome out = o.choose > 0 ? choose_rows(o, robot, options) : plan_new(o, robot, options, seed);
  out.oriented = options.oriented;
  const auto types = robot.arm.model().joint_types();
  out.types.assign(types.begin(), types.end());
  return out;
}

support::Json to_json(const Settings& o, const std::string& robot, const support::PlanOutcome& found) {
  support::Json rejected = support::Json::object(), uncovered = support::Json::array();
  for (std::size_t r = 1; r < vn::num_rejections; ++r)
    rejected[vn::name_of(static_cast<vn::Rejection>(r))] = found.rejected[r];
  for (const vn::UncoveredBin& bin : found.plan.uncovered)
    uncovered.push_back({{"joint", bin.joint + 1}, {"lower", bin.range.lower}, {"upper", bin.range.upper}});
  const auto list = [](const vn::VectorX& v) { return std::vector<double>(v.begin(), v.end()); };
  return {{"robot", robot},
          {"poses", found.plan.chosen.size()},
          {"criterion", o.region.empty() && o.region_box.empty() ? "information" : "region_variance"},
          {"candidates", found.candidates.rows()},
          {"measured", found.measured},
          {"unknowns", found.plan.unknowns},
          {"rejected", rejected},
          {"uncovered", uncovered},
          {"chosen", found.plan.chosen},
          {"visits", found.plan.visits},
          {"information_nats", list(found.plan.log_det)},
          {"bound_nats", found.plan.bound},
          {"relative_error", list(found.plan.relative_error)},
          {"predicted_error_mm", list(1e3 * found.predicted_errors())},
          {"enough", found.plan.enough()}};
}

int run(support::Program& program) {
  Settings o;
  o.robot.add_to(program).required();
  support::Option count = program.add_option("--count", o.count, "number of poses to plan", "N").within(3, 100000);
  const support::Option data =
      program.add_option("--data", o.data, "poses measured so far: what they say is not measured again", "FILE");
  program
      .add_option("--model", o.model,
                  "what calibrate saved of --data: plans at that arm, with its error of left-out poses", "FILE")
      .needs(data);
  const support::Option add =
      program.add_option("--add", o.add, "number of poses to add to --data", "N").within(3, 100000).needs(data);
  support::Option choose =
      program.add_option("--choose", o.choose, "choose N rows of --from, by their joints alone", "N").within(3, 100000);
  support::Option from = program.add_option("--from", o.from, "measured poses, as calibrate reads them", "FILE");
  choose.needs(from).excludes(count).excludes(add);
  count.excludes(add);
  from.needs(choose);
  program.group(support::Group::validation);
  const support::Option every =
      program.add_option("--test-every", o.test_every, "never choose every K-th row of --from", "K")
          .within(2, 1000000)
          .needs(from);
  program.group(support::Group::output);
  program.add_output("--held-out", o.held_out, "write those rows to this file").needs(every);
  program.group(support::Group::input);
  o.csv.add_to(program);
  o.csv.add_euler_to(program);
  o.sensor.add_to(program);
  program.group(support::Group::model);
  o.camera.add_to(program);
  program.add_option("--tracker", o.tracker, "position of the tracker in the base frame of the arm [mm]", "X,Y,Z")
      .delimiter(',')
      .expected(3)
      .excludes(choose);
  program
      .add_setting("--acceptance-deg", o.acceptance_deg, "largest angle between the beam and the tool's z axis", "DEG")
      .within(1.0, 180.0);
  program
      .add_setting("--link-radius-mm", o.link_radius_mm,
                   "links so thick block the beam and must not collide; 0: neither", "MM")
      .within(0.0, 1e4);
  program.add_option("--box", o.box, "where the tool may be, in the base frame [mm]", "X0,X1,Y0,Y1,Z0,Z1")
      .delimiter(',')
      .expected(6)
      .excludes(choose);
  const support::Option region =
      program
          .add_option("--region", o.region, "joints q1_rad.. of the working region: best there, not all over", "FILE")
          .excludes(choose);
  program
      .add_option("--region-box", o.region_box, "the working region as a box of tool positions in the base frame [mm]",
                  "X0,X1,Y0,Y1,Z0,Z1")
      .delimiter(',')
      .expected(6)
      .excludes(choose)
      .excludes(region);
  program.add_flag("--orientations", o.orientations, "orientations are measured as well");
  program
      .add_setting("--cover", o.cover, "minimum number of poses in each 10 degrees of each joint that can be reached",
                   "N")
      .within(0, 1000);
  program.add_setting("--candidates", o.candidates, "number of random poses to choose from; 50000 for a camera", "N")
      .within(3, 1000000);
  program.add_flag("--bound", o.bound, "print an upper bound of the information that as many poses can have");
  program.group(support::Group::output);
  o.units.add_to(program).excludes(choose);
  program.parse("", "write the poses to this file", "FILE");
  o.sensor.note(program);
  o.out = program.common().out;
  if (o.camera.given() && !program.given("--candidates")) o.candidates = 50000;  // few see a board
  if (o.camera.given() && o.choose > 0) throw support::UsageError("--camera-mount plans new poses, without --choose");
  if (o.count + o.add + o.choose == 0) throw support::UsageError("one of --count, --add and --choose is required");
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.csv.controller = robot.controller;
  support::Working working("planning");
  const auto watch = [&](const vn::Progress& progress) {
    working.reach(static_cast<double>(progress.generation) / static_cast<double>(std::max({o.count, o.add, o.choose})));
  };
  const support::PlanOutcome found =
      support::dispatch_dof(robot.dof(), [&](auto n) { return plan_arm<n()>(o, robot, program.common().seed, watch); });
  working.finish();

  const vn::PlannedMeasurements& plan = found.plan;
  fmt::print("{}: {} poses of {} candidates, to determine {} unknowns\n", robot.name, plan.chosen.size(),
             found.candidates.rows(), plan.unknowns);
  for (std::size_t r = 1; r < vn::num_rejections; ++r)
    if (found.rejected[r] > 0)
      fmt::print("Not among the candidates: {} poses, {}\n", found.rejected[r],
                 vn::name_of(static_cast<vn::Rejection>(r)));
  fmt::print("Information about the unknowns: {:.1f} nats{}\n", plan.log_det(plan.log_det.size() - 1),
             std::isfinite(plan.bound) ? fmt::format("; no choice of as many has more than {:.1f}", plan.bound) : "");
  const vn::Index all = static_cast<vn::Index>(plan.chosen.size()), half = all / 2;
  fmt::print("Predicted error with half of them, {}: {:.2f} times that with all\n", half, plan.relative_error(half));
  if (const vn::VectorX errors = found.predicted_errors(); errors.size() > 0)
    fmt::print(
        "Error of poses that were left out of the {} measured ones: {:.3f} mm (rms); after half of the new ones about "
        "{:.3f} mm, after all about {:.3f} mm\n",
        found.measured, errors(0) * 1e3, errors(half) * 1e3, errors(all) * 1e3);
  if (plan.enough() < all)
    fmt::print("From {} poses on, ten more reduce the predicted error by less than 2 %\n", plan.enough());
  const vn::Index values = all * (found.oriented ? 6 : 3);
  if (values < plan.unknowns)
    fmt::print(
        "These poses measure {} values, fewer than the unknowns; expected sizes supply the rest. {} poses would "
        "measure as many\n",
        values, (plan.unknowns + values / all - 1) / (values / all));
  bool gap = false;
  const std::vector<std::string> formulas = robot.controller.formulas(robot.joint_types());
  for (int j = 0; j < robot.dof(); ++j)
    if (const std::string gaps = support::gaps_of(found, j); !gaps.empty()) {
      fmt::print("Not covered by these poses: {} in {}\n",
                 robot.controller.same() ? fmt::format("q{}", j + 1) : formulas[static_cast<std::size_t>(j)], gaps);
      gap = true;
    }
  if (gap && o.choose == 0 && o.cover == 0) fmt::print("--cover 1 plans a pose in each of these ranges\n");
  if (o.choose == 0)
    fmt::print("{} visits: {}the first pose is visited {} times to see drift\n", plan.visits.size(),
               o.camera.given() ? "" : "the first three register the tracker, ",
               std::count(plan.visits.begin(), plan.visits.end(), plan.visits.front()));
  if (o.camera.given()) fmt::print("{}", support::describe_places(o.places, o.camera.mount));
  fmt::print("Poses: {}\n", support::shown(o.out));
  if (!program.common().json.empty()) {
    support::Json json = to_json(o, robot.name, found);
    if (o.camera.given()) json["places"] = support::to_json(o.places);
    support::write_json(program.common().json, json);
  }
  if (!support::has_room_beside(o.out)) return 0;
  if (const std::string figures = support::draw_plan(o.out, found); !figures.empty())
    fmt::print("Figures: {}\n", figures);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "plan_poses",
      "Plans which poses to measure for a calibration, or chooses the most useful rows of a measured file.",
      {"plan_poses --robot abb_irb120 --count 100 --orientations --out poses.csv",
       "plan_poses --robot abb_irb120 --data measured.csv --add 20 --out more.csv"}};
  return support::run_program(about, argc, argv, run);
}
