// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A calibrated arm as one closed value: everything that is needed to correct its commands, saved and loaded as JSON.

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/compensated.hpp"
#include "vernier/compensation/learned_error.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/identification/fitted_arm.hpp"
#include "vernier/io/provenance.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

/// A nominal chain, its error model in base and tool frames, its limits, and optionally a learned position error on
/// top. A kinematic model (of the identified arm) and a compensator. Frames are kept by their six values, so that what
/// is loaded from a file is bit for bit what was saved. Joint values are those of the chain, but limits are those of
/// the controller; `in_controller_joints` is the arm as its controller counts.
template <int N, class Convention = StandardDh>
class CalibratedRobot : public ChecksJoints<CalibratedRobot<N, Convention>> {
  using Checks = ChecksJoints<CalibratedRobot>;

 public:
  using Checks::approached_from;
  using Checks::correct;
  using Checks::gate;
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;
  using Checks::predict;

  /// Number of joints.
  static constexpr int dof = N;
  /// The kind of chain.
  using Chain = DhChain<N, Convention>;
  /// The identified arm beside the nominal one.
  using Model = ErrorModel<Chain>;
  /// The learned position error.
  using Learned = LearnedError<N>;
  /// The error model with the learned position error.
  using Corrected = CartesianCorrected<Model, Learned>;

  /// @param name       of the arm
  /// @param model      the error model, which keeps the nominal arm
  /// @param limits     of the commands
  /// @param provenance where the calibration comes from
  /// @throws std::invalid_argument when the two chains have joints of different types
  CalibratedRobot(std::string name, const Model& model, const JointLimits<N>& limits, Provenance provenance)
      : name_(std::move(name)), limits_(limits), provenance_(std::move(provenance)), model_(by_values(model)) {
    for (int i = 0; i < N; ++i)
      demand(nominal().chain().row(i).joint == identified().chain().row(i).joint, "CalibratedRobot: joint ", i + 1,
             " is of another type in the identified chain than in the nominal one");
  }

  /// This robot with a learned position error.
  CalibratedRobot with_learned(const Learned& learned, const JointCoverage<N>& gate) const {
    CalibratedRobot out = *this;
    out.corrected_.emplace(model_, learned, gate);
    return out;
  }

  /// This robot with another model, in other frames perhaps: what was learned in its base frame rotates with it.
  CalibratedRobot with_model(const Model& model, Provenance provenance) const {
    CalibratedRobot out(name_, model, limits_, std::move(provenance));
    out.controller_ = controller_;
    out.change_ = change_;
    if (estimate_) out = out.with_estimate(estimate_->of_arm(FittedArm::of(out.identified())));
    if (!corrected_) return out;
    const Matrix3 turn = out.identified().base().linear() * identified().base().linear().transpose();
    return out.with_learned(corrected_->learned().turned(turn), corrected_->coverage());
  }

  /// This robot at a temperature [deg C], see `ErrorModel::at_temperature`.
  CalibratedRobot at_temperature(double celsius) const {
    CalibratedRobot out = *this;
    out.model_ = model_.at_temperature(celsius);
    if (corrected_) out.corrected_.emplace(out.model_, corrected_->learned(), corrected_->coverage());
    return out;
  }

  /// This robot under a payload, in place of the mean one of its measurements, see `ErrorModel::carrying`. Its radii
  /// count what is unknown of compliance to payload.
  CalibratedRobot carrying(const Payload& payload) const {
    CalibratedRobot out = *this;
    out.model_ = model_.carrying(payload);
    out.payload_ = payload;
    if (corrected_) out.corrected_.emplace(out.model_, corrected_->learned(), corrected_->coverage());
    return out;
  }

  /// This robot with a controller whose joints have the limits; throws for a map of another number of joints.
  CalibratedRobot with_controller(const ControllerMap& controller) const {
    CalibratedRobot out = *this;
    out.change_ = JointChange<N>(out.controller_ = controller);
    return out;
  }
  /// How the chain's joints follow from those of the controller.
  const ControllerMap& controller() const { return controller_; }
  /// This robot with the controller's joints, for `all_branches` and `correct_path` within `limits()`.
  auto in_controller_joints() const { return InControllerJoints<CalibratedRobot>(*this, change_); }

  /// This robot with the estimate of its calibration: unknowns with their covariance, and noise.
  CalibratedRobot with_estimate(ErrorModelEstimate estimate) const {
    CalibratedRobot out = *this;
    out.estimate_ = std::make_shared<const ErrorModelEstimate>(std::move(estimate));
    return out;
  }
  /// What its calibration estimated, of one station; null where that was not kept, as in older files.
  const ErrorModelEstimate* estimate() const { return estimate_.get(); }

  /// Its name.
  const std::string& name() const { return name_; }
  /// The identified chain with its joint errors, in the identified frames, where the joints were measured.
  const auto& identified() const { return model_.identified(); }
  /// The nominal chain in the identified frames.
  const Framed<Chain>& nominal() const { return model_.nominal(); }
  /// The error model, without learned position error.
  const Model& model() const { return model_; }
  /// Limits of the controller's joints.
  const JointLimits<N>& limits() const { return limits_; }
  /// Where the calibration comes from.
  const Provenance& provenance() const { return provenance_; }
  /// The learned stage; null where there is none.
  const Corrected* learned() const { return corrected_ ? &*corrected_ : nullptr; }

  /// The pose of the identified arm.
  Isometry3 pose(const JointVector<N>& q) const noexcept { return corrected_ ? corrected_->pose(q) : model_.pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->position(q) : model_.position(q);
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->pose_and_jacobian(q) : model_.pose_and_jacobian(q);
  }
  /// Share of what was learned over the joints that is used at q; 1 where nothing was.
  double gate(const JointVector<N>& q) const noexcept {
    return corrected_ ? (std::min)(corrected_->gate(q), model_.gate(q)) : model_.gate(q);
  }

  /// A sphere that contains every position of its tool; none is known where a position error was learned.
  ReachSphere reach_sphere() const {
    ReachSphere out = model_.reach_sphere();
    if (corrected_) out.radius = std::numeric_limits<double>::infinity();
    return out;
  }

  /// The pose the arm takes when commanded q.
  Isometry3 predict(const JointVector<N>& q) const noexcept { return pose(q); }
  /// The command that brings the arm where the nominal one would be at q, in the middle of both directions of approach.
  [[nodiscard]] Correction<N> correct(const JointVector<N>& q) const noexcept { return correct(q, unknown()); }
  /// The command that brings the arm where the nominal one would be at q, approached from known joint values.
  /// @param q        where the nominal arm is to be [rad, m]
  /// @param previous the command before [rad, m]; not finite where unknown
  [[nodiscard]] Correction<N> correct(const JointVector<N>& q, const JointVector<N>& previous) const noexcept {
    return correct(nominal().pose(q), q, previous);
  }
  /// The command that brings the arm to a pose in the frame of the measurements.
  /// @param target the pose
  /// @param seed   joints near the solution; they choose the branch
  [[nodiscard]] Correction<N> correct(const Isometry3& target, const JointVector<N>& seed) const noexcept {
    return correct(target, seed, unknown());
  }
  /// The command that brings the arm to a pose, approached from known joint values.
  /// @param target   the pose
  /// @param seed     joints near the solution; they choose the branch
  /// @param previous the command before [rad, m]; not finite where unknown
  [[nodiscard]] Correction<N> correct(const Isometry3& target, const JointVector<N>& seed,
                                      const JointVector<N>& previous) const noexcept {
    const Compensated<InControllerJoints<Approached>, Framed<Chain>> arm({{*this, previous}, change_}, nominal());
    Correction<N> out = arm.within(limits_).correct(target, change_.to_controller(seed));
    out.command = change_.to_chain(out.command);
    return out;
  }

  /// Radius around the modelled tool position within which the arm's is with 95 % probability [m], for n commands that
  /// are executed in their order; NaN where a command is not finite. What is left of the target comes on top.
  /// @param commands n x N; the first one is approached from nobody knows where, as is one behind a row that is not
  /// finite
  /// @throws std::invalid_argument where the covariance of the calibration was not kept
  /// @complexity O(n unknowns^2)
  std::vector<double> radii_95(const JointRows<N>& commands) const {
    demand(estimate_ != nullptr, name_, ": its model has no covariance; calibrate it again");
    std::vector<double> out(static_cast<std::size_t>(commands.rows()), std::numeric_limits<double>::quiet_NaN());
    std::vector<Index> rows;
    for (Index i = 0; i < commands.rows(); ++i)
      if (configuration(commands, i).allFinite()) rows.push_back(i);
    const auto n = static_cast<Index>(rows.size());
    JointRows<N> q(n, N), previous(n, N);
    VectorX gates(n), temperatures(n);
    for (Index k = 0; k < n; ++k) {
      const Index i = rows[static_cast<std::size_t>(k)];
      const JointVector<N> at = configuration(commands, i);
      set_configuration(q, k, at);
      set_configuration(previous, k, i > 0 ? configuration(commands, i - 1) : unknown());
      gates(k) = gate(at);
    }
    temperatures.setConstant(model_.thermal() == nullptr ? std::numeric_limits<double>::quiet_NaN()
                                                         : model_.thermal()->reference);
    MatrixX payloads(std::isfinite(payload_.mass) ? n : 0, 4);
    for (Index k = 0; k < payloads.rows(); ++k) {
      payloads(k, 0) = payload_.mass;
      for (Index r = 0; r < 3; ++r) payloads(k, 1 + r) = payload_.centre(r);
    }
    const std::vector<Matrix6> covariances =
        estimate_->visit_covariances(q, gates, 0, previous, temperatures, payloads);
    for (std::size_t k = 0; k < rows.size(); ++k)
      out[static_cast<std::size_t>(rows[k])] = radius_95(covariances[k].template topLeftCorner<3, 3>());
    return out;
  }
  /// These radii for commands whose number of joints is known at run time.
  /// @throws std::invalid_argument on another number of columns, or where the covariance was not kept
  template <ColumnsAtRunTime Rows>
  std::vector<double> radii_95(const Rows& commands) const {
    return radii_95(detail::joint_rows<N>(commands));
  }

  /// The arm as it moves to a configuration from known joint values: a kinematic model, a view of the robot, which must
  /// outlive it.
  class Approached : public ChecksJoints<Approached> {
    using Checks = ChecksJoints<Approached>;

   public:
    using Checks::gate;
    using Checks::jacobian;
    using Checks::pose;
    using Checks::pose_and_jacobian;
    using Checks::position;

    /// Number of joints.
    static constexpr int dof = N;

    /// @param robot    seen through this; must outlive it
    /// @param previous joint values from which it moves to the next configuration [rad, m]; not finite where unknown
    Approached(const CalibratedRobot& robot, const JointVector<N>& previous) noexcept
        : robot_(&robot), model_(robot.model_, previous) {}
    /// The robot, approached from joint values whose number is known at run time.
    /// @throws std::invalid_argument on another number
    template <SizedAtRunTime Q>
    Approached(const CalibratedRobot& robot, const Q& previous)
        : Approached(robot, detail::joint_vector<N>(previous)) {}

    /// base_T_tool.
    Isometry3 pose(const JointVector<N>& q) const noexcept {
      Isometry3 out = model_.pose(q);
      if (robot_->corrected_) out.translation() -= robot_->corrected_->error(q);
      return out;
    }
    /// Tool position [m], base frame.
    Vector3 position(const JointVector<N>& q) const noexcept {
      const Vector3 out = model_.position(q);
      return robot_->corrected_ ? Vector3(out - robot_->corrected_->error(q)) : out;
    }
    /// Geometric Jacobian, 6 x N, see `Jacobian`.
    Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
    /// Both in one pass.
    PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
      PoseAndJacobian<N> out = model_.pose_and_jacobian(q);
      if (robot_->corrected_) robot_->corrected_->correct(q, out);
      return out;
    }
    /// Share of what was learned over the joints that is used at q.
    double gate(const JointVector<N>& q) const noexcept { return robot_->gate(q); }

   private:
    const CalibratedRobot* robot_;
    ApproachedErrorModel<Chain> model_;
  };
  /// The arm as it moves to the next configuration from known joint values, with the hysteresis of its joints.
  /// @param previous joint values [rad, m]
  Approached approached_from(const JointVector<N>& previous) const noexcept { return {*this, previous}; }

 private:
  static JointVector<N> unknown() { return JointVector<N>::Constant(std::numeric_limits<double>::quiet_NaN()); }

  static typename Model::Arm by_values(const typename Model::Arm& arm) {
    return typename Model::Arm(arm.model(), FrameParameters(arm.base_frame().values()),
                               FrameParameters(arm.tool_frame().values()));
  }
  static Model by_values(const Model& model) {
    const Chain& chain = model.nominal().model();
    const Model out = model.fallback() == nullptr ? Model(chain, by_values(model.identified()))
                                                  : Model(chain, by_values(model.identified()),
                                                          by_values(*model.fallback()), *model.coverage());
    return model.thermal() == nullptr ? out : out.with_thermal(*model.thermal());
  }

  std::string name_;
  JointLimits<N> limits_;
  Provenance provenance_;
  Model model_;
  std::optional<Corrected> corrected_{};
  ControllerMap controller_{};
  JointChange<N> change_{};
  Payload payload_{.mass = std::numeric_limits<double>::quiet_NaN()};  // not finite: that of the model
  std::shared_ptr<const ErrorModelEstimate> estimate_{};               // shared, for it is large and never changes
};

}  // namespace vernier
