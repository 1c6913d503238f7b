// SPDX-License-Identifier: BSD-3-Clause
#include "saved_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "calibration_data.hpp"
#include "dispatch.hpp"
#include "file_name.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "report_page.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/report_json.hpp"
#include "vernier/registration/reregister.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// What `--free` names.
vn::ReregisterOptions parse_free(const std::string& free) {
  vn::ReregisterOptions out{.base = false};
  for (std::size_t at = 0; at <= free.size();) {
    const std::size_t comma = std::min(free.find(',', at), free.size());
    const std::string part = free.substr(at, comma - at);
    at = comma + 1;
    if (part == "base") {
      out.base = true;
    } else if (part == "offsets") {
      out.offsets = true;
    } else if (part == "tool" || part == "another-tool") {
      out.tool = true;
      if (part == "another-tool")
        out.tool_position_prior_std = out.tool_rotation_prior_std = std::numeric_limits<double>::infinity();
    } else {
      throw UsageError("--free takes base, tool, another-tool, offsets, joined by commas; not '" +
                       vn::detail::quotable(part) + "'");
    }
  }
  return out;
}

/// Refuses what must not be used, with advice.
void require_usable(const vn::ReregistrationReport& found, const std::string& robot, const std::string& file,
                    vn::Index poses) {
  constexpr double largest = 0.02;  // [m]; more than any real arm leaves
  if (!found.determined)
    throw vn::CalibrationFailure(
        fmt::format("{}: {} poses do not determine what may move; measure more, with the joints "
                    "moved widely, or free less",
                    file, poses));
  if (!found.converged || found.rms_after > largest)
    throw vn::CalibrationFailure(
        fmt::format("{}: the model of {} misses by {:.1f} mm (rms) in any base frame: wrong "
                    "robot, units or columns?",
                    file, robot, found.rms_after * 1e3));
}

/// Errors at some poses before and after.
template <int N>
std::vector<vn::StageErrors> errors_at(const vn::Dataset<N>& test, bool oriented, const vn::CalibratedRobot<N>& fitted,
                                       const vn::CalibratedRobot<N>& moved,
                                       const vn::Reregistered<vn::DhChain<N>>& found) {
  const auto stage = [&](vn::Stage of, const auto& model, const auto& as_seen) {
    return vn::StageErrors(of, vn::position_errors(model, test),
                           oriented ? vn::rotation_errors(as_seen, test) : vn::VectorX());
  };
  vn::Isometry3 probe = vn::Isometry3::Identity();  // a remounted probe turns measured orientations alone
  probe.linear() = vn::exp_so3(found.motion.probe);
  return {stage(vn::Stage::as_fitted, fitted, fitted),
          stage(vn::Stage::reregistered, moved,
                found.model.moved(vn::Isometry3::Identity(), vn::JointVector<N>::Zero(), probe))};
}

void write_results(Program& program, const CalibrationOptions& o, const std::string& robot, vn::Index poses,
                   const std::vector<vn::StageErrors>& stages, const vn::ReregistrationReport& found) {
  const vn::Index tested = stages.front().position.size();
  fmt::print(
      "{}: {} registered again from {} poses, everything else kept\n\nErrors of {} [mm]\n\n{}\n{}", robot, o.free,
      poses,
      o.test.empty() ? "those same poses (--test FILE names held-out ones)" : fmt::format("{} held-out poses", tested),
      vn::stage_table(stages), found.summary());
  if (program.common().json.empty()) return;
  Json json{{"robot", robot},
            {"train_rows", poses},
            {"test_rows", tested},
            {"held_out", !o.test.empty()},
            {"stages", vn::stages_to_json(stages)}};
  json.update(vn::to_json(found));
  write_json(program.common().json, json);
}

template <int N>
void reregister_arm(Program& program, CalibrationOptions o, const vn::ReregisterOptions& free,
                    const vn::SavedModel& model) {
  const vn::CalibratedRobot<N> robot = model.as<N>();
  o.csv.controller = robot.controller();
  const auto types = robot.nominal().chain().joint_types();
  const std::string& file = o.data.front();
  const vn::Dataset<N> data = read_poses<N>(file, o, types);
  const vn::Dataset<N> test = o.test.empty() ? data : read_poses<N>(o.test.front(), o, types);
  vn::ReregisterOptions of_arm = free;
  of_arm.expected_error = robot.provenance().expected_error();
  const auto found = vn::reregister(robot.model(), data, of_arm, o.calibrate.sensors);
  require_usable(found, robot.name(), file, data.size());
  vn::Provenance from = robot.provenance();
  from.data_file += "," + file_name(file);
  if (!from.data_sha256.empty()) from.data_sha256 += "," + data.origin().hashes.front();
  if (!from.fitted_rows.empty()) from.fitted_rows.add({data.joints(), data.positions()});
  from.date = o.date;
  const vn::CalibratedRobot<N> moved = robot.with_model(found.model, from);
  const bool oriented = test.has_orientations() && o.calibrate.sensors.use_orientations;
  write_results(program, o, robot.name(), data.size(), errors_at(test, oriented, robot, moved, found), found);
  if (o.save.empty()) return;
  vn::save(o.save, moved);
  fmt::print("Calibrated model: {}\n", shown(o.save));
}

}  // namespace

vernier::ArmPrior prior_of(const vernier::SavedModel& saved, int joints) {
  const std::string& file = saved.file();
  if (saved.dof() != joints || saved.modified())
    throw UsageError(fmt::format("{}: is of an arm of {} joints, expected {}", file, saved.dof(), joints));
  return dispatch_dof(joints, [&](auto n) {
    const auto robot = saved.as<n()>();
    if (robot.estimate() == nullptr)
      throw UsageError(file +
                       ": has no covariance: an older program saved it, or what was learned is on geometry alone; "
                       "calibrate that arm again");
    vn::ArmPrior out = vn::arm_prior(robot);
    out.name = file_name(file);
    return out;
  });
}

int reregister_model(Program& program, const CalibrationOptions& options) {
  const vn::ReregisterOptions free = parse_free(options.free);
  const vn::SavedModel model = vn::read_model(options.model);
  dispatch_dof(model.dof(), [&](auto n) { reregister_arm<n()>(program, options, free, model); });
  return 0;
}

}  // namespace support
