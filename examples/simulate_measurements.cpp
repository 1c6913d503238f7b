// SPDX-License-Identifier: BSD-3-Clause
// Measures a virtual arm: an arm of the catalogue or of a file with drawn errors, at given joint values.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "carried_camera.hpp"
#include "cli.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "payload_option.hpp"
#include "robot_choice.hpp"
#include "simulation.hpp"
#include "vernier/core/detail/quotable.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/reflectors.hpp"
#include "vernier/simulation/views.hpp"

namespace {

namespace vn = vernier;

struct Settings {
  support::RobotOptions robot;
  support::CsvOptions csv;
  support::PayloadOption payload{};
  support::CarriedCamera camera{};
  std::string poses, places, corners;
  double noise_mm = 0.03, noise_mrad = 0.05, backlash_mrad = 0.02, gears_urad = 200, noise_px = 0.1;
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

/// What was measured.
struct Measured {
  vn::Index rows = 0;     ///< poses, or images
  vn::Index corners = 0;  ///< in all images
  vn::Index empty = 0;    ///< images that show none
};

/// Takes images of boards: corners and joints in a file each.
template <int N>
Measured take_images(const Settings& o, const vn::DescribedRobot<N>& robot, const vn::PlannedVisits<N>& visits,
                     const support::SimulationSettings& settings, const std::string& out, std::uint64_t seed) {
  const support::NamedPlaces places = support::read_places(o.places);
  if (visits.boards.empty())
    throw support::UsageError(o.poses + ": has no column board, which says which place each image shows");
  if (visits.payloads.rows() > 0)
    throw support::UsageError(o.poses + ": states payload_kg, which calibrations from images cannot use");
  vn::Rng rng(vn::child_seed(seed, 3));
  // hands put camera and boards where they shall be to some millimetres
  const auto roughly = [&](const vn::Isometry3& frame) {
    return vn::Isometry3(frame * support::drawn_frame(5e-3, 0.02, rng));
  };
  const bool on_flange = o.camera.on_flange();
  vn::CameraSetup setup{.on_flange = on_flange, .board = o.camera.printed()};
  setup.in_flange.push_back(roughly(o.camera.in_flange()));
  for (const vn::Isometry3& place : places.in_base) setup.in_base.push_back(roughly(place));
  setup.cameras.assign(on_flange ? 1 : places.names.size(), o.camera.camera());
  setup.camera_names = on_flange ? std::vector<std::string>{"camera"} : places.names;
  setup.board_names = on_flange ? places.names : std::vector<std::string>{"board"};

  const std::vector<vn::Isometry3> flanges =
      support::VirtualArm<N>(robot, settings, seed).poses(visits.joints, robot.arm.base(), vn::Isometry3::Identity());
  std::vector<vn::Shot> shots;
  vn::ImageRows rows;
  for (std::size_t i = 0; i < flanges.size(); ++i) {
    const auto place = std::find(places.names.begin(), places.names.end(), visits.boards[i]) - places.names.begin();
    if (place == static_cast<vn::Index>(places.names.size()))
      throw vn::DataError(o.poses + ": the place '" + vn::detail::quotable(visits.boards[i]) + "' is not in " +
                          o.places);
    shots.push_back({flanges[i], on_flange ? 0 : place, on_flange ? place : 0});
    rows.images.push_back(vn::message("image", i + 1, ".png"));
  }
  rows.joints = robot.controller.to_controller(visits.joints);
  const vn::CornerViews views =
      vn::simulate_views(setup, shots, o.noise_px, vn::child_seed(seed, support::digest(visits.joints)));
  vn::write_file(o.corners, vn::corners_text(views));
  vn::write_file(out, vn::image_joints_text(rows, robot.controller.types(robot.arm.model().joint_types())));
  return {rows.size(), views.corners(), rows.size() - static_cast<vn::Index>(views.views.size())};
}

template <int N>
Measured simulate(const Settings& o, const vn::RobotDescription& description, const std::string& out,
                  std::uint64_t seed) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const auto types = robot.arm.model().joint_types();
  const vn::PlannedVisits<N> visits = vn::read_visits<N>(o.poses, types, o.csv.format());
  const vn::JointRows<N>& joints = visits.joints;
  const support::SimulationSettings settings{o.noise_mm * 1e-3, o.noise_mrad * 1e-3, o.backlash_mrad * 1e-3,
                                             o.gears_urad * 1e-6, !o.positions_only};
  if (o.camera.given()) return take_images(o, robot, visits, settings, out, seed);
  const std::vector<vn::Dataset<N>> measured =
      support::simulated(robot, joints, settings, seed, o.points, payloads_of(o, visits));
  if (o.points == 1) {
    vn::write_dataset(out, measured.front(), types, robot.controller);
    return {joints.rows()};
  }
  std::vector<vn::ReflectorPoses<N>> reflectors;
  for (int point = 0; point < o.points; ++point) {
    std::vector<vn::Index> rows;
    for (vn::Index i = 0; i < joints.rows(); ++i)
      if (!o.in_turn || i % o.points == point) rows.push_back(i);
    reflectors.push_back({vn::message(point + 1), measured[static_cast<std::size_t>(point)].rows(rows)});
  }
  vn::write_reflectors<N>(out, reflectors, types, robot.controller);
  return {joints.rows()};
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
  support::Option noise =
      program.add_setting("--noise-mm", o.noise_mm, "standard deviation of a position, per component", "MM")
          .not_negative();
  support::Option noise_of_turns =
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
  support::Option positions = program.add_flag("--positions-only", o.positions_only, "orientations are not measured");
  support::Option points =
      program
          .add_setting("--points", o.points,
                       "number of reflectors on the flange, whose positions alone are measured (column point)", "N")
          .within(1, 20);
  support::Option in_turn =
      program.add_flag("--in-turn", o.in_turn, "each pose is measured with one of these reflectors, in turn");
  support::Option where = o.camera.add_to(
      program, "take images of a printed board: the flange carries the camera (flange) or the board (fixed)");
  for (support::Option one : {noise, noise_of_turns, positions, points, in_turn, program.option("--payload-kg")})
    where.excludes(one);
  where.needs(
      program
          .add_option("--places", o.places,
                      "where boards, or fixed cameras, stand (JSON, as plan_poses --json writes it); the column "
                      "board of --poses names the place of each image",
                      "FILE")
          .needs(where));
  program.add_setting("--noise-px", o.noise_px, "standard deviation of a corner, per component", "PX")
      .not_negative()
      .needs(where);
  program.group(support::Group::output);
  where.needs(program.add_output("--corners", o.corners, "write the corners of the images to this file").needs(where));
  program.parse("", "write the measured poses, or the joints of the images, to this file", "FILE");
  const std::string out = program.common().out;
  if (o.in_turn && o.points < 2) throw support::UsageError("--in-turn needs --points of two or more");
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.csv.controller = robot.controller;
  const Measured found =
      support::dispatch_dof(robot.dof(), [&](auto n) { return simulate<n()>(o, robot, out, program.common().seed); });
  if (o.camera.given()) {
    fmt::print("{}: {} images of the virtual arm of seed {}: {}; their {} corners: {}\n", robot.name, found.rows,
               program.common().seed, support::shown(out), found.corners, support::shown(o.corners));
    if (found.empty > 0) fmt::print("{} images show no corner\n", found.empty);
    return 0;
  }
  fmt::print("{} {}: {} poses of the virtual arm of seed {} measured: {}\n", robot.name,
             o.points > 1       ? fmt::format("({} reflectors{})", o.points, o.in_turn ? " in turn" : "")
             : o.positions_only ? "(positions)"
                                : "(poses)",
             found.rows, program.common().seed, support::shown(out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "simulate_measurements",
      "Simulates the measurement of an arm whose links, gears and encoders have errors and whose joints give way.",
      {"simulate_measurements --robot abb_irb120 --poses poses.csv --out measured.csv",
       "simulate_measurements --robot ur10 --poses views.csv --places plan.json --board board.json --intrinsics "
       "camera.json --camera-mount flange --carried 50,0,80,0,0,0 --corners corners.csv --out joints.csv"}};
  return support::run_program(about, argc, argv, run);
}
