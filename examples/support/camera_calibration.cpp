// SPDX-License-Identifier: BSD-3-Clause
#include "camera_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "dispatch.hpp"
#include "file_name.hpp"
#include "json_file.hpp"
#include "robot_choice.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/model_file.hpp"
#ifdef VERNIER_HAS_URDF
#include "vernier/urdf/camera_yaml.hpp"
#endif

namespace support {

namespace {

namespace vn = vernier;

vn::Camera read_camera(const std::string& file) {
  if (std::filesystem::path(file).extension() == ".json") return vn::read_camera_json(file);
#ifdef VERNIER_HAS_URDF
  return vn::read_camera_yaml(file);
#else
  throw UsageError(file + ": this build reads cameras as JSON alone; YAML needs yaml-cpp and tinyxml2");
#endif
}

Json frames_json(const std::vector<std::string>& names, const std::vector<vn::Isometry3>& poses,
                 const std::vector<vn::Vector6>& stds) {
  Json out = Json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const vn::Vector3 turn = vn::log_so3(vn::rotation(poses[k]));
    Json one{{"name", names[k]}};
    for (vn::Index axis = 0; axis < 3; ++axis) {
      one["position_mm"].push_back(poses[k](axis, 3) * 1e3);
      one["rotation_vector_rad"].push_back(turn(axis));
      one["position_std_mm"].push_back(stds[k](axis) * 1e3);
      one["rotation_std_mrad"].push_back(stds[k](axis + 3) * 1e3);
    }
    out.push_back(std::move(one));
  }
  return out;
}

Json to_json(const vn::CameraReport& report) {
  const bool on_flange = report.mount == vn::CameraMount::flange;
  Json out{{"camera_mount", on_flange ? "flange" : "fixed"},
           {"mean_mm", report.mean * 1e3},
           {"left_out_mean_mm", report.left_out_mean * 1e3},
           {"left_out_max_mm", report.left_out_max * 1e3},
           {"choices_repeated", report.choices_repeated},
           {"pixel_sigma_px", report.pixel_sigma},
           {"ambiguous_views", report.ambiguous},
           {"downweighted_corners", report.downweighted},
           {"board_scale", report.board_scale},
           {"board_scale_std", report.board_scale_std},
           {"board_bend_mm", {report.board_bend(0) * 1e3, report.board_bend(1) * 1e3, report.board_bend(2) * 1e3}},
           {"without_row", report.without_row},
           {"without_corners", report.without_corners}};
  out[on_flange ? "base_T_board" : "base_T_camera"] =
      frames_json(on_flange ? report.board_names : report.camera_names, report.in_base, report.in_base_std);
  out[on_flange ? "flange_T_camera" : "flange_T_board"] =
      frames_json(on_flange ? report.camera_names : report.board_names, report.in_flange, report.in_flange_std);
  for (std::size_t c = 0; c < report.cameras.size(); ++c) {
    Json one{{"name", report.camera_names[c]}, {"intrinsics", vn::camera_to_json(report.cameras[c])}};
    for (vn::Index k = 0; k < vn::Camera::num_parameters; ++k)
      one["std"][vn::Camera::names[static_cast<std::size_t>(k)]] = report.camera_std[c](k);
    out["cameras"].push_back(std::move(one));
  }
  for (const vn::ImageError& image : report.images)
    out["images"].push_back({{"image", image.image},
                             {"camera", report.camera_names[static_cast<std::size_t>(image.camera)]},
                             {"board", report.board_names[static_cast<std::size_t>(image.board)]},
                             {"corners", image.corners},
                             {"rms_px", image.pixel_rms},
                             {"mean_mm", image.board_mean * 1e3},
                             {"left_out_mean_mm", image.left_out_mean * 1e3},
                             {"distance_mm", image.distance * 1e3},
                             {"tilt_deg", image.tilt * 180 / std::numbers::pi}});
  for (const vn::CameraBlock& block : report.blocks)
    out["decisions"].push_back({{"unknowns", block.name},
                                {"without_mm", block.without * 1e3},
                                {"with_mm", block.with * 1e3},
                                {"kept", block.kept}});
  for (const vn::CameraReport::Parameter& p : report.parameters)
    out["parameters"].push_back({{"name", p.name},
                                 {p.length ? "change_mm" : "change_mrad", p.change * 1e3},
                                 {p.length ? "std_mm" : "std_mrad", p.std * 1e3}});
  return out;
}

std::string image_table(const vn::CameraReport& report) {
  std::string out =
      fmt::format("\n  {:<24}{:>9}{:>10}{:>10}{:>14}\n", "image", "corners", "rms [px]", "mean [mm]", "left out [mm]");
  constexpr std::size_t most = 40;
  for (std::size_t k = 0; k < report.images.size() && k < most; ++k) {
    const vn::ImageError& image = report.images[k];
    out += fmt::format("  {:<24}{:>9}{:>10.3f}{:>10.3f}{:>14.3f}\n", image.image.substr(0, 23), image.corners,
                       image.pixel_rms, image.board_mean * 1e3, image.left_out_mean * 1e3);
  }
  if (report.images.size() > most) out += fmt::format("  and {} more: --json\n", report.images.size() - most);
  return out;
}

std::string parameter_table(const vn::CameraReport& report) {
  std::string out = fmt::format("\n  {:<10}{:>12}{:>12}\n", "parameter", "change", "std");
  for (const vn::CameraReport::Parameter& p : report.parameters)
    out +=
        fmt::format("  {:<10}{:>12.3f}{:>12.3f}  {}\n", p.name, p.change * 1e3, p.std * 1e3, p.length ? "mm" : "mrad");
  return out;
}

/// What a saved model says of the images.
vn::CameraSetup setup_of(const vn::CameraReport& report) {
  return {report.mount == vn::CameraMount::flange,
          report.cameras,
          report.camera_names,
          report.board,
          report.board_names,
          report.in_base,
          report.in_flange};
}

template <int N>
vn::CameraReport calibrate_arm(const CalibrationOptions& o, const vn::RobotDescription& description,
                               const vn::Board& board, const vn::CornerViews& views, const vn::CsvFormat& format,
                               const vn::CameraOptions& options) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const vn::ImageRows rows = vn::read_image_joints(o.data.front(), N, description.joint_types(), format);
  const auto found = vn::calibrate_by_camera(robot.arm, board, views, rows, options);
  if (!o.save.empty()) {
    vn::IdentificationReport no_covariance;
    vn::Provenance from{.rows = static_cast<vn::Index>(found.images.size()), .measured = "images"};
    from.camera = setup_of(found);
    const double sigma = found.left_out_mean > 0 ? found.left_out_mean : found.mean;
    vn::save(o.save, vn::detail::geometry_as_robot(
                         found.model, no_covariance, sigma, 0,
                         vn::RobotInfo<N>{.name = robot.name,
                                          .limits = robot.limits,
                                          .data_file = std::filesystem::path(o.data.front()).filename().string(),
                                          .date = o.date,
                                          .held_out_error = found.left_out_mean,
                                          .data_sha256 = rows.origin.hashes.front(),
                                          .controller = robot.controller},
                         std::move(from)));
  }
  if (!o.save_poses.empty()) {
    const vn::Measurements<N> poses = vn::measured_poses<N>(found, rows);
    for (std::size_t k = 0; k < poses.poses().size(); ++k) {
      const std::string file = k == 0 ? o.save_poses : numbered(o.save_poses, k + 1);
      vn::write_dataset(file, poses.poses()[k], description.joint_types(), robot.controller);
      fmt::print("Poses of {}: {}\n", poses.sets()[k].name, shown(file));
    }
  }
  return found;
}

}  // namespace

int calibrate_by_camera(Program& program, const CalibrationOptions& o) {
  const vn::Board board = vn::read_board(o.board);
  vn::CsvFormat format = o.csv.format();
  const vn::CornerViews views = vn::read_corners(o.corners, board, format);
  vn::CameraOptions options{.mount = o.camera_mount == "flange" ? vn::CameraMount::flange : vn::CameraMount::fixed,
                            .free = o.free_intrinsics,
                            .loss = o.calibrate.sensors.loss,
                            .geometry = o.calibrate.geometry};
  for (const std::string& file : o.intrinsics) options.cameras.push_back(read_camera(file));
  if (!options.cameras.empty() && options.cameras.size() != views.cameras.size())
    throw UsageError(fmt::format("{} files of --intrinsics, but the corners are of {} cameras", options.cameras.size(),
                                 views.cameras.size()));
  vn::CameraReport report;
  std::string name = "poses of the flange";
  if (!o.flange_poses.empty()) {
    report = vn::calibrate_hand_eye(board, views, vn::read_flange_poses(o.flange_poses, format), options);
  } else {
    const vn::RobotDescription robot = choose_robot(o.robot);
    name = robot.name;
    format.controller = robot.controller;
    report =
        dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(o, robot, board, views, format, options); });
  }
  fmt::print("{}\n{}{}", name, report.summary(), image_table(report));
  if (!report.parameters.empty()) fmt::print("{}", parameter_table(report));
  if (!program.common().json.empty()) write_json(program.common().json, to_json(report));
  if (!o.save.empty()) fmt::print("Calibrated model: {}\n", shown(o.save));
  return 0;
}

}  // namespace support
