// SPDX-License-Identifier: BSD-3-Clause
#include "camera_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "dispatch.hpp"
#include "figures.hpp"
#include "file_name.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "progress.hpp"
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

/// How much of its range a joint had in the images: bins of a tenth of a radian or metre, angles within a turn.
struct SeenRange {
  double lower = 0, upper = 0;  ///< smallest and largest value [rad, m]
  double share = 0;             ///< of the bins of its range
  bool revolute = true;         ///< whether these are angles
};

template <int N>
std::vector<SeenRange> seen_ranges(const vn::DescribedRobot<N>& robot, const vn::ImageRows& rows,
                                   const vn::CameraReport& report) {
  constexpr double turn = 2 * std::numbers::pi, bin = 0.1;
  std::vector<SeenRange> out;
  const auto types = robot.arm.model().joint_types();
  for (int j = 0; j < N; ++j) {
    const double lowest = robot.limits.lower(j), highest = robot.limits.upper(j);
    SeenRange one{.lower = std::numeric_limits<double>::infinity(),
                  .upper = -std::numeric_limits<double>::infinity(),
                  .revolute = types[static_cast<std::size_t>(j)] == vn::JointType::revolute};
    const double range = one.revolute ? std::min(turn, highest - lowest) : highest - lowest;
    const double bins = std::isfinite(range) ? std::max(1.0, std::ceil(range / bin - 1e-9)) : 1;
    std::set<double> seen;
    for (const vn::ImagePose& pose : report.poses) {
      const double q = rows.joints(pose.row, j);
      one.lower = std::min(one.lower, q);
      one.upper = std::max(one.upper, q);
      const double from = one.revolute ? std::remainder(q - (lowest + highest) / 2, turn) + range / 2 : q - lowest;
      seen.insert(std::clamp(std::floor(from / range * bins), 0.0, bins - 1));
    }
    one.share = static_cast<double>(seen.size()) / bins;
    out.push_back(one);
  }
  return out;
}

std::string range_table(const std::vector<SeenRange>& ranges) {
  std::string out = fmt::format("\n  {:<10}{:>12}{:>12}{:>18}\n", "joint", "from", "to", "share of range");
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    const SeenRange& one = ranges[j];
    const double unit = one.revolute ? 180 / std::numbers::pi : 1e3;
    out += fmt::format("  q{:<9}{:>12.1f}{:>12.1f}{:>16.0f} %  {}\n", j + 1, one.lower * unit, one.upper * unit,
                       one.share * 100, one.revolute ? "deg" : "mm");
  }
  return out + "  Where a joint was not seen, its errors are not known; more places of the board show more\n";
}

Json to_json(const std::vector<SeenRange>& ranges) {
  Json out = Json::array();
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    const SeenRange& one = ranges[j];
    const double unit = one.revolute ? 180 / std::numbers::pi : 1e3;
    const char* name = one.revolute ? "deg" : "mm";
    out.push_back({{"joint", j + 1},
                   {fmt::format("from_{}", name), one.lower * unit},
                   {fmt::format("to_{}", name), one.upper * unit},
                   {"share", one.share}});
  }
  return out;
}

/// Residuals of a camera's corners over its image, enlarged: a pattern about the middle is distortion that is missing.
void draw_residuals(const std::filesystem::path& path, const vn::CameraReport& report, vn::Index camera) {
  double squares = 0, count = 0;
  std::array<double, 2> size{};
  const auto is_of = [&](const vn::CornerResidual& corner) {
    return report.images[static_cast<std::size_t>(corner.image)].camera == camera;
  };
  for (const vn::CornerResidual& corner : report.residuals) {
    if (!is_of(corner)) continue;
    squares += corner.residual_u * corner.residual_u + corner.residual_v * corner.residual_v;
    ++count;
    size = {std::max(size[0], corner.u), std::max(size[1], corner.v)};
  }
  const vn::Camera& intrinsics = report.cameras[static_cast<std::size_t>(camera)];
  if (intrinsics.width > 0) size = {static_cast<double>(intrinsics.width), static_cast<double>(intrinsics.height)};
  const double rms = std::sqrt(squares / std::max(count, 1.0));
  if (!(rms > 0)) return;
  const double wanted = 0.02 * size[0] / rms, decade = std::pow(10, std::floor(std::log10(wanted)));
  const double scale = decade * (wanted / decade >= 5 ? 5 : wanted / decade >= 2 ? 2 : 1);
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  Series found{.name = "found", .x = {}, .y = {}, .style = Style::points, .colour = 0},
      left{.name = fmt::format("to where the model has it, {:g} times", scale), .x = {}, .y = {}, .colour = 1};
  for (const vn::CornerResidual& corner : report.residuals) {
    if (!is_of(corner)) continue;
    found.x.push_back(corner.u);
    found.y.push_back(corner.v);
    left.x.insert(left.x.end(), {corner.u, corner.u + scale * corner.residual_u, gap});
    left.y.insert(left.y.end(), {corner.v, corner.v + scale * corner.residual_v, gap});
  }
  plot_svg(path,
           fmt::format("Residuals of {}: {:.3f} px rms", report.camera_names[static_cast<std::size_t>(camera)], rms),
           "u [px]", "v [px]", {left, found},
           {.x_range = std::pair(0.0, size[0]), .y_range = std::pair(size[1], 0.0), .equal_axes = true});
}

template <int N>
vn::CameraReport calibrate_arm(const CalibrationOptions& o, const vn::RobotDescription& description,
                               const vn::Board& board, const vn::CornerViews& views, const vn::CsvFormat& format,
                               vn::CameraOptions options, std::vector<SeenRange>& ranges) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const vn::ImageRows rows = vn::read_image_joints(o.data.front(), N, description.joint_types(), format);
  Working working("identifying arm and camera");
  const auto watch = [&](const vn::Progress& progress) { working.reach(share_of_images(progress.generation)); };
  options.observer = watch;
  const auto found = vn::calibrate_by_camera(robot.arm, board, views, rows, options);
  working.finish();
  ranges = seen_ranges(robot, rows, found);
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

vernier::Camera read_camera(const std::string& file) {
  if (std::filesystem::path(file).extension() == ".json") return vn::read_camera_json(file);
#ifdef VERNIER_HAS_URDF
  return vn::read_camera_yaml(file);
#else
  throw UsageError(file + ": this build reads cameras as JSON alone; YAML needs yaml-cpp and tinyxml2");
#endif
}

CameraInputs read_camera_inputs(const CalibrationOptions& o) {
  CameraInputs out{vn::read_board(o.board), {}, o.csv.format(), {}};
  out.views = vn::read_corners(o.corners, out.board, out.format);
  out.options = {.mount = o.camera_mount == "flange" ? vn::CameraMount::flange : vn::CameraMount::fixed,
                 .free = o.free_intrinsics,
                 .loss = o.calibrate.sensors.loss,
                 .geometry = o.calibrate.geometry};
  for (const std::string& file : o.intrinsics) out.options.cameras.push_back(read_camera(file));
  if (const std::size_t given = out.options.cameras.size(); given > 0 && given != out.views.cameras.size())
    throw UsageError(
        fmt::format("{} files of --intrinsics, but the corners are of {} cameras", given, out.views.cameras.size()));
  return out;
}

vernier::CameraSetup setup_of(const vernier::CameraReport& report) {
  return {report.mount == vn::CameraMount::flange,
          report.cameras,
          report.camera_covariances,
          report.camera_names,
          report.board,
          report.board_names,
          report.in_base,
          report.in_flange};
}

std::string camera_verdict(const vernier::CameraReport& report, const char* title) {
  std::string out = fmt::format("{}\n", title);
  for (const std::string& line : report.verdict()) out += fmt::format("- {}\n", line);
  return out;
}

std::string camera_details(const vernier::CameraReport& report, const CalibrationOptions& options) {
  std::string out;
  if (options.parameters)
    out = "\n" + report.frames_and_intrinsics() + (report.parameters.empty() ? "" : parameter_table(report));
  return options.verbose ? out + image_table(report) : out;
}

Json camera_json(const vernier::CameraReport& report) {
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

void draw_cameras(const std::filesystem::path& folder, const vernier::CameraReport& report) {
  for (std::size_t c = 0; c < report.cameras.size(); ++c)
    draw_residuals(folder / (c == 0 ? "residuals.svg" : fmt::format("residuals.{}.svg", c + 1)), report,
                   static_cast<vn::Index>(c));
}

int calibrate_by_camera(Program& program, const CalibrationOptions& o) {
  CameraInputs in = read_camera_inputs(o);
  program.require_output_folder();
  vn::CameraReport report;
  std::vector<SeenRange> ranges;
  std::string name = "poses of the flange";
  if (!o.flange_poses.empty()) {
    const vn::ImageRows rows = vn::read_flange_poses(o.flange_poses, in.format);
    Working working("finding the camera");
    const auto watch = [&](const vn::Progress& progress) { working.reach(share_of_images(progress.generation)); };
    in.options.observer = watch;
    report = vn::calibrate_hand_eye(in.board, in.views, rows, in.options);
  } else {
    const vn::RobotDescription robot = choose_robot(o.robot);
    name = robot.name;
    in.format.controller = robot.controller;
    report = dispatch_dof(robot.dof(), [&](auto n) {
      return calibrate_arm<n()>(o, robot, in.board, in.views, in.format, in.options, ranges);
    });
  }
  fmt::print("{}\n{}: {}\n", camera_verdict(report, "Verdict"), name, report.counts());
  if (!ranges.empty()) fmt::print("{}", range_table(ranges));
  fmt::print("{}\n", camera_details(report, o));
  if (!o.verbose || !o.parameters)
    fmt::print("Frames, intrinsics and links: --parameters; errors by image: --verbose\n");
  if (!program.common().json.empty()) {
    Json json = camera_json(report);
    if (!ranges.empty()) json["joints"] = to_json(ranges);
    write_json(program.common().json, json);
  }
  const std::filesystem::path folder = program.output_folder();
  draw_cameras(folder, report);
  fmt::print("Figures: {}\n", folder.string());
  if (!o.save.empty()) fmt::print("Calibrated model: {}\n", shown(o.save));
  return 0;
}

}  // namespace support
