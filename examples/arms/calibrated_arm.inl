// SPDX-License-Identifier: BSD-3-Clause
// `CalibratedArm` for arms of VERNIER_JOINTS joints.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "calibrated_arm.hpp"
#include "calibration_instances.hpp"
#include "controller_rows.hpp"
#include "model_instances.hpp"
#include "with_branches.hpp"

namespace support {

namespace {

namespace vn = vernier;

template <int N>
class CalibratedArmOf final : public CalibratedArm {
  using Joints = vn::JointVector<N>;

 public:
  explicit CalibratedArmOf(vn::CalibratedRobot<N> robot) : robot_(std::move(robot)), change_(robot_.controller()) {}

  int joints() const override { return change_.moving(); }
  const std::string& name() const override { return robot_.name(); }
  const vn::Provenance& provenance() const override { return robot_.provenance(); }
  bool has_covariance() const override { return robot_.estimate() != nullptr; }
  std::string text() const override { return vn::to_json(robot_).dump(1) + "\n"; }

  void poses(RowsView q, RowsView previous, double* out, vn::ExecutorRef executor) const override {
    each_row(q, previous, executor, [&](vn::Index i, const Joints& at, const Joints* from) {
      set_pose(from != nullptr ? robot_.approached_from(*from).pose(at) : robot_.pose(at), out + 16 * i);
    });
  }
  void nominal_poses(RowsView q, double* out, vn::ExecutorRef executor) const override {
    each_row(q, {}, executor,
             [&](vn::Index i, const Joints& at, const Joints*) { set_pose(robot_.nominal().pose(at), out + 16 * i); });
  }
  void jacobians(RowsView q, RowsView previous, double* out, vn::ExecutorRef executor) const override {
    each_row(q, previous, executor, [&](vn::Index i, const Joints& at, const Joints* from) {
      set_jacobian(change_, from != nullptr ? robot_.approached_from(*from).jacobian(at) : robot_.jacobian(at),
                   out + 6 * joints() * i);
    });
  }

  void correct(RowsView q, RowsView previous, const CorrectionRows& out, vn::ExecutorRef executor) const override {
    each_row(q, previous, executor, [&](vn::Index i, const Joints& at, const Joints* from) {
      store(from != nullptr ? robot_.correct(at, *from) : robot_.correct(at), i, out);
    });
  }
  void correct_poses(RowsView targets, RowsView seeds, RowsView previous, const CorrectionRows& out,
                     vn::ExecutorRef executor) const override {
    executor.for_ranges(targets.rows, [&](vn::Index begin, vn::Index end) {
      for (vn::Index i = begin; i < end; ++i) {
        const Joints seed = chain_joints(change_, seeds.row(seeds.rows == 1 ? 0 : i));
        const vn::Isometry3 target = pose_at(targets.row(i));
        store(previous ? robot_.correct(target, seed, chain_joints(change_, previous.row(i)))
                       : robot_.correct(target, seed),
              i, out);
      }
    });
  }

  PathRows correct_path(const PathTask& task) const override {
    const vn::Index n = task.poses ? task.poses.rows : task.joints.rows;
    std::vector<vn::PathTarget<N>> targets;
    for (vn::Index i = 0; i < n; ++i) {
      vn::PathTarget<N> target{vn::Isometry3::Identity()};
      if (task.joints && std::all_of(task.joints.row(i), task.joints.row(i) + joints(),
                                     [](double value) { return std::isfinite(value); })) {
        target.joints.setZero();
        std::copy_n(task.joints.row(i), joints(), target.joints.data());
      }
      target.pose =
          task.poses ? pose_at(task.poses.row(i)) : robot_.nominal().pose(chain_joints(change_, task.joints.row(i)));
      if (!task.linear.empty() && task.linear[static_cast<std::size_t>(i)]) target.motion = vn::Motion::linear;
      targets.push_back(target);
    }
    vn::PathOptions<N> options{.limits = robot_.limits(),
                               .tolerance = task.tolerance,
                               .max_joint_step = task.max_joint_step,
                               .approach = task.approach,
                               .observer = task.observer};
    if (!task.start.empty()) {
      options.start.setZero();
      std::copy_n(task.start.begin(), joints(), options.start.begin());
    }
    const vn::InControllerJoints<vn::CalibratedRobot<N>> arm = robot_.in_controller_joints();
    vn::CorrectedPath<N> path;
    with_branches(robot_.nominal(), change_, options.limits, [&](const auto& roots) {
      if constexpr (std::is_null_pointer_v<std::remove_cvref_t<decltype(roots)>>) {
        vn::demand(targets.empty() || targets.front().joints.allFinite() || options.start.allFinite(),
                   "correct_path: poses of ", name(), " need `joints` or `start`, which choose the branch");
        path = vn::correct_path(arm, targets, options);
      } else {
        path = vn::correct_path(arm, roots, targets, options);
      }
    });
    PathRows out;
    out.before = path.before;
    out.after = path.after;
    for (const vn::PathPoint<N>& point : path.points) {
      out.commands.insert(out.commands.end(), point.command.data(), point.command.data() + joints());
      out.target.push_back(point.target);
      out.inserted.push_back(point.inserted);
      out.status.push_back(point.status);
      out.predicted_error.push_back(point.position_error);
      out.deviation.push_back(point.deviation);
    }
    return out;
  }

  void covariances(RowsView q, RowsView previous, double* out) const override {
    require_covariance();
    vn::MatrixX joints(q.rows, N), from(previous ? q.rows : 0, N);
    vn::VectorX gates(q.rows), temperatures(q.rows);
    temperatures.setConstant(robot_.model().thermal() == nullptr ? std::nan("") : robot_.model().thermal()->reference);
    each_row(q, previous, {}, [&](vn::Index i, const Joints& at, const Joints* before) {
      joints.row(i) = at.transpose();
      if (before != nullptr) from.row(i) = before->transpose();
      gates(i) = robot_.gate(at);
    });
    const std::vector<vn::Matrix6> found = robot_.estimate()->visit_covariances(joints, gates, 0, from, temperatures);
    for (const vn::Matrix6& covariance : found) out = std::copy_n(covariance.data(), 36, out);  // symmetric
  }

  vn::VerificationReport verify(const MeasuredPoses& poses, const vn::VerifyOptions& given) const override {
    require_covariance();
    const vn::Dataset<N> data = dataset_of<N>(poses, robot_.controller());
    vn::PointRows learned(robot_.learned() != nullptr ? data.size() : 0, 3);
    for (vn::Index i = 0; i < learned.rows(); ++i) learned.row(i) = robot_.learned()->error(data.joints(i)).transpose();
    vn::VerifyOptions options = given;
    options.expected_error = provenance().expected_error();
    options.fitted_rows = provenance().fitted_rows;
    options.fitted_poses =
        options.fitted_rows.empty() && !data.origin().empty() && provenance().fitted_to(data.origin().hashes.front());
    return vn::verify_calibration(robot_.model(), *robot_.estimate(), vn::Measurements<N>(data), options, learned);
  }

 private:
  void require_covariance() const {
    vn::demand(has_covariance(), name(), ": its model has no covariance; calibrate it again");
  }

  /// Calls `use(i, joints, previous)` for each row, in joints of the chain; `previous` is null where there is none.
  template <class Use>
  void each_row(RowsView q, RowsView previous, vn::ExecutorRef executor, const Use& use) const {
    executor.for_ranges(q.rows, [&](vn::Index begin, vn::Index end) {
      Joints from;
      for (vn::Index i = begin; i < end; ++i) {
        if (previous) from = chain_joints(change_, previous.row(i));
        use(i, chain_joints(change_, q.row(i)), previous ? &from : nullptr);
      }
    });
  }

  void store(const vn::Correction<N>& from, vn::Index i, const CorrectionRows& out) const {
    controller_joints(change_, from.command, out.command + joints() * i);
    out.status[i] = from.status;
    out.predicted_error[i] = from.predicted_error;
    out.gate[i] = from.gate;
  }

  vn::CalibratedRobot<N> robot_;
  vn::JointChange<N> change_;
};

}  // namespace

template <>
std::shared_ptr<const CalibratedArm> calibrated_arm_of(const vernier::CalibratedRobot<VERNIER_JOINTS>& robot) {
  return std::make_shared<const CalibratedArmOf<VERNIER_JOINTS>>(robot);
}

template <>
std::shared_ptr<const CalibratedArm> calibrated_arm_of<VERNIER_JOINTS>(const vernier::SavedModel& model) {
  return calibrated_arm_of(model.as<VERNIER_JOINTS>());
}

}  // namespace support
