// Measured poses in; a calibrated model and an honest held-out report out.

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <numbers>

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

void print_table(const std::vector<StageErrors>& stages) {
  fmt::print("{:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{}\n", "stage", "mean", "rms", "max", "min", "p95",
             stages.front().rotation.size() > 0 ? "  mean [mrad]" : "");
  for (const StageErrors& stage : stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    fmt::print("{:<22}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}", stage.title, e.mean, e.rms, e.max, e.min, e.p95);
    if (stage.rotation.size() > 0) fmt::print("{:>13.4f}", stage.rotation.mean() * 1e3);
    fmt::print("\n");
  }
}

support::Json stages_json(const std::vector<StageErrors>& of) {
  support::Json stages;
  for (const StageErrors& stage : of) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    stages[stage.key] = {
        {"mean_mm", e.mean}, {"rms_mm", e.rms}, {"max_mm", e.max}, {"min_mm", e.min}, {"p95_mm", e.p95}};
    if (stage.rotation.size() > 0) stages[stage.key]["mean_mrad"] = stage.rotation.mean() * 1e3;
  }
  return stages;
}

support::Json to_json(const vernier::RobotDescription& robot, const CalibrationReport& report) {
  support::Json parameters = support::Json::array(), blocks = support::Json::array();
  for (const auto& b : report.blocks)
    blocks.push_back({{"name", b.name},
                      {"used", b.used},
                      {"left_out_without_mm", b.without * 1e3},
                      {"left_out_with_mm", b.with * 1e3},
                      {"tightness", b.used ? support::Json(b.tightness) : support::Json()}});
  for (const auto& p : report.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.kind == vernier::ParameterKind::length ? "mm" : "mrad"},
                          {"nominal", p.nominal * 1e3},
                          {"identified", p.identified * 1e3},
                          {"std", p.std * 1e3}});
  return {{"robot", robot.name},
          {"train_rows", report.train_rows},
          {"test_rows", report.test_rows},
          {"stages", stages_json(report.stages)},
          {"blocks", blocks},
          {"parameters", parameters},
          {"identifiability",
           {{"rank", report.rank},
            {"free", report.free},
            {"condition", report.condition},
            {"weak", report.weak},
            {"strongly_correlated", report.correlated},
            {"observability",
             {{"O1", report.observability.o1},
              {"O2", report.observability.o2},
              {"O3", report.observability.o3},
              {"O4", report.observability.o4},
              {"O5", report.observability.o5}}}}},
          {"gated_rows", report.gated},
          {"worst_harm_beside_geometry_mm", report.worst_harm * 1e3},
          {"within_95_percent_ellipsoids", report.within_ellipsoids},
          {"verdict", report.verdict}};
}

void draw(const std::filesystem::path& folder, const std::string& robot, const CalibrationReport& report) {
  std::vector<std::string> titles;
  support::Series mean{"mean", {}, {}, support::Style::lines, 1}, p95{"95 %", {}, {}, support::Style::lines, 2};
  std::vector<support::Sample> samples;
  std::vector<support::Series> poses;
  for (const StageErrors& stage : report.stages) {
    const vernier::VectorX mm = stage.position * 1e3;
    const auto e = ErrorStatistics::of(mm);
    const std::size_t plus = stage.title.find(" + ");  // short, for it stands beside the stage it builds on
    titles.push_back(plus == std::string::npos ? stage.title : stage.title.substr(plus + 1));
    mean.y.push_back(e.mean);
    p95.y.push_back(e.p95);
    samples.push_back({stage.title, {mm.begin(), mm.end()}});
    if (stage.key != "frames" && stage.key != "geometry" && stage.key != "jointwise") continue;
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

/// Errors along each joint before and after, what each transmission adds, and the measured ranges.
void draw_joints(const std::filesystem::path& folder, const std::string& robot, const CalibrationReport& report) {
  using support::Series;
  using support::Style;
  constexpr double degree = 180 / std::numbers::pi;
  const auto scaled = [](std::vector<double> values, double by) {
    for (double& v : values) v *= by;
    return values;
  };
  std::vector<Series> ranges;
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const support::JointPicture& joint = report.joints[j];
    const std::string name = fmt::format("joint {}", j + 1), x_label = name + " [deg]";
    const std::vector<double> angle = scaled(joint.angle, degree), at = scaled(joint.at, degree);
    support::plot_svg(folder / fmt::format("errors_along_joint_{}.svg", j + 1),
                      fmt::format("{}: held-out errors along {}", robot, name), x_label, "position error [mm]",
                      {{"geometry", angle, scaled(joint.before, 1e3), Style::points},
                       {"joint-wise", angle, scaled(joint.after, 1e3), Style::points}});
    if (std::any_of(joint.std.begin(), joint.std.end(), [](double s) { return s > 0; })) {
      Series upper{"95 % band", at, {}, Style::dashed, 1}, lower{"", at, {}, Style::dashed, 1};
      for (std::size_t k = 0; k < at.size(); ++k) {
        upper.y.push_back((joint.value[k] + 1.96 * joint.std[k]) * 1e3);
        lower.y.push_back((joint.value[k] - 1.96 * joint.std[k]) * 1e3);
      }
      support::plot_svg(folder / fmt::format("transmission_{}.svg", j + 1),
                        fmt::format("{}: what {} adds to its angle, mean taken off", robot, name), x_label,
                        "joint error [mrad]",
                        {{"joint error", at, scaled(joint.value, 1e3), Style::lines, 2}, upper, lower});
    }
    for (std::size_t k = 0; k < joint.measured_ranges.size(); ++k)
      ranges.push_back({k == 0 ? name : "",
                        {joint.measured_ranges[k].first * degree, joint.measured_ranges[k].second * degree},
                        {static_cast<double>(j + 1), static_cast<double>(j + 1)},
                        Style::lines,
                        static_cast<int>(j) % support::palette_size});
  }
  const double count = static_cast<double>(report.joints.size());
  support::plot_svg(folder / "joint_ranges.svg", robot + ": measured joint ranges", "joint value [deg]", "joint",
                    ranges, {.y_range = std::pair{0.0, count + 1}});
}

int run_reregistration(support::Program& program, support::ReregistrationSettings settings, const std::string& free) {
  settings.options.base = settings.options.tool = settings.options.offsets = false;
  for (std::size_t at = 0; at <= free.size();) {
    const std::size_t comma = std::min(free.find(',', at), free.size());
    const std::string part = free.substr(at, comma - at);
    at = comma + 1;
    if (part == "base")
      settings.options.base = true;
    else if (part == "tool")
      settings.options.tool = true;
    else if (part == "offsets")
      settings.options.offsets = true;
    else
      throw support::UsageError("--free takes base, tool, offsets, joined by commas; not '" +
                                vernier::detail::quotable(part) + "'");
  }
  const support::ReregistrationReport report = support::reregister(settings);
  fmt::print("{}: {} registered again from {} poses, everything else kept\n", report.robot, free, report.train_rows);
  fmt::print("\nErrors of {} [mm]\n\n", report.held_out ? fmt::format("{} held-out poses", report.test_rows)
                                                        : "those same poses (--test FILE judges by others)");
  print_table(report.stages);
  const auto change = [](const char* what, const std::array<double, 6>& by) {
    fmt::print("{} moved by ({:.3f}, {:.3f}, {:.3f}) mm, turned by ({:.3f}, {:.3f}, {:.3f}) mrad\n", what, by[0] * 1e3,
               by[1] * 1e3, by[2] * 1e3, by[3] * 1e3, by[4] * 1e3, by[5] * 1e3);
  };
  fmt::print("\n");
  if (settings.options.base) change("Base", report.base_change);
  if (settings.options.tool) change("Tool", report.tool_change);
  if (settings.options.offsets)
    for (std::size_t i = 0; i < report.offsets.size(); ++i)
      fmt::print("Zero of joint {}: {:+.4f} mrad (mm)\n", i + 1, report.offsets[i] * 1e3);
  if (!program.common().json.empty())
    support::write_json(program.common().json, {{"robot", report.robot},
                                                {"train_rows", report.train_rows},
                                                {"test_rows", report.test_rows},
                                                {"held_out", report.held_out},
                                                {"stages", stages_json(report.stages)},
                                                {"base_change_m_rad", report.base_change},
                                                {"tool_change_m_rad", report.tool_change},
                                                {"offsets_rad", report.offsets}});
  if (!settings.save.empty()) fmt::print("Calibrated model: {}\n", settings.save.string());
  return 0;
}

int run(support::Program& program) {
  support::CalibrationSettings settings;
  std::string robot_name, model, free, loss = "huber", split, priors = "default";
  double distance_sigma_mm = 0.03;
  std::vector<std::string> data, test, distances;
  std::string save;
  settings.date = today();
  CLI::App& app = program.app();
  auto* robot_option =
      app.add_option("--robot", robot_name,
                     "name in the catalogue (abb_irb120, ur10, ur5, barrett_wam, puma560), or a JSON file")
          ->type_name("NAME|FILE");
  app.add_option(
         "--data", data,
         "measured poses: q1_rad.., x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad; one file for each place "
         "of the sensor")
      ->required()
      ->type_name("FILE...");
  auto* distances_option =
      app.add_option("--distances", distances,
                     "measured distances from a fixed point (draw-wire, ball-bar), to learn from beside the poses: "
                     "q1_rad.., distance_mm; one file for each fixed point")
          ->type_name("FILE...")
          ->always_capture_default(false);
  app.add_option("--distance-sigma", distance_sigma_mm, "standard deviation of a distance [mm]; of poses it is 0.03 mm")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""));
  auto* test_option = app.add_option("--test", test, "measured poses to judge by, as many files as --data")
                          ->type_name("FILE...")
                          ->always_capture_default(false);
  auto* every_option = app.add_option("--test-every", settings.test_every, "hold out every K-th row of the data")
                           ->type_name("K")
                           ->check(CLI::Range(2, 1000000).description(""));
  auto* split_option = app.add_option("--split", split,
                                      "hold out a share of the rows: random, region-x or region-z (the far end for odd "
                                      "seeds, the near one for even), time (the last rows)")
                           ->type_name("HOW")
                           ->check(CLI::IsMember({"random", "region-x", "region-z", "time"}).description(""))
                           ->default_str("");
  auto* fraction_option =
      app.add_option("--test-fraction", settings.test_fraction, "that share; at random where --split is not given")
          ->type_name("F")
          ->check(CLI::Range(0.001, 0.999).description(""));
  test_option->excludes(every_option)->excludes(fraction_option)->excludes(split_option);
  every_option->excludes(fraction_option)->excludes(split_option);
  auto* train_option =
      app.add_option("--train", settings.train_rows, "learn from the first N rows of a seeded shuffle of the others")
          ->type_name("N")
          ->check(CLI::Range(1, 100000000).description(""))
          ->default_str("");
  app.add_option("--save", save, "write the calibrated model to this file, for correct")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--loss", loss, "squared, or huber or cauchy, which survive some wrong measurements")
      ->type_name("LOSS")
      ->check(CLI::IsMember({"squared", "huber", "cauchy"}).description(""));
  app.add_option("--fix", settings.fixed, "parameters that stay nominal, by name (d1, theta6, tool_z, ...)")
      ->type_name("NAME...")
      ->default_str("");
  app.add_option("--harmonics", settings.harmonics, "joint-wise Fourier terms up to this harmonic; 0 for none")
      ->type_name("K")
      ->check(CLI::Range(0, 500).description(""));
  app.add_option("--joint-nodes", settings.joint_nodes,
                 "joint-wise hidden nodes, so many a joint, in place of Fourier terms")
      ->type_name("H")
      ->check(CLI::Range(1, 1000).description(""))
      ->default_str("");
  app.add_option("--priors", priors,
                 "of the joint errors: the default rule, or tuned by pso or ga on poses left out (takes a minute)")
      ->type_name("HOW")
      ->check(CLI::IsMember({"default", "pso", "ga"}).description(""));
  app.add_flag("--own-tools", settings.own_tools, "every file of --data has its own tool, not just its own base");
  app.add_flag("--positions-only", settings.positions_only, "ignore measured orientations");
  app.add_option("--date", settings.date, "date kept in the model")->type_name("DATE");
  auto* model_option =
      app.add_option("--model", model, "a calibrated model: registered again from the data, the rest is kept")
          ->type_name("FILE")
          ->always_capture_default(false);
  auto* free_option = app.add_option("--free", free, "with --model: what may move, base, tool and offsets, by commas")
                          ->type_name("WHAT")
                          ->always_capture_default(false);
  model_option->excludes(distances_option)
      ->excludes(robot_option)
      ->excludes(every_option)
      ->excludes(split_option)
      ->excludes(train_option);
  model_option->needs(free_option);
  free_option->needs(model_option);
  program.parse("calibrate_out");

  if (settings.date.size() > 40 ||
      std::any_of(settings.date.begin(), settings.date.end(), [](char c) { return c < ' '; }))
    throw support::UsageError("--date takes up to 40 plain characters");
  if (!test.empty() && test.size() != data.size())
    throw support::UsageError(fmt::format("{} files of --test for {} of --data", test.size(), data.size()));
  if (!save.empty()) support::require_writable(save);
  if (*model_option) {
    if (data.size() != 1) throw support::UsageError("--model takes one file of --data");
    support::ReregistrationSettings again;
    again.model = model;
    again.data = data.front();
    if (!test.empty()) again.test = test.front();
    again.positions_only = settings.positions_only;
    again.save = save;
    again.date = settings.date;
    return run_reregistration(program, again, free);
  }
  if (!*robot_option) throw support::UsageError("--robot is required (or --model, to register a fitted arm again)");

  const vernier::RobotDescription robot = support::choose_robot(robot_name);
  settings.data = {data.begin(), data.end()};
  settings.test = {test.begin(), test.end()};
  settings.distances = {distances.begin(), distances.end()};
  settings.distance_sigma = distance_sigma_mm * 1e-3;
  settings.priors = priors == "pso"  ? support::PriorTuning::pso
                    : priors == "ga" ? support::PriorTuning::ga
                                     : support::PriorTuning::none;
  settings.save = save;
  settings.loss =
      std::map<std::string, vernier::Loss>{
          {"squared", vernier::Loss::squared}, {"huber", vernier::Loss::huber}, {"cauchy", vernier::Loss::cauchy}}
          .at(loss);
  using support::HoldOut;
  if (*split_option)
    settings.hold_out = std::map<std::string, HoldOut>{
        {"random", HoldOut::random},
        {"region-x", HoldOut::region_x},
        {"region-z", HoldOut::region_z},
        {"time",
         HoldOut::time}}.at(split);
  else if (*fraction_option)
    settings.hold_out = HoldOut::random;
  settings.seed = program.common().seed;
  settings.threads = program.common().threads;
  // one bar for all searches, one after the other
  const bool tuned = settings.priors != support::PriorTuning::none;
  support::ProgressBar progress("searching",
                                2 * (support::swarm_generations + 1) + (tuned ? support::prior_generations + 1 : 0));
  vernier::Index searched = 0;
  const auto count = [&](const vernier::Progress&) { progress.update(++searched); };
  settings.observer = count;
  const CalibrationReport report = support::calibrate(robot, settings);
  progress.finish();

  fmt::print("{}: {} joints{}\n", robot.name, robot.dof(),
             robot.modified ? "; modified convention, parameters are those of the equal standard chain" : "");
  if (data.size() > 1) fmt::print("{} stations: one arm, {} base frames\n", data.size(), data.size());
  fmt::print("{} poses to learn from, {} held out: {}\n", report.train_rows, report.test_rows, report.split);
  if (report.distances > 0) fmt::print("{} distances to learn from\n", report.distances);
  fmt::print("\nErrors of the {} held-out poses [mm]\n\n", report.test_rows);
  print_table(report.stages);
  fmt::print("\n{}", report.summary);
  for (const auto& remark : report.remarks) fmt::print("{}\n", remark);
  fmt::print("\nVerdict\n");
  for (const auto& line : report.verdict) fmt::print("- {}\n", line);
  if (!program.common().json.empty()) support::write_json(program.common().json, to_json(robot, report));
  const std::filesystem::path folder = program.output_folder();
  draw(folder, robot.name, report);
  draw_joints(folder, robot.name, report);
  fmt::print("\nFrom poses to error model in {:.1f} s. Figures: {}\n", report.fit_seconds, folder.string());
  if (!save.empty()) fmt::print("Calibrated model: {}\n", save);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return support::run_program("calibrate",
                              "Measured poses in; base and tool frames, the arm's geometry, gravity compliance, "
                              "functions of single joints and a "
                              "PSO-ELM on what is left; errors of held-out poses after each, and a verdict.",
                              argc, argv, run);
}
