// SPDX-License-Identifier: BSD-3-Clause
#include "correction_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "figures.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"

namespace support {
namespace {

namespace vn = vernier;

/// Deviation of linear moves over the length of the path, before and after.
bool draw_deviation(const std::filesystem::path& path, const CorrectionReport& report) {
  Series before{"ends corrected alone", {}, {}, Style::dashed, 0},
      after{"with inserted points", {}, {}, Style::lines, 5};
  double length = 0;  // of the path so far [mm]
  std::size_t first = 0;
  const vn::Vector3* last = nullptr;
  bool any = false;
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    if (report.rows[i].kind != "target") continue;
    const bool line = report.rows[i].ends_only > 0;  // joint moves have none
    const double begin = length;
    for (std::size_t k = first; k <= i; ++k) {
      const CommandRow& row = report.rows[k];
      if (row.point.allFinite()) {
        if (last != nullptr) length += 1e3 * vn::Vector3(row.point - *last).norm();
        last = &row.point;
      }
      after.x.push_back(length);
      after.y.push_back(line && row.deviation > 0 ? row.deviation * 1e3 : std::nan(""));
    }
    for (const double x : {begin, length}) {  // of the whole move
      before.x.push_back(x);
      before.y.push_back(line ? report.rows[i].ends_only * 1e3 : std::nan(""));
    }
    any = any || line;
    first = i + 1;
  }
  if (!any) return false;
  return plot_svg(path, "Deviation of the tool from its lines, as predicted", "length of the path [mm]",
                  "deviation [mm]", {before, after}, {.log_y = true});
}

/// The links of each branch of the first target, seen from the side: along the horizontal line from the base to the
/// tool, at equal scales.
bool draw_branches(const std::filesystem::path& path, const CorrectionReport& report) {
  std::vector<Panel> arms;
  for (const CommandRow& row : report.rows) {
    if (row.target != report.rows.front().target || row.links.empty()) continue;
    const vn::Vector3 reach = row.links.back() - row.links.front();
    const double length = std::hypot(reach.x(), reach.y());
    Series arm{"links", {}, {}, Style::lines, 5}, tool{"tool", {}, {}, Style::points, 4};
    for (const vn::Vector3& point : row.links) {
      const vn::Vector3 from = point - row.links.front();
      arm.x.push_back(length > 0 ? (from.x() * reach.x() + from.y() * reach.y()) / length : from.x());
      arm.y.push_back(from.z());
    }
    tool.x.push_back(arm.x.back());
    tool.y.push_back(arm.y.back());
    const bool within = row.status == "converged";
    if (!within) arm.style = Style::dashed;
    arm.name = within ? "links" : "links, beyond the limits";
    arms.push_back({row.kind, {arm, tool}});
  }
  if (arms.empty()) return false;
  return panels_svg(path, "All branches of the first target, seen from the side", "towards the tool [m]", "height [m]",
                    arms, {.equal_axes = true});
}

}  // namespace

CorrectionTotals totals(const CorrectionReport& report) {
  CorrectionTotals out;
  double counted = 0;
  std::vector<bool> reached(static_cast<std::size_t>(report.targets) + 1, false), displaced = reached;
  for (const CommandRow& row : report.rows) {
    const auto target = static_cast<std::size_t>(row.target);
    if (std::isfinite(row.error)) {
      out.mean += row.error * 1e3;
      out.largest = std::max(out.largest, row.error * 1e3);
      ++counted;
    }
    if (row.status == "jump" || row.status == "off_path") displaced[target] = true;
    out.inserted += row.kind == "inserted" ? 1 : 0;
    if (row.kind == "inserted") continue;
    if (row.status == "converged") reached[target] = true;
    out.extrapolated += row.gate < 1 ? 1 : 0;
    out.not_found += row.status == "not_found" ? 1 : 0;
    out.proven_out += row.status == "proven_out" ? 1 : 0;
    out.jumps += row.status == "jump" ? 1 : 0;
  }
  out.mean /= std::max(counted, 1.0);
  for (vn::Index i = 1; i <= report.targets; ++i) {
    const auto target = static_cast<std::size_t>(i);
    out.met += reached[target] ? 1 : 0;
    if (displaced[target])
      out.displaced.push_back(i);
    else if (!reached[target])
      out.missed.push_back(i);
  }
  return out;
}

namespace {

/// Six columns: position [mm] and rotation vector [rad].
std::string pose_columns(const vn::Isometry3& pose) {
  const vn::Vector3 at = pose.translation() * 1e3, turn = vn::log_so3(pose.linear());
  return vn::message(',', at.x(), ',', at.y(), ',', at.z(), ',', turn.x(), ',', turn.y(), ',', turn.z());
}

}  // namespace

std::string correction_csv(const CorrectionReport& report, const JointUnits& units) {
  std::string text = units.header(report.joints);
  text +=
      "status,predicted_error_mm,gate,target,point,predicted_rotation_mrad,deviation_mm,radius95_mm,"
      "singularity,singularity_deg";
  const bool poses = std::any_of(report.rows.begin(), report.rows.end(),
                                 [](const CommandRow& row) { return row.commanded.has_value(); });
  text += poses ? ",x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n" : "\n";
  for (const CommandRow& row : report.rows) {
    text += units.cells(row.command, report.joints);
    text += vn::message(row.status, ',', row.error * 1e3, ',', row.gate, ',', row.target, ',', row.kind, ',',
                        row.rotation * 1e3, ',', row.deviation * 1e3, ',', row.radius * 1e3, ',',
                        row.singularities.nearest(), ',');
    if (row.singularities.known) text += vn::message(row.singularities.nearest_angle() * 180 / std::numbers::pi);
    if (poses) text += row.commanded ? pose_columns(*row.commanded) : ",,,,,,";
    text += '\n';
  }
  return text;
}

nlohmann::json correction_json(const CorrectionReport& report, const CorrectionTotals& totals) {
  return {{"robot", report.robot},
          {"targets", report.targets},
          {"points", report.rows.size()},
          {"inserted", totals.inserted},
          {"corrected", totals.met},
          {"met", totals.met},
          {"not_found", totals.not_found},
          {"proven_out", totals.proven_out},
          {"jumps", totals.jumps},
          {"missed_rows", totals.missed},
          {"extrapolated", totals.extrapolated},
          {"predicted_error", {{"mean_mm", totals.mean}, {"max_mm", totals.largest}}},
          {"max_residual_um", totals.largest * 1e3},
          {"path", {{"before_max_mm", report.before * 1e3}, {"after_max_mm", report.after * 1e3}}}};
}

void print_correction(const CorrectionReport& report, const CorrectionTotals& totals) {
  fmt::print("{}: {} of {} targets corrected", report.robot, totals.met, report.targets);
  if (totals.met > 0) fmt::print("; in the model the tool meets them within {:.2g} mm", totals.largest);
  fmt::print("\n");
  if (report.expected_error > 0)
    fmt::print("The model itself errs by {:.3g} mm at poses it was not fitted to ({})\n", report.expected_error * 1e3,
               report.held_out ? "mean of held-out poses" : "rms of poses left out in turn");
  if (report.linear)
    fmt::print(
        "Linear moves: the tool leaves their lines by {:.2g} mm at most, with {} points inserted; by {:.2g} mm "
        "without\n",
        report.after * 1e3, totals.inserted, report.before * 1e3);
  if (report.temperature)
    fmt::print("Corrected for {:.4g} deg C{}\n", *report.temperature,
               report.clamped             ? ", the nearest that was measured"
               : report.temperature_given ? ""
                                          : ", the mean of the measurements");
  else if (report.clamped)
    fmt::print("The model does not change with temperature; --temperature-c has no effect\n");
  if (totals.extrapolated > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n",
               totals.extrapolated);
}

std::string correction_failure(const CorrectionReport& report, const CorrectionTotals& totals,
                               const std::string& file) {
  const auto list = [](const std::vector<vn::Index>& numbers) {
    std::string out;
    for (std::size_t i = 0; i < numbers.size() && i < 5; ++i) out += fmt::format("{}{}", i ? ", " : "", numbers[i]);
    return out + (numbers.size() > 5 ? ", ..." : "");
  };
  if (!totals.missed.empty())
    return fmt::format("{} of {} targets cannot be met, their rows in {} say so: row {}", totals.missed.size(),
                       report.targets, file, list(totals.missed));
  if (!totals.displaced.empty())
    return fmt::format(
        "{} of {} moves are not as asked: they leave their branch or their line; the rows in {} say so: target {}",
        totals.displaced.size(), report.targets, file, list(totals.displaced));
  return {};
}

bool draw_correction(const std::filesystem::path& path, const CorrectionReport& report) {
  if (report.branches) return draw_branches(path, report);
  return report.linear && draw_deviation(path, report);
}

}  // namespace support
