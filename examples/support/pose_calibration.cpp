// SPDX-License-Identifier: BSD-3-Clause
#include "pose_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "calibration_data.hpp"
#include "calibration_instances.hpp"
#include "calibration_page.hpp"
#include "dispatch.hpp"
#include "file_name.hpp"
#include "held_out.hpp"
#include "known_parts.hpp"
#include "model_instances.hpp"
#include "report_page.hpp"
#include "saved_model.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/search/genetic_algorithm.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// Names of files without their folders, joined by commas.
std::string file_names(const std::vector<std::string>& paths) {
  std::string out;
  for (const std::string& path : paths) out += (out.empty() ? "" : ",") + file_name(path);
  return out;
}

/// Digests of the files of some sets, joined by commas.
template <int N>
std::string file_hashes(const std::vector<vn::Dataset<N>>& sets) {
  std::string out;
  for (const auto& set : sets)
    if (const std::string& hash = set.origin().hashes.front(); !out.ends_with(hash))
      out += (out.empty() ? "" : ",") + hash;
  return out;
}

template <int N>
vn::ErrorStatistics held_out_error(const vn::RobotDescription& description, const MeasuredFiles<N>& measured,
                                   const CalibrationOptions& o) {
  vn::IdentifyOptions frames = o.calibrate.geometry;
  frames.geometry = false;
  const auto registered =
      vn::identify(description.arm<N>().arm, measured.train.poses()[0], frames, o.calibrate.sensors, vn::own_solver);
  return vn::prediction_error(registered.model, measured.test.poses()[0]);
}

/// A model in its file, with the camera that saw its poses where there was one.
template <int N>
std::string save_station(const std::string& path, const vn::Calibration<vn::DhChain<N>>& calibration,
                         const vn::RobotInfo<N>& info, std::size_t station,
                         const std::optional<vn::CameraSetup>& camera, double camera_error) {
  if (!camera) return vn::save(path, calibration, info, station);
  const vn::CalibratedRobot<N> robot = vn::calibrated_robot(calibration, info, station);
  vn::Provenance from = robot.provenance();
  from.measured = "images";
  from.camera = camera;
  from.held_out_error = camera_error;  // without the noise of single images
  return vn::save(path, robot.with_model(robot.model(), std::move(from)));
}

}  // namespace

template <int N>
PoseCalibration calibrate_measured(const vn::RobotDescription& description, const CalibrationOptions& o,
                                   const vn::FitOptions& fit,
                                   const std::function<std::shared_ptr<const MeasuredFiles<N>>()>& measure) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  std::optional<vn::SavedModel> earlier;
  if (!o.prior.empty()) earlier = vn::read_model(o.prior);
  std::optional<vn::ArmPrior> prior;
  if (earlier) prior = prior_of(*earlier, N);
  const std::shared_ptr<const MeasuredFiles<N>> measured = measure();
  std::vector<vn::DataAudit> audits = audit_files(robot, *measured);

  vn::CalibrateOptions options = o.calibrate;
  if (prior) options.errors.prior = &*prior;
  const auto search = [&](const vn::PriorObjective& objective, const vn::Box& box) {
    return search_priors(objective, box, o.priors == "ga", fit);
  };
  options.fit = fit;
  if (o.priors != "default") options.search = search;
  auto calibration = vn::calibrate(robot.arm, measured->train, options);
  if (measured->covariance) calibration.errors.covariance = measured->covariance(calibration.errors);
  PoseCalibration out{.nominal = vn::ArmGeometry(robot.arm),
                      .identified = vn::ArmGeometry(calibration.geometry.model.identified()),
                      .report = evaluate_visits(calibration, measured->test, robot.limits, robot.controller),
                      .held_out = measured->held_out,
                      .audits = std::move(audits)};
  out.error_of = [measured, o](const vn::RobotDescription& arm) { return held_out_error(arm, *measured, o); };
  const bool own_tools = measured->has_own_tools(options.errors.tool_per_station);
  out.sets = measured->names;
  if (own_tools) out.reflectors = reflectors_of(calibration, measured->train);
  const auto info_of = [&](std::size_t set) {
    const std::string& reflector = measured->train.sets()[set].reflector;
    return vn::RobotInfo<N>{.name = robot.name,
                            .limits = robot.limits,
                            .data_file = file_names(o.data) + (reflector.empty() ? "" : " (point " + reflector + ")"),
                            .date = o.date,
                            .held_out_error = out.report.stage(out.report.chosen).position.mean(),
                            .data_sha256 = file_hashes<N>(measured->files),
                            .controller = robot.controller,
                            .fitted_rows = measured->fitted_rows};
  };
  if (!o.save.empty())
    out.model = {o.save, save_station<N>(o.save, calibration, info_of(0), 0, measured->camera, measured->camera_error)};
  for (std::size_t s = 1; !o.save.empty() && own_tools && s < out.sets.size(); ++s) {
    out.further_models.push_back(numbered(o.save, s + 1));
    save_station<N>(out.further_models.back(), calibration, info_of(s), s, measured->camera, measured->camera_error);
  }
  if (!o.report.empty()) {
    out.page = calibration_page(out.report, o, robot, *measured);
    out.page.audit = audit_rows(measured->names, out.audits);
    if (!out.reflectors.empty()) out.page.tables.push_back(reflector_table(out.reflectors));
    std::vector<vn::ReportFile>& inputs = out.page.provenance.inputs;
    if (earlier) inputs.push_back({earlier->file(), 0, earlier->hash()});
    for (const vn::SourceFile& file : description.files) inputs.push_back({file.name, 0, file.hash});
  }
  return out;
}

vernier::VectorX search_priors(const vernier::PriorObjective& objective, const vernier::Box& box, bool genetic,
                               const vernier::FitOptions& fit) {
  const auto best = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, {}, fit.seed, fit.executor, fit.observer).best;
  };
  if (genetic) return best(vn::GeneticAlgorithm{.individuals = 20, .generations = prior_generations});
  return best(vn::Pso{.particles = 20, .iterations = prior_generations, .positions = vn::PositionRule::clamped});
}

CalibrationOptions options_for(CalibrationOptions o, const vn::RobotDescription& arm, std::size_t stations) {
  if (arm.base_known && stations > 1) throw UsageError(known_base_of_stations);
  const std::string held = hold_known_parts(arm, o.calibrate);
  if (!held.empty()) fmt::print("Held, because passive joints do not move by themselves: {}\n", held);
  o.calibrate.errors.drives = arm.drives;
  o.calibrate.errors.down = arm.chain_down();
  o.calibrate.errors.controller = arm.controller;
  return o;
}

PoseCalibration calibrate_from_poses(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                     const vernier::FitOptions& fit) {
  const CalibrationOptions o = options_for(options, robot, options.data.size());
  return dispatch_dof(robot.dof(), [&](auto n) {
    try {
      return calibrate_measured<n()>(robot, o, fit, [&] {
        return std::make_shared<const MeasuredFiles<n()>>(read_measurements<n()>(o, robot.joint_types(), fit.seed));
      });
    } catch (const vn::DataError& error) {
      const std::string advice = passive_joint_advice(robot.arm<n()>(), o);
      if (advice.empty()) throw;
      throw vn::DataError(error.what() + advice);
    }
  });
}

#define VERNIER_INSTANTIATE(N)                                                                           \
  template PoseCalibration calibrate_measured<N>(const vn::RobotDescription&, const CalibrationOptions&, \
                                                 const vn::FitOptions&,                                  \
                                                 const std::function<std::shared_ptr<const MeasuredFiles<N>>()>&);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
