// Measured poses in; a calibrated model and an honest held-out report out.

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>

#include "calibration.hpp"
#include "calibration_stages.hpp"
#include "cli.hpp"
#include "figures.hpp"
#include "json_file.hpp"
#include "progress.hpp"
#include "robot_choice.hpp"
#include "vernier/evaluation/statistics.hpp"

namespace {

using support::CalibrationReport;
using support::StageErrors;
using vernier::ErrorStatistics;

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
}

bool oriented(const CalibrationReport& report) { return report.stages.front().rotation.size() > 0; }

void print_table(const CalibrationReport& report) {
  fmt::print("\nErrors of the {} held-out poses [mm]\n\n", report.test_rows);
  fmt::print("{:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{}\n", "stage", "mean", "rms", "max", "min", "p95",
             oriented(report) ? "  mean [mrad]" : "");
  for (const StageErrors& stage : report.stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    fmt::print("{:<22}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}", stage.title, e.mean, e.rms, e.max, e.min, e.p95);
    if (stage.rotation.size() > 0) fmt::print("{:>13.4f}", stage.rotation.mean() * 1e3);
    fmt::print("\n");
  }
}

support::Json to_json(const vernier::RobotDescription& robot, const CalibrationReport& report) {
  support::Json stages, parameters = support::Json::array();
  for (const StageErrors& stage : report.stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    stages[stage.key] = {
        {"mean_mm", e.mean}, {"rms_mm", e.rms}, {"max_mm", e.max}, {"min_mm", e.min}, {"p95_mm", e.p95}};
  }
  for (const auto& p : report.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.kind == vernier::ParameterKind::length ? "mm" : "mrad"},
                          {"nominal", p.nominal * 1e3},
                          {"identified", p.identified * 1e3},
                          {"std", p.std * 1e3}});
  return {{"robot", robot.name},
          {"train_rows", report.train_rows},
          {"test_rows", report.test_rows},
          {"stages", stages},
          {"parameters", parameters},
          {"identifiability",
           {{"rank", report.rank}, {"free", report.free}, {"condition", report.condition}, {"weak", report.weak}}}};
}

void draw(const std::filesystem::path& folder, const std::string& robot, const CalibrationReport& report) {
  std::vector<std::string> titles;
  support::Series mean{"mean", {}, {}, support::Style::lines, 1}, p95{"95 %", {}, {}, support::Style::lines, 2};
  std::vector<support::Sample> samples;
  std::vector<support::Series> poses;
  for (const StageErrors& stage : report.stages) {
    const vernier::VectorX mm = stage.position * 1e3;
    const auto e = ErrorStatistics::of(mm);
    titles.push_back(stage.title);
    mean.y.push_back(e.mean);
    p95.y.push_back(e.p95);
    samples.push_back({stage.title, {mm.begin(), mm.end()}});
    if (stage.key == "geometry") continue;
    support::Series series{stage.key == "frames" ? "before: links nominal" : "after: " + stage.title,
                           {},
                           {mm.begin(), mm.end()},
                           support::Style::points};
    for (std::size_t i = 0; i < series.y.size(); ++i) series.x.push_back(static_cast<double>(i));
    poses.push_back(std::move(series));
  }
  for (std::size_t i = 0; i < titles.size(); ++i) {
    mean.x.push_back(static_cast<double>(i));
    p95.x.push_back(static_cast<double>(i));
  }
  support::bars_svg(folder / "stages.svg", robot + ": held-out position error of each stage", "position error [mm]",
                    titles, {mean, p95});
  support::plot_svg(folder / "distribution.svg", robot + ": held-out poses within an error", "position error [mm]",
                    "share of poses [%]", support::cumulative(samples));
  support::plot_svg(folder / "poses.svg", robot + ": each held-out pose, before and after", "held-out pose",
                    "position error [mm]", poses);
}

int run(support::Program& program) {
  support::CalibrationSettings settings;
  std::string robot_name, data, test, save, loss = "squared";
  double fraction = 0;
  settings.date = today();
  CLI::App& app = program.app();
  app.add_option("--robot", robot_name,
                 "name in the catalogue (abb_irb120, ur10, ur5, barrett_wam, puma560), or a JSON file")
      ->required()
      ->type_name("NAME|FILE");
  app.add_option("--data", data, "measured poses: q1_rad.., x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad")
      ->required()
      ->type_name("FILE");
  auto* test_option =
      app.add_option("--test", test, "measured poses to judge by")->type_name("FILE")->always_capture_default(false);
  auto* every_option = app.add_option("--test-every", settings.test_every, "hold out every K-th row of the data")
                           ->type_name("K")
                           ->check(CLI::Range(2, 1000000).description(""));
  auto* fraction_option = app.add_option("--test-fraction", fraction, "hold out this share of the rows, at random")
                              ->type_name("F")
                              ->check(CLI::Range(0.001, 0.999).description(""))
                              ->default_str("");
  test_option->excludes(every_option)->excludes(fraction_option);
  every_option->excludes(fraction_option);
  app.add_option("--save", save, "write the calibrated model to this file, for correct")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--loss", loss, "squared, or huber or cauchy where some measurements are wrong")
      ->type_name("LOSS")
      ->check(CLI::IsMember({"squared", "huber", "cauchy"}).description(""));
  app.add_option("--fix", settings.fixed, "parameters that stay nominal, by name (d1, theta6, tool_z, ...)")
      ->type_name("NAME...")
      ->default_str("");
  app.add_flag("--positions-only", settings.positions_only, "ignore measured orientations");
  app.add_option("--date", settings.date, "date kept in the model")->type_name("DATE");
  program.parse("calibrate_out");

  const vernier::RobotDescription robot = support::choose_robot(robot_name);
  settings.data = data;
  settings.test = test;
  settings.save = save;
  settings.loss =
      std::map<std::string, vernier::Loss>{
          {"squared", vernier::Loss::squared}, {"huber", vernier::Loss::huber}, {"cauchy", vernier::Loss::cauchy}}
          .at(loss);
  if (*fraction_option) settings.test_fraction = fraction;
  settings.seed = program.common().seed;
  settings.threads = program.common().threads;
  if (settings.date.size() > 40 ||
      std::any_of(settings.date.begin(), settings.date.end(), [](char c) { return c < ' '; }))
    throw support::UsageError("--date takes up to 40 plain characters");
  if (!save.empty()) support::require_writable(save);
  support::ProgressBar progress("PSO-ELM on what the geometry leaves", support::swarm_generations);
  settings.observer = progress;
  const CalibrationReport report = support::calibrate(robot, settings);
  progress.finish();

  fmt::print("{}: {} joints{}\n", robot.name, robot.dof(),
             robot.modified ? "; modified convention, parameters are those of the equal standard chain" : "");
  fmt::print("{} poses to learn from, {} held out: {}\n", report.train_rows, report.test_rows, report.split);
  print_table(report);
  fmt::print("\n{}", report.summary);
  for (const auto& remark : report.remarks) fmt::print("{}\n", remark);
  if (!program.common().json.empty()) support::write_json(program.common().json, to_json(robot, report));
  const std::filesystem::path folder = program.output_folder();
  draw(folder, robot.name, report);
  fmt::print("\nFigures: {}\n", folder.string());
  if (!save.empty()) fmt::print("Calibrated model: {}\n", save);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return support::run_program(
      "calibrate",
      "Measured poses in; base and tool frames, then the arm's geometry, then a PSO-ELM on what "
      "is left; errors of held-out poses after each.",
      argc, argv, run);
}
