// SPDX-License-Identifier: BSD-3-Clause
#include "pose_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "calibration_data.hpp"
#include "calibration_page.hpp"
#include "dispatch.hpp"
#include "file_name.hpp"
#include "instances.hpp"
#include "known_parts.hpp"
#include "report_page.hpp"
#include "saved_model.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/search/genetic_algorithm.hpp"

namespace support {

namespace {

namespace vn = vernier;

vn::VectorX search_priors(const vn::PriorObjective& objective, const vn::Box& box, bool genetic,
                          const vn::FitOptions& fit) {
  const auto best = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, {}, fit.seed, fit.executor, fit.observer).best;
  };
  if (genetic) return best(vn::GeneticAlgorithm{.individuals = 20, .generations = prior_generations});
  return best(vn::Pso{.particles = 20, .iterations = prior_generations, .positions = vn::PositionRule::clamped});
}

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

/// The tools of sets that have their own.
template <class Chain>
std::vector<FoundReflector> reflectors_of(const vn::Calibration<Chain>& calibration,
                                          const vn::Measurements<Chain::dof>& measured) {
  std::vector<FoundReflector> out;
  const vn::Index tool = vn::ArmParameters::chain_end(Chain::dof);
  for (std::size_t s = 0; s < measured.poses().size(); ++s) {
    FoundReflector one{measured.sets()[s].name, measured.poses()[s].size(),
                       calibration.model(s).identified().tool().translation(), vn::Vector3::Zero()};
    const vn::ErrorModelEstimate estimate = calibration.errors.of_station(static_cast<int>(s));
    const auto& unknowns = estimate.arm.geometric();
    for (std::size_t k = 0; k < unknowns.size() && estimate.covariance.size() > 0; ++k)
      if (const vn::Index axis = unknowns[k].parameter - tool; axis >= 0 && axis < 3 && !unknowns[k].thermal) {
        const auto at = static_cast<vn::Index>(k);
        one.std(axis) = unknowns[k].scale * std::sqrt(estimate.covariance(at, at));
      }
    out.push_back(std::move(one));
  }
  return out;
}

/// What a page shows of reflectors.
vn::ReportTable reflector_table(const std::vector<FoundReflector>& reflectors) {
  vn::ReportTable out{.title = "Reflectors",
                      .note = "Where each measured point is in the frame of the flange, with standard deviations.",
                      .head = {"measured", "poses", "x [mm]", "y [mm]", "z [mm]", "std [mm]"}};
  for (const FoundReflector& one : reflectors)
    out.rows.push_back(
        {one.name, fmt::format("{}", one.rows), fmt::format("{:.3f}", one.offset.x() * 1e3),
         fmt::format("{:.3f}", one.offset.y() * 1e3), fmt::format("{:.3f}", one.offset.z() * 1e3),
         fmt::format("{:.3f}, {:.3f}, {:.3f}", one.std.x() * 1e3, one.std.y() * 1e3, one.std.z() * 1e3)});
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

/// Options with those frames unknown that the arm does not state as known, and without what its passive joints hide.
/// @throws UsageError for a known base of several stations
CalibrationOptions options_for(CalibrationOptions o, const vn::RobotDescription& arm) {
  if (arm.base_known && o.data.size() > 1) throw UsageError(known_base_of_stations);
  const std::string held = hold_known_parts(arm, o.calibrate);
  if (!held.empty()) fmt::print("Held, because passive joints do not move by themselves: {}\n", held);
  return o;
}

template <int N>
PoseCalibration calibrate_arm(const vn::RobotDescription& description, const CalibrationOptions& given,
                              const vn::FitOptions& fit) {
  const CalibrationOptions o = options_for(given, description);
  const vn::DescribedRobot<N> robot = description.arm<N>();
  std::optional<vn::SavedModel> earlier;
  if (!o.prior.empty()) earlier = vn::read_model(o.prior);
  std::optional<vn::ArmPrior> prior;
  if (earlier) prior = prior_of(*earlier, N);
  const auto measured = [&] {
    try {
      return std::make_shared<const MeasuredFiles<N>>(
          read_measurements<N>(o, robot.arm.chain().joint_types(), fit.seed));
    } catch (const vn::DataError& error) {
      const std::string advice = passive_joint_advice(robot, o);
      if (advice.empty()) throw;
      throw vn::DataError(error.what() + advice);
    }
  }();
  std::vector<vn::DataAudit> audits = audit_files(robot, *measured);

  vn::CalibrateOptions options = o.calibrate;
  options.errors.drives = robot.drives;
  options.errors.down = robot.down;
  options.errors.controller = robot.controller;
  if (prior) options.errors.prior = &*prior;
  const auto search = [&](const vn::PriorObjective& objective, const vn::Box& box) {
    return search_priors(objective, box, o.priors == "ga", fit);
  };
  options.fit = fit;
  if (o.priors != "default") options.search = search;
  const auto calibration = vn::calibrate(robot.arm, measured->train, options);
  PoseCalibration out{.nominal = vn::ArmGeometry(robot.arm),
                      .identified = vn::ArmGeometry(calibration.geometry.model.identified()),
                      .report = vn::evaluate(calibration, measured->test, robot.limits, robot.controller),
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
                            .controller = robot.controller};
  };
  if (!o.save.empty()) out.model = {o.save, vn::save(o.save, calibration, info_of(0))};
  for (std::size_t s = 1; !o.save.empty() && own_tools && s < out.sets.size(); ++s) {
    out.further_models.push_back(numbered(o.save, s + 1));
    vn::save(out.further_models.back(), calibration, info_of(s), s);
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

}  // namespace

PoseCalibration calibrate_from_poses(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                     const vernier::FitOptions& fit) {
  return dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(robot, options, fit); });
}

}  // namespace support
