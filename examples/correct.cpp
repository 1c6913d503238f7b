// A calibrated model and a file of targets in, corrected joint commands out.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "dispatch.hpp"
#include "json_file.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"

namespace {

namespace vn = vernier;

/// What became of the targets.
struct CorrectionReport {
  std::string robot;                    ///< name in the model
  std::vector<double> errors{};         ///< distance from each target that the model predicts for its command [m]
  std::vector<vn::Index> missed{};      ///< targets that are not met, counted from 0
  std::optional<double> temperature{};  ///< for which commands are corrected [deg C], where that matters
  bool clamped = false;                 ///< whether the temperature asked for is not that
  vn::Index extrapolated = 0;           ///< targets outside the measured joint ranges, where the learned part fades out
};

const char* words(vn::IkStatus status) {
  switch (status) {
    case vn::IkStatus::converged: return "converged";
    case vn::IkStatus::unreachable: return "unreachable";
    default: return "stalled";
  }
}

/// Corrects every target and writes the commands, whole or not at all: columns q1_rad .. (q1_m for a prismatic joint),
/// status, predicted_error_mm, gate.
/// @param poses the targets are poses x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements, their
/// joints only seeds that choose the branch; else the targets are where the nominal arm stands at the joints
/// @param approach each command is the one to which the arm moves from the command before; else the direction of
/// approach is unknown
/// @param temperature of the arm [deg C], where it is known
/// @throws vn::DataError on a malformed file
/// @throws std::runtime_error where the commands cannot be written
template <int N>
CorrectionReport correct_arm(const std::filesystem::path& model, const std::filesystem::path& targets, bool poses,
                             bool approach, std::optional<double> temperature, const std::filesystem::path& out) {
  using vn::Index;
  const vn::CalibratedRobot<N> saved = vn::load<N>(model);
  const vn::CalibratedRobot<N> robot = temperature ? saved.at_temperature(*temperature) : saved;
  vn::Dataset<N> data;
  if (poses) {
    data = vn::read_dataset<N>(targets, robot.nominal().chain().joint_types());
    if (N >= 6 && !data.has_orientations())
      throw vn::DataError(targets.string() + ": no columns rx_rad, ry_rad, rz_rad; a pose of an arm of " +
                          std::to_string(N) + " joints has an orientation");
  } else {
    vn::JointRows<N> joints = vn::read_joints<N>(targets, robot.nominal().chain().joint_types());
    const Index n = joints.rows();
    data = vn::Dataset<N>(std::move(joints), vn::PointRows::Zero(n, 3));
  }

  CorrectionReport report{robot.name()};
  if (const vn::ThermalRates* thermal = saved.model().thermal()) {
    report.temperature = robot.model().thermal()->reference;
    report.clamped = temperature && *temperature != report.temperature;
  } else if (temperature) {
    report.clamped = true;
  }
  std::string text;
  for (int j = 0; j < N; ++j)
    text += vn::message("q", j + 1, robot.nominal().chain().row(j).joint == vn::JointType::revolute ? "_rad," : "_m,");
  text += "status,predicted_error_mm,gate\n";
  vn::JointVector<N> previous = vn::JointVector<N>::Constant(std::numeric_limits<double>::quiet_NaN());
  for (Index i = 0; i < data.size(); ++i) {
    const vn::JointVector<N> q = data.joints(i);
    vn::Isometry3 target = robot.nominal().pose(q);
    if (poses) {
      target.translation() = data.position(i);
      if (data.has_orientations()) target.linear() = data.orientation(i);
    }
    const vn::Correction<N> correction = robot.correct(target, q, previous);
    if (approach) previous = correction.command;
    for (int j = 0; j < N; ++j) text += vn::message(correction.command(j), ',');
    text += vn::message(words(correction.status), ',', correction.predicted_error * 1e3, ',', correction.gate, '\n');
    report.errors.push_back(correction.predicted_error);
    if (correction.status != vn::IkStatus::converged) report.missed.push_back(i);
    if (correction.gate < 1) ++report.extrapolated;
  }
  vn::write_file(out, text);
  return report;
}

int run(support::Program& program) {
  std::string model, targets;
  bool poses = false, no_approach = false;
  std::optional<double> temperature;
  CLI::App& app = program.app();
  app.add_option("--model", model, "calibrated model that calibrate saved")->required()->type_name("FILE");
  app.add_option("--targets", targets, "joints q1_rad.. at which the nominal arm stands where the actual one is to go")
      ->required()
      ->type_name("FILE");
  app.add_flag("--poses", poses,
               "targets are poses x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements; q1_rad.. "
               "choose the branch");
  app.add_flag("--no-approach", no_approach,
               "the commands are not executed in the order of the file: correct for the middle of both directions of "
               "approach, not for the approach from the command before");
  app.add_option("--temperature-c", temperature,
                 "temperature of the arm [deg C], for a model that changes with it; by default the mean of its "
                 "measurements")
      ->type_name("T");
  program.parse("", "write the commands to this file", "FILE");
  const std::string& out = program.common().out;
  if (out.empty()) throw support::UsageError("--out is required");
  support::require_writable(out);

  const CorrectionReport report = support::dispatch_dof(vn::saved_arm(model).dof, [&](auto n) {
    return correct_arm<n()>(model, targets, poses, !no_approach, temperature, out);
  });
  const auto n = report.errors.size(), missed = report.missed.size();
  const double largest = *std::max_element(report.errors.begin(), report.errors.end()) * 1e3;
  const double mean = std::accumulate(report.errors.begin(), report.errors.end(), 0.0) / static_cast<double>(n) * 1e3;
  fmt::print("{}: {} of {} targets corrected; the model predicts errors of {:.2g} mm (mean), {:.2g} mm (largest)\n",
             report.robot, n - missed, n, mean, largest);
  if (report.temperature)
    fmt::print("Corrected for {:.4g} deg C{}\n", *report.temperature,
               report.clamped ? ", the nearest that was measured"
               : temperature  ? ""
                              : ", the mean of the measurements");
  else if (report.clamped)
    fmt::print("The model does not change with temperature; --temperature-c has no effect\n");
  if (report.extrapolated > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n",
               report.extrapolated);
  fmt::print("Commands: {}\n", out);
  if (!program.common().json.empty()) {
    std::vector<vn::Index> rows;
    for (const auto i : report.missed) rows.push_back(i + 1);
    support::write_json(program.common().json, {{"robot", report.robot},
                                                {"targets", n},
                                                {"corrected", n - missed},
                                                {"missed_rows", rows},
                                                {"extrapolated", report.extrapolated},
                                                {"predicted_error", {{"mean_mm", mean}, {"max_mm", largest}}}});
  }
  if (missed == 0) return 0;
  std::string rows;
  for (std::size_t i = 0; i < missed && i < 5; ++i) rows += fmt::format("{}{}", i ? ", " : "", report.missed[i] + 1);
  throw std::runtime_error(fmt::format("{} of {} targets cannot be met, their rows in {} say so: row {}{}", missed, n,
                                       out, rows, missed > 5 ? ", ..." : ""));
}

}  // namespace

int main(int argc, char** argv) {
  return support::run_program("correct", "Targets in, corrected joint commands out.", argc, argv, run);
}
