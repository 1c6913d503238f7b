// SPDX-License-Identifier: BSD-3-Clause
// Repeated visits and runs in, accuracy and repeatability after ISO 9283 out; or the poses of such a test.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli.hpp"
#include "csv_options.hpp"
#include "figures.hpp"
#include "json_file.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/iso9283.hpp"
#include "vernier/evaluation/iso9283_path.hpp"
#include "vernier/evaluation/iso9283_poses.hpp"
#include "vernier/io/iso9283_json.hpp"

namespace {

namespace vn = vernier;

/// What the command line says.
struct Settings {
  support::CsvOptions csv;
  std::string data, commanded, path, runs;
  bool plan = false;
  std::vector<double> centre{}, rotation{0, 0, 0};
  std::optional<double> edge{};
  int plane = 1, points = 10;
};

/// The commanded poses of a file, in the order of their numbers.
/// @throws vn::DataError unless they are numbered 1, 2, ...
std::vector<vn::Isometry3> commanded_poses(const std::string& path, const vn::LabelledPoses& file) {
  std::map<int, vn::Isometry3> sorted;
  for (std::size_t i = 0; i < file.poses.size(); ++i) sorted[file.labels(static_cast<vn::Index>(i), 0)] = file.poses[i];
  std::vector<vn::Isometry3> out;
  for (const auto& [number, pose] : sorted) out.push_back(pose);
  if (sorted.begin()->first != 1 || sorted.rbegin()->first != static_cast<int>(file.poses.size()))
    throw vn::DataError(vn::message(path, ": column pose must number its ", file.poses.size(), " poses 1, 2, ..."));
  return out;
}

/// In thousandths.
std::string milli(const vn::Vector3& v) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f})", v.x() * 1e3, v.y() * 1e3, v.z() * 1e3);
}

/// Deviations of the visits of a pose from their barycentre, with the circle of RP.
void plot_visits(const std::string& prefix, const vn::Iso9283Pose& pose, const std::vector<vn::Iso9283Visit>& visits) {
  support::Series xy{"visits", {}, {}, support::Style::points, 5}, xz = xy,
                                                                   circle{"RP", {}, {}, support::Style::dashed, 0};
  for (const auto& visit : visits) {
    if (visit.pose != pose.pose || visit.direction != pose.direction) continue;
    const vn::Vector3 d = 1e6 * (visit.measured.translation() - pose.mean.translation());
    for (support::Series* series : {&xy, &xz}) series->x.push_back(d.x());
    xy.y.push_back(d.y());
    xz.y.push_back(d.z());
  }
  for (int k = 0; k <= 72; ++k) {
    circle.x.push_back(1e6 * pose.rp * std::cos(k * std::numbers::pi / 36));
    circle.y.push_back(1e6 * pose.rp * std::sin(k * std::numbers::pi / 36));
  }
  const std::string file = fmt::format("{}_p{}.svg", prefix, pose.pose);
  if (support::panels_svg(file, fmt::format("Visits of P{} about their barycentre", pose.pose), "x [um]", "y, z [um]",
                          {{"y over x", {xy, circle}}, {"z over x", {xz, circle}}}, {.equal_axes = true}))
    fmt::print("Visits of P{}: {}\n", pose.pose, file);
}

void print(const vn::Iso9283& result) {
  for (const auto& p : result.poses) {
    fmt::print("P{}: AP {:.4f} mm ({:.4f} without what scatter adds", p.pose, p.ap * 1e3, p.ap_debiased * 1e3);
    if (result.registration) fmt::print(", {:.4f} after registration", p.ap_registered * 1e3);
    fmt::print("), RP {:.4f} mm [{:.4f}, {:.4f}], {} visits\n", p.rp * 1e3, p.rp_low * 1e3, p.rp_high * 1e3, p.n);
    if (p.ap_abc.allFinite())
      fmt::print("P{}: AP of angles {} mrad, RP of angles {} mrad\n", p.pose, milli(p.ap_abc), milli(p.rp_abc));
  }
  if (const auto& d = result.distance)
    fmt::print("P{} to P{}: AD {:+.4f} mm, RD {:.4f} mm, {} cycles\n", d->first, d->second, d->ad * 1e3, d->rd * 1e3,
               d->n);
  for (const auto& one : result.variations)
    fmt::print("P{}: vAP {:.4f} mm of {} directions\n", one.pose, one.vap * 1e3, one.directions);
  for (const auto& one : result.drift)
    fmt::print("P{}: dAP {:.4f} mm, dRP {:.4f} mm over {} groups of visits\n", one.pose, one.dap * 1e3, one.drp * 1e3,
               one.groups.size());
}

void print_departures(const char* what, const std::vector<std::string>& departures) {
  if (departures.empty()) fmt::print("{}: as ISO 9283 asks for, as far as the data tell\n", what);
  for (const auto& one : departures) fmt::print("{}, not as in ISO 9283: {}\n", what, one);
}

/// Writes the five poses of a cube.
int plan(support::Program& program, const Settings& settings, std::string out) {
  if (settings.centre.size() != 3) throw support::UsageError("--plan needs --centre-mm X,Y,Z");
  if (settings.rotation.size() != 3) throw support::UsageError("--rotation-rad needs 3 values");
  if (!settings.edge) throw support::UsageError("--plan needs --edge-mm E");
  const vn::Vector3 centre(settings.centre.data()), rotation(settings.rotation.data());
  const auto poses = vn::iso9283_poses({1e-3 * centre, 1e-3 * *settings.edge}, vn::exp_so3(rotation), settings.plane);
  std::string text = "pose,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n";
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const vn::Vector3 p = (1e9 * poses[k].translation()).array().round() / 1e6;  // to a nanometre
    text += vn::message(k + 1, ',', p.x(), ',', p.y(), ',', p.z(), ',', rotation.x(), ',', rotation.y(), ',',
                        rotation.z(), '\n');
  }
  program.open_output("--out", out);
  vn::write_file(out, text);
  fmt::print("Poses P1 to P5: {}; the norm visits P5, P4, P3, P2, P1, 30 times\n", support::shown(out));
  return 0;
}

int run(support::Program& program) {
  Settings settings;
  program.add_option("--data", settings.data,
                     "measured visits: columns pose, cycle, x_mm, y_mm, z_mm, optionally direction (1, 2, 3), time_s "
                     "and rx_rad, ry_rad, rz_rad",
                     "FILE");
  program.add_option("--commanded", settings.commanded, "commanded poses: columns pose, x_mm .., optionally rx_rad ..",
                     "FILE");
  program.add_option("--path", settings.path, "commanded path: columns x_mm .., optionally rx_rad .., in its order",
                     "FILE");
  program.add_option(
      "--runs", settings.runs,
      "measured runs along the path: columns cycle, x_mm .., optionally rx_rad .., in the order of measuring", "FILE");
  settings.csv.add_to(program);
  settings.csv.add_euler_to(program);
  program.group(support::Group::model);
  program.add_setting("--points", settings.points, "points of the path that are compared", "M").within(1, 100000);
  program.add_flag("--plan", settings.plan, "write the five poses of a test to --out instead");
  program.add_option("--centre-mm", settings.centre, "centre of the cube", "X,Y,Z").delimiter(',');
  program.add_option("--edge-mm", settings.edge, "edge of the cube", "E").positive();
  program.add_setting("--plane", settings.plane, "diagonal plane of the cube", "1..4").within(1, 4);
  program.add_setting("--rotation-rad", settings.rotation, "rotation vector of the tool at all poses", "X,Y,Z")
      .delimiter(',');
  program.parse("", "beginning of the names of the figures; none without it. With --plan: file for the poses",
                "PREFIX");
  const std::string& out = program.common().out;
  if (settings.plan) {
    if (out.empty()) throw support::UsageError("--plan needs --out");
    return plan(program, settings, out);
  }
  if (settings.data.empty() && settings.path.empty()) throw support::UsageError("--data, --path or --plan is required");
  if (settings.data.empty() != settings.commanded.empty())
    throw support::UsageError("--data and --commanded belong together");
  if (settings.path.empty() != settings.runs.empty()) throw support::UsageError("--path and --runs belong together");

  if (out == "-") throw support::UsageError("--out takes the beginning of names, which cannot be standard output");
  if (!out.empty()) {
    const std::filesystem::path folder = std::filesystem::absolute(out).parent_path();
    if (!std::filesystem::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
    support::require_folder(folder);
  }

  const vn::CsvFormat format = settings.csv.format();
  support::Json document;
  if (!settings.data.empty()) {
    const auto poses = vn::read_labelled_poses(settings.commanded, {"pose"}, {}, format);
    const auto file = vn::read_labelled_poses(settings.data, {"pose", "cycle"}, {"direction"}, format);
    std::vector<vn::Iso9283Visit> visits;
    for (vn::Index i = 0; i < file.times.size(); ++i)
      visits.push_back({file.labels(i, 0), file.labels(i, 1), file.labels(i, 2),
                        file.poses[static_cast<std::size_t>(i)], file.times(i)});
    const vn::Iso9283 result =
        vn::iso9283(visits, commanded_poses(settings.commanded, poses),
                    {.orientations = file.oriented && poses.oriented, .seed = program.common().seed});
    print(result);
    print_departures("Poses", result.departures);
    document["iso9283"] = vn::to_json(result);
    for (const auto& pose : result.poses)
      if (!out.empty() && pose.n > 1) plot_visits(out, pose, visits);
  }
  if (!settings.path.empty()) {
    const auto path = vn::read_labelled_poses(settings.path, {}, {}, format);
    const auto file = vn::read_labelled_poses(settings.runs, {"cycle"}, {}, format);
    std::map<int, std::vector<vn::Isometry3>> cycles;
    for (vn::Index i = 0; i < file.times.size(); ++i)
      cycles[file.labels(i, 0)].push_back(file.poses[static_cast<std::size_t>(i)]);
    std::vector<std::vector<vn::Isometry3>> runs;
    for (auto& [cycle, poses] : cycles) runs.push_back(std::move(poses));
    const vn::Iso9283Path result =
        vn::iso9283_path(path.poses, runs, {.points = settings.points, .orientations = file.oriented && path.oriented});
    fmt::print("Path of {:.1f} mm: AT {:.4f} mm, RT {:.4f} mm, {} runs\n", result.length * 1e3, result.at * 1e3,
               result.rt * 1e3, result.runs);
    if (result.at_abc.allFinite())
      fmt::print("Path: AT of angles {} mrad, RT of angles {} mrad\n", milli(result.at_abc), milli(result.rt_abc));
    print_departures("Path", result.departures);
    document["path"] = vn::to_json(result);
  }
  if (!program.common().json.empty()) support::write_json(program.common().json, document);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "iso9283",
      "Computes accuracy and repeatability after ISO 9283 from repeated visits, or writes the poses of such a test.",
      {"iso9283 --plan --centre-mm 400,0,500 --edge-mm 300 --out poses.csv",
       "iso9283 --data visits.csv --commanded poses.csv --out figures/iso"}};
  return support::run_program(about, argc, argv, run);
}
