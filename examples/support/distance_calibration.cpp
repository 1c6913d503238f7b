// SPDX-License-Identifier: BSD-3-Clause
#include "distance_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calibration_instances.hpp"
#include "dispatch.hpp"
#include "file_name.hpp"
#include "held_out_rows.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "parameter_table.hpp"
#include "pose_calibration.hpp"
#include "progress.hpp"
#include "report_page.hpp"
#include "saved_model.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/report_json.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// Distances to learn from and held-out ones, one set a fixed point.
template <int N>
struct MeasuredDistances {
  std::vector<vn::Distances<N>> train{}, test{};
  std::string held_out{};
  std::vector<vn::ReportFile> inputs{};
};

template <int N>
MeasuredDistances<N> read_and_split(const CalibrationOptions& o, std::span<const vn::JointType> types,
                                    std::uint64_t seed) {
  MeasuredDistances<N> out;
  for (std::size_t f = 0; f < o.distances.size(); ++f) {
    const std::string& file = o.distances[f];
    const vn::Distances<N> all = vn::read_distances<N>(file, types, o.csv.format());
    out.inputs.push_back(file_of(all.origin()));
    vn::Distances<N> train = all;
    if (!o.test.empty()) {
      out.test.push_back(vn::read_distances<N>(o.test[f], types, o.csv.format()));
      out.inputs.push_back(file_of(out.test.back().origin()));
      out.held_out += (f == 0 ? "the rows of " : ", ") + o.test[f];
    } else {
      try {
        const vn::detail::SplitRows rows = whole_poses(held_out_rows(all.size(), o, seed, file, "row", out.held_out),
                                                       all.joints(), {.joint_types = types}, out.held_out);
        train = all.rows(rows.train);
        out.test.push_back(all.rows(rows.test));
      } catch (const std::invalid_argument& error) {
        throw vn::CalibrationFailure(file + ": " + error.what());
      }
    }
    out.train.push_back(train.rows(training_rows(train.size(), o, seed, file, "rows")));
  }
  return out;
}

/// Errors of distances by models, one a fixed point, which is the origin of the model's frame [m].
template <int N, class Model>
vn::VectorX distance_errors(const std::vector<Model>& models, const std::vector<vn::Distances<N>>& measured) {
  std::vector<double> out;
  for (std::size_t s = 0; s < measured.size(); ++s)
    for (vn::Index i = 0; i < measured[s].size(); ++i)
      out.push_back(std::abs(models[s].position(measured[s].joints(i)).norm() - measured[s].length(i)));
  return Eigen::Map<const vn::VectorX>(out.data(), static_cast<vn::Index>(out.size()));
}

/// The page of `--report`.
template <int N>
vn::ReportInput page_of(const vn::Calibration<vn::DhChain<N>>& calibration, const MeasuredDistances<N>& measured,
                        const std::vector<vn::StageErrors>& stages, const vn::DescribedRobot<N>& robot,
                        const CalibrationOptions& o) {
  vn::ReportInput page;
  page.robot = robot.name;
  page.what = "distances";
  page.title = "Calibration by distances";
  page.rule = measured.held_out;
  page.stages = stages;
  page.after = calibration.chosen();
  for (const vn::Distances<N>& one : measured.train) page.train_poses += one.size();
  page.parameters = calibration.geometry.parameters;
  page.correlated = calibration.geometry.strongly_correlated();
  if (o.accept_mm > 0) page.accept = o.accept_mm * 1e-3;
  page.provenance.inputs = measured.inputs;
  for (const vn::Distances<N>& one : measured.test) {
    vn::PointRows unmeasured = vn::PointRows::Zero(one.size(), 3);
    add_poses(page, robot.arm.chain(), vn::Dataset<N>(one.joints(), unmeasured).from(one.origin()));
  }
  page.times.resize(0);
  return page;
}

template <int N>
int calibrate_arm(Program& program, const vn::RobotDescription& description, const CalibrationOptions& given) {
  const CalibrationOptions o = options_for(given, description, given.distances.size());
  const vn::DescribedRobot<N> robot = description.arm<N>();
  std::optional<vn::SavedModel> earlier;
  std::optional<vn::ArmPrior> prior;
  if (!o.prior.empty()) {
    earlier = vn::read_model(o.prior);
    prior = prior_of(*earlier, N);
  }
  const vn::ThreadExecutor executor(program.common().threads);
  const vn::FitOptions fit{.seed = program.common().seed, .executor = executor};
  MeasuredDistances<N> measured = read_and_split<N>(o, robot.arm.chain().joint_types(), fit.seed);
  if (earlier) measured.inputs.push_back({earlier->file(), 0, earlier->hash()});
  for (const vn::SourceFile& file : description.files) measured.inputs.push_back({file.name, 0, file.hash});

  vn::CalibrateOptions options = o.calibrate;
  options.arm_name = robot.name;
  if (prior) options.errors.prior = &*prior;
  options.fit = fit;
  const auto search = [&](const vn::PriorObjective& objective, const vn::Box& box) {
    return search_priors(objective, box, o.priors == "ga", fit);
  };
  if (o.priors != "default") options.search = search;
  Working working("fitting the error model");
  const auto watch = [&](const vn::Progress& progress) { working.reach(share_of_fit(progress.generation)); };
  options.errors.observer = watch;
  vn::IdentifyOptions frames = options.geometry;
  frames.geometry = false;
  std::vector<vn::Framed<vn::DhChain<N>>> designed;
  vn::Measurements<N> train;
  for (std::size_t s = 0; s < measured.train.size(); ++s) {
    const vn::Measurements<N> wire(measured.train[s]);
    const auto registered = vn::identify(robot.arm, wire, frames, options.sensors, vn::own_solver);
    vn::detail::require_plausible_set(vn::ArmGeometry(registered.model.identified()), wire.sets().front());
    designed.push_back(registered.model.identified());
    train.add(measured.train[s], o.distances[s]);
  }
  const auto calibration = vn::calibrate(robot.arm, train, options);
  working.finish();

  std::vector<vn::StageErrors> stages;
  stages.emplace_back(vn::Stage::frames, distance_errors(designed, measured.test), vn::VectorX());
  for (const auto& staged : calibration.errors.stages)
    stages.emplace_back(staged.stage, distance_errors(staged.models, measured.test), vn::VectorX());
  const vn::StageName chosen = calibration.chosen();
  const auto deployed =
      std::find_if(stages.begin(), stages.end(), [&](const vn::StageErrors& stage) { return stage.name == chosen; });
  const double error = deployed->position.mean();
  vn::Index learned = 0;
  for (const auto& one : measured.train) learned += one.size();
  fmt::print("{}: {} joints\n{} distances from {} fixed point{} to learn from, {} held out: {}\n\n", robot.name, N,
             learned, measured.train.size(), measured.train.size() == 1 ? "" : "s", stages.front().position.size(),
             measured.held_out);
  fmt::print(
      "Errors of held-out distances [mm]\n\n{}\nDeployed, as left-out distances decide: {}, mean error {:.3f} mm\n",
      vn::stage_table(stages), deployed->title, error * 1e3);
  if (o.parameters)
    fmt::print("\nFrames and links, as the stage geometry has them\n\n{}", parameter_table(calibration.geometry));
  if (o.verbose) fmt::print("\n{}", calibration.geometry.summary());
  fmt::print(
      "\nDistances from a point do not show how the base is turned about it: that stays as the start has it. For work "
      "in a tracker's or a cell's frame, register the model with a few poses (--model, --free base).\n");

  Json json{{"robot", robot.name},
            {"train_rows", learned},
            {"test_rows", stages.front().position.size()},
            {"held_out", measured.held_out},
            {"stages", vn::stages_to_json(stages)},
            {"chosen", chosen.key()}};
  for (const vn::ParameterEstimate& p : calibration.geometry.parameters)
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.kind == vn::ParameterKind::length ? "mm" : "mrad"},
                                  {"nominal", p.nominal * 1e3},
                                  {"identified", p.identified * 1e3},
                                  {"std", p.std * 1e3}});
  if (!program.common().json.empty()) write_json(program.common().json, json);
  vn::SourceFile model;
  if (!o.save.empty()) {
    std::string files, hashes;
    for (std::size_t s = 0; s < o.distances.size(); ++s) {
      files += (s == 0 ? "" : ",") + file_name(o.distances[s]);
      hashes += (s == 0 ? "" : ",") + measured.train[s].origin().hashes.front();
    }
    const auto found = vn::calibrated_robot(calibration, vn::RobotInfo<N>{.name = robot.name,
                                                                          .limits = robot.limits,
                                                                          .data_file = files,
                                                                          .date = o.date,
                                                                          .held_out_error = error,
                                                                          .data_sha256 = hashes,
                                                                          .controller = robot.controller});
    vn::Provenance from = found.provenance();
    from.rows = learned;
    from.measured = "distances";
    model = {o.save, vn::save(o.save, found.with_model(found.model(), from))};
    fmt::print("Calibrated model: {}\n", shown(o.save));
  }
  if (!o.report.empty()) {
    vn::ReportInput page = page_of(calibration, measured, stages, robot, o);
    page.results = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    write_report(program, o.report, page, o.date, model);
    fmt::print("Report: {}\n", shown(o.report));
  }
  return 0;
}

}  // namespace

int calibrate_by_distances(Program& program, const vernier::RobotDescription& robot, const CalibrationOptions& o) {
  return dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(program, robot, o); });
}

}  // namespace support
