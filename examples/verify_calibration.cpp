// SPDX-License-Identifier: BSD-3-Clause
// Is a calibration still valid? A saved model and a few fresh poses in; a verdict out.

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "calibration_instances.hpp"
#include "cli.hpp"
#include "console.hpp"
#include "csv_options.hpp"
#include "data_instances.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "progress.hpp"
#include "report_page.hpp"
#include "sensor_options.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io.hpp"

namespace {

namespace vn = vernier;

struct Options {
  support::CsvOptions csv;
  support::SensorOptions sensor;
  std::string model, data, report, date;
  bool registered = false, tool = false, positions_only = false, no_approach = false;
  double accept_mm = 0, level = 0.05;
};

/// The arm and where its calibration comes from, as far as the model says so.
std::string calibrated(const std::string& name, const vn::Provenance& from) {
  std::string out = name;
  if (!from.date.empty()) out += fmt::format(", calibrated {}", from.date);
  if (from.rows > 0) out += fmt::format("{} from {} rows", from.date.empty() ? ", calibrated" : "", from.rows);
  if (from.rows > 0 && !from.data_file.empty()) out += fmt::format(" of {}", from.data_file);
  return out;
}

template <int N>
int verify_arm(const support::Program& program, Options& o, const vn::SavedModel& model) {
  const vn::CalibratedRobot<N> robot = model.as<N>();
  if (robot.estimate() == nullptr)
    throw support::UsageError(o.model +
                              ": has no covariance: an older program saved it, or what was learned is on geometry "
                              "alone; calibrate that arm again");
  const auto types = robot.nominal().chain().joint_types();
  o.csv.controller = robot.controller();
  vn::Dataset<N> data = vn::read_dataset<N>(o.data, types, o.csv.format());
  if (o.no_approach) data = data.without_approach();
  o.sensor.remark(o.data, !data.covariances().empty());
  vn::PointRows learned(robot.learned() != nullptr ? data.size() : 0, 3);
  for (vn::Index i = 0; i < learned.rows(); ++i) learned.row(i) = robot.learned()->error(data.joints(i)).transpose();
  vn::VerifyOptions options{.base = !o.registered, .tool = o.tool, .level = o.level};
  if (o.accept_mm > 0) options.accept = o.accept_mm * 1e-3;
  options.controller = robot.controller();
  o.sensor.apply(options.sensors);
  options.sensors.use_orientations = !o.positions_only;
  options.expected_error = robot.provenance().expected_error();
  options.fitted_rows = robot.provenance().fitted_rows;
  options.fitted_poses = options.fitted_rows.empty() && robot.provenance().fitted_to(data.origin().hashes.front());
  support::Working working("verifying");
  const vn::VerificationReport report =
      vn::verify_calibration(robot.model(), *robot.estimate(), data, options, learned);
  working.finish();

  const vn::Dataset<N> checked =
      report.known > 0 ? data.rows(options.fitted_rows.others(data.joints(), data.positions())) : data;
  const std::string summary = report.summary(), verdict = summary.substr(0, summary.find('\n'));
  fmt::print("{}{}\n", support::styled(verdict, report.valid ? support::Look::good : support::Look::bad),
             summary.substr(verdict.size()));
  fmt::print("Errors [mm]\n\n{}\n", vn::stage_table(vn::stages_of(report)));
  if (report.registration) fmt::print("{}\n", report.registration->summary());
  fmt::print("{}; {} poses of {}\n", calibrated(robot.name(), robot.provenance()), checked.size(), o.data);
  const support::Json json = vn::to_json(report, robot.name());
  if (!program.common().json.empty()) support::write_json(program.common().json, json);
  if (!o.report.empty()) {
    vn::ReportInput page = vn::report_input(report, robot.name());
    support::add_poses(page, robot.nominal().chain(), checked);
    page.provenance.inputs = {support::file_of(data.origin())};
    support::write_report(program, o.report, page, o.date, {model.file(), model.hash()});
    fmt::print("Report: {}\n", support::shown(o.report));
  }
  return report.valid ? 0 : 1;
}

int run(support::Program& program) {
  Options o;
  o.date = support::today();
  program.add_option("--model", o.model, "the calibrated model, as saved by calibrate", "FILE").required();
  program
      .add_option("--data", o.data,
                  "fresh measured poses, columns as for calibrate; 10 to 30 of them, joints moved widely", "FILE")
      .required();
  o.csv.add_to(program);
  o.csv.add_euler_to(program);
  o.sensor.add_to(program);
  program.group(support::Group::model);
  const support::Option registered = program.add_flag(
      "--registered", o.registered, "sensor and arm stand as they did: the base is not registered first");
  program.add_flag("--tool-remounted", o.tool, "the tool, or its probe, was taken off: it is registered, too")
      .excludes(registered);
  program.group(support::Group::validation);
  program
      .add_option("--accept-mm", o.accept_mm,
                  "the calibration is valid as long as its mean position error does not exceed this [mm]; else as long "
                  "as no change is significant",
                  "MM")
      .within(1e-6, 1e3);
  program.add_setting("--level", o.level, "probability of a false alarm about an arm that has not changed", "P")
      .within(1e-6, 0.5);
  program.group(support::Group::input);
  program.add_flag("--positions-only", o.positions_only, "ignore measured orientations");
  program.add_flag("--no-approach", o.no_approach,
                   "rows are not in the order of measuring: no hysteresis by the direction of approach");
  program.group(support::Group::output);
  program.add_output("--report", o.report, "write the results as one HTML page that needs nothing else");
  program.add_setting("--date", o.date, "date written into the report", "DATE");
  program.parse("", nullptr);
  o.sensor.note(program);
  const vn::SavedModel model = vn::read_model(o.model);
  return support::dispatch_dof(model.dof(), [&](auto n) { return verify_arm<n()>(program, o, model); });
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "verify_calibration",
      "Tests with a few fresh poses whether a calibration is still valid, and says which joint has changed.",
      {"verify_calibration --model model.json --data fresh.csv",
       "verify_calibration --model model.json --data fresh.csv --accept-mm 0.2 --report verification.html"},
      "the calibration is valid",
      "not valid, or no answer, which a line on standard error explains"};
  return support::run_program(about, argc, argv, run);
}
