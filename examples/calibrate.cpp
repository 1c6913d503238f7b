// Measured poses in; a calibrated model and its errors at held-out poses out.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <optional>

#include "calibration_figures.hpp"
#include "cli.hpp"
#include "contact_calibration.hpp"
#include "dispatch.hpp"
#include "json_file.hpp"
#include "progress.hpp"
#include "report_page.hpp"
#include "robot_choice.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/ceres.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/io.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/search/genetic_algorithm.hpp"

namespace {

namespace vn = vernier;
using Paths = std::vector<std::string>;

constexpr vn::Index prior_generations = 15;

struct Options {
  support::RobotOptions robot;
  std::string model, save, date, split, priors = "default", loss = "huber", free, prior, report, contacts;
  Paths data, test, distances;
  vn::Index test_every = 5, train_rows = 0;
  double test_fraction = 0.2, distance_sigma_mm = 0.03, contact_sigma_mm = 0.03, accept_mm = 0;
  bool positions_only = false, no_approach = false;
  vn::CalibrateOptions calibrate{};
};

/// Rows of a file to learn from and to hold out, the rule for it in words.
template <int N>
vn::Split<N> hold_out(const vn::Dataset<N>& data, const Options& o, std::uint64_t seed, std::string& rule) {
  using vn::Face;
  const bool far = seed % 2 == 1;
  rule = fmt::format("{:.3g} % of the rows, ", o.test_fraction * 100);
  const auto region = [&](Face face, const char* which) {
    rule += which;
    return vn::split_region(data, {.test_fraction = o.test_fraction, .face = face});
  };
  if (o.split == "region-x") return far ? region(Face::x_high, "largest x") : region(Face::x_low, "smallest x");
  if (o.split == "region-z") return far ? region(Face::z_high, "largest z") : region(Face::z_low, "smallest z");
  if (o.split == "time") {
    rule += "the last ones";
    return vn::split_time(data, o.test_fraction);
  }
  if (o.split == "random") {
    rule += fmt::format("at random, seed {}", seed);
    return vn::split(data, {.test_fraction = o.test_fraction, .seed = seed});
  }
  rule = fmt::format("every row i with i % {} = 0, counted from 0", o.test_every);
  return vn::split_every(data, o.test_every);
}

/// Training and held-out poses of station s.
template <int N>
vn::Split<N> read_station(const Options& o, std::size_t s, const auto& types, std::uint64_t seed, std::string& rule) {
  const auto read = [&](const std::string& file) {
    const vn::Dataset<N> data = vn::read_dataset<N>(file, types);
    return o.no_approach ? data.without_approach() : data;
  };
  vn::Split<N> out{read(o.data[s]), {}};
  if (!o.test.empty()) {
    rule += (s == 0 ? "the rows of " : ", ") + o.test[s];
    out.test = read(o.test[s]);
  } else {
    if (out.train.size() < 2)
      throw vn::CalibrationFailure(o.data[s] + ": a single row; a calibration needs many poses, and held-out ones");
    out = hold_out(vn::Dataset<N>(out.train), o, seed, rule);
  }
  const vn::Index n = out.train.size();
  if (o.train_rows > n)
    throw vn::CalibrationFailure(
        fmt::format("{}: --train asks for {} rows, there are {} to learn from", o.data[s], o.train_rows, n));
  if (o.train_rows > 0) out.train = vn::random_subset(out.train, o.train_rows, seed);
  return out;
}

vn::VectorX search_priors(const vn::PriorObjective& objective, const vn::Box& box, bool genetic,
                          const vn::FitOptions& fit) {
  const auto best = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, {}, fit.seed, fit.executor, fit.observer).best;
  };
  if (genetic) return best(vn::GeneticAlgorithm{.individuals = 20, .generations = prior_generations});
  return best(vn::Pso{.particles = 20, .iterations = prior_generations, .positions = vn::PositionRule::clamped});
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// An earlier calibration, of the same arm or of another of its type.
template <int N>
vn::ArmPrior read_prior(const std::string& file) {
  const vn::SavedArm saved = vn::saved_arm(file);
  if (saved.dof != N || saved.modified)
    throw support::UsageError(fmt::format("{}: is of an arm of {} joints, expected {}", file, saved.dof, N));
  const vn::CalibratedRobot<N> robot = vn::load<N>(file);
  if (robot.estimate() == nullptr)
    throw support::UsageError(file + ": has no covariance, an older program saved it; calibrate that arm again");
  vn::ArmPrior out = vn::arm_prior(robot);
  out.name = file_name(file);
  return out;
}

/// Looks for faults in the files of poses and prints them, before a calibration may refuse them.
template <int N>
std::vector<vn::DataAudit> audit_files(const vn::DescribedRobot<N>& robot, const Options& o) {
  std::vector<vn::DataAudit> out;
  for (const std::string& file : o.data) {
    const vn::Dataset<N> data = vn::read_dataset<N>(file, robot.arm.chain().joint_types());
    constexpr vn::Index fewest = 10;
    out.push_back(data.size() < fewest ? vn::DataAudit{} : vn::audit_data(robot.arm, data));
    if (!out.back().findings.empty()) fmt::print("{}: {}\n", file, out.back().summary());
  }
  return out;
}

/// What a page shows of a calibration: poses with their rows in the files, and which files were read.
template <int N>
vn::ReportInput page_of(const vn::CalibrationReport& report, const vn::DescribedRobot<N>& robot, const Options& o,
                        const std::vector<vn::Dataset<N>>& train, const std::vector<vn::Dataset<N>>& test,
                        const std::vector<vn::Distances<N>>& distances) {
  const auto types = robot.arm.chain().joint_types();
  vn::ReportInput held_out;
  std::vector<std::string> learned_from;
  for (std::size_t s = 0; s < o.data.size(); ++s) {
    const vn::Dataset<N> all = vn::read_dataset<N>(o.data[s], types);
    for (const vn::Index row : support::rows_of(all, train[s]))
      learned_from.push_back(fmt::format("{} of {}", row, file_name(o.data[s])));
    held_out.provenance.inputs.push_back(support::file_read(o.data[s], all.size()));
    if (!o.test.empty()) held_out.provenance.inputs.push_back(support::file_read(o.test[s], test[s].size()));
    support::add_poses(held_out, robot.arm, test[s], file_name(o.test.empty() ? o.data[s] : o.test[s]),
                       support::rows_of(o.test.empty() ? all : test[s], test[s]));
  }
  for (std::size_t d = 0; d < distances.size(); ++d)
    held_out.provenance.inputs.push_back(support::file_read(o.distances[d], distances[d].size()));
  for (const std::string& file : {o.contacts, o.prior})
    if (!file.empty()) held_out.provenance.inputs.push_back(support::file_read(file, 0));
  for (const std::string& file : o.robot.files()) held_out.provenance.inputs.push_back(support::file_read(file, 0));
  vn::ReportInput page = vn::report_input(report, robot.name, learned_from);
  held_out.poses.normalised = page.poses.normalised;
  held_out.poses.gates = page.poses.gates;
  page.poses = std::move(held_out.poses);
  page.times = std::move(held_out.times);
  page.provenance = std::move(held_out.provenance);
  if (o.accept_mm > 0) page.accept = o.accept_mm * 1e-3;
  return page;
}

template <int N>
vn::CalibrationReport calibrate_arm(const vn::RobotDescription& description, const Options& o,
                                    const vn::FitOptions& fit, std::string& rule, vn::ReportInput& page,
                                    std::vector<vn::DataAudit>& audits) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  std::optional<vn::ArmPrior> prior;
  if (!o.prior.empty()) prior = read_prior<N>(o.prior);
  audits = audit_files(robot, o);
  const auto types = robot.arm.chain().joint_types();
  std::vector<vn::Dataset<N>> train, test;
  std::string names;
  for (std::size_t s = 0; s < o.data.size(); ++s) {
    vn::Split<N> station = read_station<N>(o, s, types, fit.seed, rule);
    train.push_back(std::move(station.train));
    test.push_back(std::move(station.test));
    names += (s > 0 ? "," : "") + file_name(o.data[s]);
  }
  std::vector<vn::Distances<N>> distances;
  for (const std::string& file : o.distances) distances.push_back(vn::read_distances<N>(file, types));
  std::vector<vn::Contact> contacts;
  if (!o.contacts.empty()) contacts = vn::read_contacts(o.contacts, N, types);
  vn::CalibrateOptions options = o.calibrate;
  options.errors.drives = robot.drives;
  if (prior) options.errors.prior = &*prior;
  const auto search = [&](const vn::PriorObjective& objective, const vn::Box& box) {
    return search_priors(objective, box, o.priors == "ga", fit);
  };
  const auto calibration = vn::calibrate(robot.arm, train, distances, options, fit,
                                         o.priors == "default" ? vn::PriorSearch() : vn::PriorSearch(search), contacts);
  const vn::CalibrationReport report = vn::evaluate(calibration, test, robot.limits);
  if (!o.save.empty())
    vn::save(o.save, calibration,
             {.name = robot.name,
              .limits = robot.limits,
              .data_file = names,
              .date = o.date,
              .held_out_error = report.stage(report.chosen).position.mean()});
  if (!o.report.empty()) {
    page = page_of<N>(report, robot, o, train, test, distances);
    page.audit = support::audit_rows(o.data, audits);
  }
  return report;
}

int run_calibration(support::Program& program, Options& o) {
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.calibrate.arm_name = robot.name;
  o.calibrate.station_names = o.data;
  o.calibrate.distance_names = o.distances;
  o.calibrate.remainder.on_geometry = true;
  const int swarms = 2 * (o.calibrate.remainder.iterations + 1);
  support::ProgressBar progress("searching", swarms + (o.priors == "default" ? 0 : prior_generations + 1));
  vn::Index generations = 0;
  const auto count = [&](const vn::Progress&) { progress.update(++generations); };
  const vn::ThreadExecutor executor(program.common().threads);
  const vn::FitOptions fit{.seed = program.common().seed, .executor = executor, .observer = count};
  std::string rule;
  vn::ReportInput page;
  std::vector<vn::DataAudit> audits;
  const vn::CalibrationReport report =
      support::dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(robot, o, fit, rule, page, audits); });
  progress.finish();

  fmt::print("{}: {} joints{}\n", robot.name, robot.dof(),
             robot.modified ? "; modified convention, parameters are those of the equal standard chain" : "");
  if (o.data.size() > 1) fmt::print("{} stations: one arm, {} base frames\n", o.data.size(), o.data.size());
  fmt::print("{} poses to learn from, {} held out: {}\n", report.train_poses, report.test_poses(), rule);
  if (report.distances > 0) fmt::print("{} distances to learn from\n", report.distances);
  if (!o.contacts.empty())
    fmt::print("contacts to learn from, touched by the tool point of the poses: {}\n", o.contacts);
  fmt::print("\n{}", report.summary());
  support::Json json = vn::to_json(report, robot.name);
  for (const vn::DataAudit& audit : audits) json["audit"].push_back(vn::to_json(audit));
  if (!program.common().json.empty()) support::write_json(program.common().json, json);
  const std::filesystem::path folder = program.output_folder();
  support::draw_calibration(folder, robot.name, report);
  fmt::print(
      "\nFrom poses to error model in {:.1f} s; a pose of the chosen stage with its Jacobian takes {:.2g} us. "
      "Figures: {}\n",
      report.fit_seconds, report.evaluation_seconds * 1e6, folder.string());
  if (!o.save.empty()) fmt::print("Calibrated model: {}\n", o.save);
  if (!o.report.empty()) {
    page.rule = rule;
    page.results = json.dump(-1, ' ', false, support::Json::error_handler_t::replace);
    support::write_report(program, o.report, page, o.date, o.save);
    fmt::print("Report: {}\n", o.report);
  }
  return 0;
}

template <int N>
int reregister_arm(support::Program& program, const Options& o, const vn::ReregisterOptions& free) {
  const vn::CalibratedRobot<N> robot = vn::load<N>(o.model);
  const auto types = robot.nominal().chain().joint_types();
  const auto read = [&](const std::string& file) {
    const vn::Dataset<N> data = vn::read_dataset<N>(file, types);
    return o.no_approach ? data.without_approach() : data;
  };
  const vn::Dataset<N> data = read(o.data.front()), test = o.test.empty() ? data : read(o.test.front());
  const auto found = vn::reregister(robot.model(), data, free, o.calibrate.sensors);
  if (!found.determined)
    throw vn::CalibrationFailure(
        fmt::format("{}: {} poses do not determine what may move; measure more, with the joints "
                    "moved widely, or free less",
                    o.data.front(), data.size()));
  if (!found.converged || found.rms_after > 0.02)
    throw vn::CalibrationFailure(
        fmt::format("{}: the model of {} misses by {:.1f} mm (rms) in any base frame: wrong "
                    "robot, units or columns?",
                    o.data.front(), robot.name(), found.rms_after * 1e3));
  vn::Provenance from = robot.provenance();
  from.data_file += "," + file_name(o.data.front());
  from.date = o.date;
  const vn::CalibratedRobot<N> moved = robot.with_model(found.model, from);
  const bool oriented = test.has_orientations() && o.calibrate.sensors.use_orientations;
  vn::Isometry3 probe = vn::Isometry3::Identity();
  probe.linear() = vn::exp_so3(found.motion.probe);
  const auto stage = [&](const char* key, const char* title, const auto& model, const auto& as_seen) {
    return vn::StageErrors{key, title, vn::position_errors(model, test),
                           oriented ? vn::rotation_errors(as_seen, test) : vn::VectorX()};
  };
  const std::vector stages{stage("as_fitted", "as fitted", robot, robot),
                           stage("reregistered", "re-registered", moved,
                                 found.model.moved(vn::Isometry3::Identity(), vn::JointVector<N>::Zero(), probe))};
  fmt::print("{}: {} registered again from {} poses, everything else kept\n\nErrors of {} [mm]\n\n{}\n{}", robot.name(),
             o.free, data.size(),
             o.test.empty() ? "those same poses (--test FILE names held-out ones)"
                            : fmt::format("{} held-out poses", test.size()),
             vn::stage_table(stages), found.summary());
  if (!program.common().json.empty()) {
    support::Json json{{"robot", robot.name()},
                       {"train_rows", data.size()},
                       {"test_rows", test.size()},
                       {"held_out", !o.test.empty()},
                       {"stages", vn::stages_to_json(stages)}};
    json.update(vn::to_json(found));
    support::write_json(program.common().json, json);
  }
  if (!o.save.empty()) {
    vn::save(o.save, moved);
    fmt::print("Calibrated model: {}\n", o.save);
  }
  return 0;
}

int run_reregistration(support::Program& program, const Options& o) {
  vn::ReregisterOptions free{.base = false};
  for (std::size_t at = 0; at <= o.free.size();) {
    const std::size_t comma = std::min(o.free.find(',', at), o.free.size());
    const std::string part = o.free.substr(at, comma - at);
    at = comma + 1;
    if (part == "base") {
      free.base = true;
    } else if (part == "offsets") {
      free.offsets = true;
    } else if (part == "tool" || part == "another-tool") {
      free.tool = true;
      if (part == "another-tool")
        free.tool_position_prior_std = free.tool_rotation_prior_std = std::numeric_limits<double>::infinity();
    } else {
      throw support::UsageError("--free takes base, tool, another-tool, offsets, joined by commas; not '" +
                                vn::detail::quotable(part) + "'");
    }
  }
  return support::dispatch_dof(vn::saved_arm(o.model).dof,
                               [&](auto n) { return reregister_arm<n()>(program, o, free); });
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
}

int run(support::Program& program) {
  const std::map<std::string, vn::Loss> losses{
      {"squared", vn::Loss::squared}, {"huber", vn::Loss::huber}, {"cauchy", vn::Loss::cauchy}};
  Options o;
  o.date = today();
  CLI::App& app = program.app();
  const auto option = [&](const char* name, auto& value, const char* help, const char* type) {
    return app.add_option(name, value, help)->type_name(type)->always_capture_default(false);
  };
  auto* robot = o.robot.add_to(app);
  option("--data", o.data,
         "measured poses: q1_rad.., x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad, time_s, segment (a new "
         "number: the "
         "approach is unknown) or from_q1_rad.. (where each pose was approached from); one file a sensor station",
         "FILE...");
  auto* contacts =
      option("--contacts", o.contacts,
             "what the tool point touched, beside the poses or, without --data, in their place: contact_id, "
             "kind (plane, ball, socket), q1_rad.., radius_mm (of balls), offset_mm (known distance from "
             "the first face or socket of the same contact)",
             "FILE");
  app.add_option("--contact-sigma", o.contact_sigma_mm, "standard deviation of a touch [mm]")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""))
      ->always_capture_default(false)
      ->needs(contacts);
  auto* distances = option("--distances", o.distances,
                           "measured distances from a fixed point (draw-wire, ball-bar), used beside the poses: "
                           "q1_rad.., distance_mm; one file a fixed point",
                           "FILE...");
  app.add_option("--distance-sigma", o.distance_sigma_mm,
                 "standard deviation of a distance [mm]; of positions it is 0.03 mm")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""));
  auto* test = option("--test", o.test, "held-out measured poses, as many files as --data", "FILE...");
  auto* every = app.add_option("--test-every", o.test_every, "hold out every K-th row of the data")
                    ->type_name("K")
                    ->check(CLI::Range(2, 1000000).description(""));
  auto* split = option("--split", o.split,
                       "hold out a fraction of the rows: random, region-x or region-z (largest values for odd seeds, "
                       "smallest for even), time (the last rows)",
                       "HOW")
                    ->check(CLI::IsMember({"random", "region-x", "region-z", "time"}).description(""));
  auto* fraction =
      app.add_option("--test-fraction", o.test_fraction, "that fraction; random where --split is not given")
          ->type_name("F")
          ->check(CLI::Range(0.001, 0.999).description(""));
  test->excludes(every)->excludes(fraction)->excludes(split);
  every->excludes(fraction)->excludes(split);
  auto* train = option("--train", o.train_rows, "learn from the first N rows of a seeded shuffle of the others", "N")
                    ->check(CLI::Range(1, 100000000).description(""));
  option("--save", o.save, "write the calibrated model to this file, for correct", "FILE");
  auto* report = option("--report", o.report, "write the results as one HTML page that needs nothing else", "FILE");
  app.add_option("--accept-mm", o.accept_mm, "with --report: the largest mean held-out error that is accepted [mm]")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""))
      ->always_capture_default(false)
      ->needs(report);
  app.add_option("--loss", o.loss, "squared, or huber or cauchy, which tolerate outliers")
      ->type_name("LOSS")
      ->check(CLI::IsMember({"squared", "huber", "cauchy"}).description(""));
  option("--fix", o.calibrate.geometry.fixed, "parameters that stay nominal, by name (d1, theta6, tool_z, ...)",
         "NAME...");
  app.add_flag("--no-approach", o.no_approach,
               "rows are not in the order of measuring: no hysteresis by the direction of approach");
  app.add_option("--harmonics", o.calibrate.errors.harmonics,
                 "highest order of the joint-wise harmonics, at most 60 below 400 measurements; 0: none")
      ->type_name("K")
      ->check(CLI::Range(0, 500).description(""));
  app.add_option("--priors", o.priors,
                 "sizes of the joint errors: by default those of most evidence, or optimised by pso or ga on left-out "
                 "poses (takes "
                 "a minute)")
      ->type_name("HOW")
      ->check(CLI::IsMember({"default", "pso", "ga"}).description(""));
  app.add_flag("--own-tools", o.calibrate.errors.tool_per_station,
               "every file of --data has its own tool, not only its own base");
  app.add_flag("--positions-only", o.positions_only, "ignore measured orientations");
  app.add_option("--date", o.date, "date written into the model")->type_name("DATE");
  auto* prior = option("--prior", o.prior,
                       "a calibrated model to start from: of this arm, earlier, or of another of its type; used as far "
                       "as left-out poses support it",
                       "FILE");
  auto* model =
      option("--model", o.model, "a calibrated model: registered again from the data, the rest is kept", "FILE");
  auto* free =
      option("--free", o.free,
             "with --model: what may move: base, tool (remounted: by millimetres), another-tool (by any amount), "
             "offsets, joined by commas",
             "WHAT");
  model->excludes(distances)
      ->excludes(contacts)
      ->excludes(robot)
      ->excludes(every)
      ->excludes(split)
      ->excludes(train)
      ->excludes(prior)
      ->excludes(report)
      ->needs(free);
  free->needs(model);
  program.parse("calibrate_out");

  if (o.date.size() > 40 || std::any_of(o.date.begin(), o.date.end(), [](char c) { return c < ' '; }))
    throw support::UsageError("--date takes up to 40 plain characters");
  if (!o.test.empty() && o.test.size() != o.data.size())
    throw support::UsageError(fmt::format("{} files of --test for {} of --data", o.test.size(), o.data.size()));
  if (!o.save.empty()) support::require_writable(o.save);
  if (!o.report.empty()) support::require_writable(o.report);
  if (*fraction && o.split.empty()) o.split = "random";
  vn::SensorModel& sensors = o.calibrate.sensors;
  sensors.loss = losses.at(o.loss);
  sensors.distance_sigma = o.distance_sigma_mm * 1e-3;
  sensors.contact_sigma = o.contact_sigma_mm * 1e-3;
  sensors.use_orientations = !o.positions_only;
  o.calibrate.errors.hysteresis = !o.no_approach;
  if (o.data.empty() && (*model || o.contacts.empty()))
    throw support::UsageError("--data is required (or --contacts, to calibrate without measured poses)");
  if (*model) {
    if (o.data.size() != 1) throw support::UsageError("--model takes one file of --data");
    return run_reregistration(program, o);
  }
  if (!*robot) throw support::UsageError("--robot is required (or --model, to register a fitted arm again)");
  if (o.data.empty()) {
    for (const CLI::Option* needs_poses : {distances, test, every, split, fraction, train, report, prior})
      if (*needs_poses) throw support::UsageError(needs_poses->get_name() + " needs --data");
    return support::calibrate_by_contacts(program, support::choose_robot(o.robot), o.contacts, o.calibrate.geometry,
                                          sensors, o.save, o.date);
  }
  return run_calibration(program, o);
}

}  // namespace

int main(int argc, char** argv) {
  return support::run_program(
      "calibrate",
      "Measured poses in; base and tool frames, the arm's geometry, gravity compliance, "
      "functions of single joints, hysteresis by the direction of approach, drift of the "
      "session and what learners find in the remainder; errors at held-out poses after each, and a "
      "verdict.",
      argc, argv, run);
}
