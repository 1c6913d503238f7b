// A calibrated model and a file of targets in, corrected joint commands out.

#include "correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "cli.hpp"
#include "json_file.hpp"

namespace {

int run(support::Program& program) {
  std::string model, targets;
  bool poses = false;
  CLI::App& app = program.app();
  app.add_option("--model", model, "calibrated model that calibrate saved")->required()->type_name("FILE");
  app.add_option("--targets", targets, "joints q1_rad.. at which the nominal arm stands where the actual one is to go")
      ->required()
      ->type_name("FILE");
  app.add_flag("--poses", poses,
               "targets are poses x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements; q1_rad.. "
               "choose the branch");
  program.parse("", "write the commands to this file", "FILE");
  const std::string& out = program.common().out;
  if (out.empty()) throw support::UsageError("--out is required");
  support::require_writable(out);

  const support::CorrectionReport report = support::correct_targets(model, targets, poses, out);
  const auto n = report.errors.size(), missed = report.missed.size();
  const double largest = *std::max_element(report.errors.begin(), report.errors.end()) * 1e3;
  const double mean = std::accumulate(report.errors.begin(), report.errors.end(), 0.0) / static_cast<double>(n) * 1e3;
  fmt::print("{}: {} of {} targets corrected; the model predicts errors of {:.2g} mm (mean), {:.2g} mm (largest)\n",
             report.robot, n - missed, n, mean, largest);
  if (report.extrapolated > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n",
               report.extrapolated);
  fmt::print("Commands: {}\n", out);
  if (!program.common().json.empty()) {
    std::vector<vernier::Index> rows;
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
