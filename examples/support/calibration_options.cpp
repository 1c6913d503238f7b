#include "calibration_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace support {

namespace {

namespace vn = vernier;

/// Values whose units or words differ from those of the options that they are turned into.
struct TypedValues {
  std::string loss = "huber";
  double distance_sigma_mm = 0.03, contact_sigma_mm = 0.03;
  bool positions_only = false;
};

/// An option whose default is not shown in the help.
CLI::Option* option(CLI::App& app, const char* name, auto& value, const char* help, const char* type) {
  return app.add_option(name, value, help)->type_name(type)->always_capture_default(false);
}

void add_measurements(CLI::App& app, CalibrationOptions& o, TypedValues& typed) {
  option(app, "--data", o.data,
         "measured poses: q1_rad.., x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad, time_s, segment (a new "
         "number: the approach is unknown) or from_q1_rad.. (where each pose was approached from); one file a sensor "
         "station",
         "FILE...");
  auto* contacts =
      option(app, "--contacts", o.contacts,
             "what the tool point touched, beside the poses or, without --data, in their place: contact_id, "
             "kind (plane, ball, socket), q1_rad.., radius_mm (of balls), offset_mm (known distance from "
             "the first face or socket of the same contact)",
             "FILE");
  app.add_option("--contact-sigma", typed.contact_sigma_mm, "standard deviation of a touch [mm]")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""))
      ->always_capture_default(false)
      ->needs(contacts);
  option(app, "--distances", o.distances,
         "measured distances from a fixed point (draw-wire, ball-bar), used beside the poses: "
         "q1_rad.., distance_mm; one file a fixed point",
         "FILE...");
  app.add_option("--distance-sigma", typed.distance_sigma_mm,
                 "standard deviation of a distance [mm]; of positions it is 0.03 mm")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""));
}

void add_split(CLI::App& app, CalibrationOptions& o) {
  auto* test = option(app, "--test", o.test, "held-out measured poses, as many files as --data", "FILE...");
  auto* every = app.add_option("--test-every", o.test_every, "hold out every K-th row of the data")
                    ->type_name("K")
                    ->check(CLI::Range(2, 1000000).description(""));
  auto* split =
      option(app, "--split", o.split,
             "hold out a fraction of the rows: random, region-x or region-z (largest values for odd seeds, "
             "smallest for even), time (the last rows), block (the first of 1/F contiguous blocks for seed 1, and "
             "so on)",
             "HOW")
          ->check(CLI::IsMember({"random", "region-x", "region-z", "time", "block"}).description(""));
  auto* fraction =
      app.add_option("--test-fraction", o.test_fraction, "that fraction; random where --split is not given")
          ->type_name("F")
          ->check(CLI::Range(0.001, 0.999).description(""));
  test->excludes(every)->excludes(fraction)->excludes(split);
  every->excludes(fraction)->excludes(split);
  option(app, "--train", o.train_rows, "learn from the first N rows of a seeded shuffle of the others", "N")
      ->check(CLI::Range(1, 100000000).description(""));
}

void add_results(CLI::App& app, CalibrationOptions& o) {
  option(app, "--save", o.save, "write the calibrated model to this file, for correct", "FILE");
  auto* report =
      option(app, "--report", o.report, "write the results as one HTML page that needs nothing else", "FILE");
  app.add_option("--accept-mm", o.accept_mm, "with --report: the largest mean held-out error that is accepted [mm]")
      ->type_name("MM")
      ->check(CLI::Range(1e-6, 1e3).description(""))
      ->always_capture_default(false)
      ->needs(report);
}

void add_estimation(CLI::App& app, CalibrationOptions& o, TypedValues& typed) {
  app.add_option("--loss", typed.loss, "squared, or huber or cauchy, which tolerate outliers")
      ->type_name("LOSS")
      ->check(CLI::IsMember({"squared", "huber", "cauchy"}).description(""));
  option(app, "--fix", o.calibrate.geometry.fixed, "parameters that stay nominal, by name (d1, theta6, tool_z, ...)",
         "NAME...");
  app.add_flag("--no-approach", o.no_approach,
               "rows are not in the order of measuring: no hysteresis by the direction of approach");
  app.add_option("--harmonics", o.calibrate.errors.harmonics,
                 "highest order of the joint-wise harmonics, at most 60 below 400 measurements; 0: none")
      ->type_name("K")
      ->check(CLI::Range(0, 500).description(""));
  app.add_option("--priors", o.priors,
                 "sizes of the joint errors: by default those of most evidence, or optimised by pso or ga on left-out "
                 "poses (takes a minute)")
      ->type_name("HOW")
      ->check(CLI::IsMember({"default", "pso", "ga"}).description(""));
  app.add_flag("--own-tools", o.calibrate.errors.tool_per_station,
               "every file of --data has its own tool, not only its own base");
  app.add_flag("--positions-only", typed.positions_only, "ignore measured orientations");
  app.add_option("--date", o.date, "date written into the model")->type_name("DATE");
  option(app, "--prior", o.prior,
         "a calibrated model to start from: of this arm, earlier, or of another of its type; used as far "
         "as left-out poses support it",
         "FILE");
}

void add_reregistration(CLI::App& app, CalibrationOptions& o) {
  auto* model =
      option(app, "--model", o.model, "a calibrated model: registered again from the data, the rest is kept", "FILE");
  auto* free =
      option(app, "--free", o.free,
             "with --model: what may move: base, tool (remounted: by millimetres), another-tool (by any amount), "
             "offsets, joined by commas",
             "WHAT");
  for (const char* of_calibration :
       {"--distances", "--contacts", "--robot", "--test-every", "--split", "--train", "--prior", "--report"})
    model->excludes(app.get_option(of_calibration));
  model->needs(free);
  free->needs(model);
}

bool given(const CLI::App& app, const char* name) { return app.count(name) > 0; }

/// Refuses what cannot be used together.
void require_consistent(const CLI::App& app, const CalibrationOptions& o) {
  if (o.data.empty() && (o.reregister || o.contacts.empty()))
    throw UsageError("--data is required (or --contacts, to calibrate without measured poses)");
  if (o.reregister) {
    if (o.data.size() != 1) throw UsageError("--model takes one file of --data");
    return;
  }
  if (!given(app, "--robot")) throw UsageError("--robot is required (or --model, to register a fitted arm again)");
  if (!o.data.empty()) return;
  for (const char* of_poses :
       {"--distances", "--test", "--test-every", "--split", "--test-fraction", "--train", "--report", "--prior"})
    if (given(app, of_poses)) throw UsageError(std::string(of_poses) + " needs --data");
}

}  // namespace

CalibrationOptions read_calibration_options(Program& program) {
  CalibrationOptions o;
  TypedValues typed;
  o.date = today();
  CLI::App& app = program.app();
  o.robot.add_to(app);
  add_measurements(app, o, typed);
  add_split(app, o);
  add_results(app, o);
  add_estimation(app, o, typed);
  add_reregistration(app, o);
  program.parse("calibrate_out");

  if (o.date.size() > 40 || std::any_of(o.date.begin(), o.date.end(), [](char c) { return c < ' '; }))
    throw UsageError("--date takes up to 40 plain characters");
  if (!o.test.empty() && o.test.size() != o.data.size())
    throw UsageError(fmt::format("{} files of --test for {} of --data", o.test.size(), o.data.size()));
  if (!o.save.empty()) require_writable(o.save);
  if (!o.report.empty()) require_writable(o.report);
  if (given(app, "--test-fraction") && o.split.empty()) o.split = "random";
  o.reregister = given(app, "--model");
  require_consistent(app, o);

  const std::map<std::string, vn::Loss> losses{
      {"squared", vn::Loss::squared}, {"huber", vn::Loss::huber}, {"cauchy", vn::Loss::cauchy}};
  vn::SensorModel& sensors = o.calibrate.sensors;
  sensors.loss = losses.at(typed.loss);
  sensors.distance_sigma = typed.distance_sigma_mm * 1e-3;
  sensors.contact_sigma = typed.contact_sigma_mm * 1e-3;
  sensors.use_orientations = !typed.positions_only;
  o.calibrate.errors.hysteresis = !o.no_approach;
  return o;
}

}  // namespace support
