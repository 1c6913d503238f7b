#include <cmath>

#include "calibration.hpp"
#include "dispatch.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/identification/reregister.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

namespace vn = vernier;

template <int N>
ReregistrationReport reregister_arm(const ReregistrationSettings& settings) {
  const vn::CalibratedRobot<N> robot = vn::load_calibrated_robot<N>(settings.model);
  const auto read = [&](const auto& path) {
    const auto poses = vn::read_dataset<N>(path, robot.nominal().joint_types());
    return settings.positions_only ? poses.without_orientations() : poses;
  };
  const vn::Dataset<N> data = read(settings.data), test = settings.test.empty() ? data : read(settings.test);
  const auto found = vn::reregister(robot.model(), data, settings.options);
  if (!found.determined)
    throw CalibrationFailure(vn::message(settings.data.string(), ": ", data.size(),
                                         " poses do not determine what may move; measure more, with the joints moved "
                                         "widely, or free less"));
  if (!found.converged || found.rms_after > 0.02)
    throw CalibrationFailure(vn::message(settings.data.string(), ": the model of ", robot.name(), " misses by ",
                                         std::round(found.rms_after * 1e4) / 10,
                                         " mm (rms) wherever it is put: wrong robot, units or columns?"));
  vn::Provenance from = robot.provenance();
  from.data_file += "," + settings.data.filename().string();
  from.date = settings.date;
  const vn::CalibratedRobot<N> moved = robot.with_model(found.model, from);

  ReregistrationReport report;
  report.robot = robot.name();
  report.train_rows = data.size();
  report.test_rows = test.size();
  report.held_out = !settings.test.empty();
  const bool oriented = test.has_orientations();
  const auto judge = [&](const char* key, const char* title, const auto& model) {
    report.stages.push_back(
        {key, title, vn::position_errors(model, test), oriented ? vn::rotation_errors(model, test) : vn::VectorX()});
  };
  judge("as_fitted", "as fitted", robot);
  judge("reregistered", "re-registered", moved);
  const auto change = [](const vn::Isometry3& by, std::array<double, 6>& out) {
    const vn::Vector6 values = vn::FrameParameters(by).values();
    std::copy(values.begin(), values.end(), out.begin());
  };
  change(moved.reference().base() * robot.reference().base().inverse(), report.base_change);
  change(robot.reference().tool().inverse() * moved.reference().tool(), report.tool_change);
  for (int i = 0; i < N; ++i) {
    const vn::DhRow &now = moved.identified().row(i), &before = robot.identified().row(i);
    report.offsets.push_back(now.joint == vn::JointType::revolute ? now.theta - before.theta : now.d - before.d);
  }
  if (!settings.save.empty()) vn::save_calibrated_robot(settings.save, moved);
  return report;
}

}  // namespace

ReregistrationReport reregister(const ReregistrationSettings& settings) {
  return dispatch_dof(vn::calibrated_robot_dof(settings.model), [&](auto n) { return reregister_arm<n()>(settings); });
}

}  // namespace support
