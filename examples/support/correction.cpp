#include "correction.hpp"

#include "dispatch.hpp"
#include "joint_units.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

const char* words(vernier::IkStatus status) {
  switch (status) {
    case vernier::IkStatus::converged: return "converged";
    case vernier::IkStatus::unreachable: return "unreachable";
    default: return "stalled";
  }
}

template <int N>
CorrectionReport correct_arm(const std::filesystem::path& model, const std::filesystem::path& targets, bool poses,
                             const std::filesystem::path& out) {
  using vernier::Index;
  const vernier::CalibratedRobot<N> robot = vernier::load_calibrated_robot<N>(model);
  vernier::Dataset<N> data;
  if (poses) {
    data = vernier::read_dataset<N>(targets);
    if (N >= 6 && !data.has_orientations())
      throw vernier::DataError(targets.string() + ": no columns rx_rad, ry_rad, rz_rad; a pose of an arm of " +
                               std::to_string(N) + " joints has an orientation");
  } else {
    vernier::JointRows<N> joints = vernier::read_joints<N>(targets);
    const Index n = joints.rows();
    data = vernier::Dataset<N>(std::move(joints), vernier::PointRows::Zero(n, 3));
  }
  require_joint_units(targets, robot.nominal());

  CorrectionReport report{robot.name()};
  std::string text;
  for (int j = 0; j < N; ++j)
    text +=
        vernier::message("q", j + 1, robot.nominal().row(j).joint == vernier::JointType::revolute ? "_rad," : "_m,");
  text += "status,predicted_error_mm,gate\n";
  for (Index i = 0; i < data.size(); ++i) {
    const vernier::JointVector<N> q = data.joints(i);
    vernier::Isometry3 target = vernier::Isometry3::Identity();
    if (poses) {
      target.translation() = data.position(i);
      if (data.has_orientations()) target.linear() = data.orientation(i);
    }
    const vernier::Correction<N> correction = poses ? robot.correct(target, q) : robot.correct(q);
    for (int j = 0; j < N; ++j) text += vernier::message(correction.command(j), ',');
    text +=
        vernier::message(words(correction.status), ',', correction.predicted_error * 1e3, ',', correction.gate, '\n');
    report.errors.push_back(correction.predicted_error);
    if (correction.status != vernier::IkStatus::converged) report.missed.push_back(i);
    if (correction.gate < 1) ++report.extrapolated;
  }
  vernier::write_file(out, text);
  return report;
}

}  // namespace

CorrectionReport correct_targets(const std::filesystem::path& model, const std::filesystem::path& targets, bool poses,
                                 const std::filesystem::path& out) {
  return dispatch_dof(vernier::calibrated_robot_dof(model),
                      [&](auto n) { return correct_arm<n()>(model, targets, poses, out); });
}

}  // namespace support
