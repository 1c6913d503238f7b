// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Joint-space compensation: learn the joint error over the joints, on top of any model.

#include "vernier/compensation/compensated.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/joint_coverage.hpp"
#include "vernier/regression/detail/explain_regressor.hpp"

namespace vernier {

/// A model whose joints are displaced by a learned amount: `pose(q) = model.pose(q + gate(q) f(q))`.
template <KinematicModel Model, Predictor Learned>
class JointCorrected : public ChecksJoints<JointCorrected<Model, Learned>> {
  static_assert(Learned::inputs == Model::dof && Learned::outputs == Model::dof);
  using Checks = ChecksJoints<JointCorrected>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// Joins the parts.
  JointCorrected(const Model& model, const Learned& learned, const JointCoverage<dof>& gate)
      : model_(model), learned_(learned), gate_(gate) {}

  /// The model that is corrected.
  const Model& model() const { return model_; }
  /// The fitted predictor.
  const Learned& learned() const { return learned_; }
  /// Share of the learned correction that is used at q, in [0, 1].
  double gate(const JointVector<dof>& q) const noexcept { return gate_(q); }

  /// The joints at which the model has the pose of the arm.
  JointVector<dof> effective(const JointVector<dof>& q) const noexcept { return q + gate_(q) * learned_.predict(q); }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return model_.pose(effective(q)); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return model_.position(effective(q)); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    PoseAndJacobian<dof> out = model_.pose_and_jacobian(effective(q));
    Eigen::Matrix<double, dof, dof> rate =
        gate_(q) * learned_.derivative(q) + learned_.predict(q) * gate_.derivative(q);
    rate.diagonal().array() += 1;
    out.jacobian = (out.jacobian * rate).eval();
    return out;
  }

 private:
  Model model_;
  Learned learned_;
  JointCoverage<dof> gate_;
};

/// The paper's joint-space command: `theta - f(theta)`, f learned from labels indexed by the *target* joints.
template <KinematicModel Model, Predictor Learned>
class DirectJointCompensator : public ChecksJoints<DirectJointCompensator<Model, Learned>> {
  using Checks = ChecksJoints<DirectJointCompensator>;

 public:
  using Checks::correct;
  using Checks::predict;

  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// Joins the parts.
  DirectJointCompensator(const Model& model, const Learned& learned, const JointCoverage<dof>& gate)
      : corrected_(model, learned, gate) {}

  /// The fitted predictor.
  const Learned& learned() const { return corrected_.learned(); }

  /// The pose the arm takes when commanded q, to first order in the joint error.
  Isometry3 predict(const JointVector<dof>& q) const noexcept { return corrected_.pose(q); }
  /// The command `q - f(q)`.
  [[nodiscard]] Correction<dof> correct(const JointVector<dof>& q) const noexcept {
    const double gate = corrected_.gate(q);
    const JointVector<dof> command = q - gate * corrected_.learned().predict(q);
    return {command, IkStatus::converged, (predict(command).translation() - corrected_.model().position(q)).norm(),
            gate};
  }

 private:
  JointCorrected<Model, Learned> corrected_;
};

/// Joint rows and the joint errors that belong to them; poses whose inverse kinematics failed are left out.
template <int N>
struct JointErrorLabels {
  JointRows<N> joints;  ///< n x N
  JointRows<N> errors;  ///< n x N [rad, m]
  Index failed = 0;     ///< poses left out: no joints near by reach them
};

namespace detail {

/// Joint differences between `from` and the joints at which `solver` reaches each target from there.
template <KinematicModel Solver, class Target>
JointErrorLabels<Solver::dof> joint_errors(const Solver& solver, const JointRows<Solver::dof>& from, Target&& target,
                                           double sign) {
  JointErrorLabels<Solver::dof> out;
  out.joints.resize(from.rows(), Solver::dof);
  out.errors.resize(from.rows(), Solver::dof);
  Index kept = 0;
  for (Index i = 0; i < from.rows(); ++i) {
    const JointVector<Solver::dof> q = configuration(from, i);
    const auto found = inverse_kinematics(solver, Isometry3(target(i)), q);
    if (found.status != IkStatus::converged) continue;
    set_configuration(out.joints, kept, q);
    set_configuration<Solver::dof>(out.errors, kept++, sign * (found.joints - q));
  }
  out.failed = from.rows() - kept;
  out.joints.conservativeResize(kept, Solver::dof);
  out.errors.conservativeResize(kept, Solver::dof);
  return out;
}

}  // namespace detail

/// The paper's labels: `theta_R` solves `actual(theta_R) = nominal(theta_N)`, label `theta_N - theta_R` at `theta_N`.
/// Needs the actual arm as a model, so a simulation. Near singularities inverse kinematics jumps and labels explode.
/// @param nominal the arm as designed
/// @param actual  the arm as it is
/// @param joints  n x N target joints theta_N
template <KinematicModel Nominal, KinematicModel Actual>
JointErrorLabels<Nominal::dof> joint_error_labels(const Nominal& nominal, const Actual& actual,
                                                  const JointRows<Nominal::dof>& joints) {
  return detail::joint_errors(
      actual, joints, [&](Index i) { return nominal.pose(joints.row(i).transpose()); }, -1);
}

/// Labels from measured full poses: `theta_N` solves `model(theta_N) = measured`, label `theta_N - q` at the commanded
/// q.
/// @throws std::invalid_argument where the data have positions only
template <KinematicModel Model>
JointErrorLabels<Model::dof> joint_error_labels(const Model& model, const Dataset<Model::dof>& data) {
  demand(data.has_orientations(),
         "joint_error_labels: joint-space compensation needs measured orientations, the data have positions only");
  return detail::joint_errors(
      model, data.joints(), [&](Index i) { return data.pose(i); }, +1);
}

/// Learns joint errors over the joints, with any regressor, on any model.
/// @cite Feng, Dong, Jin
/// @tparam R a `Regressor`
template <class R>
struct JointCompensation {
  static_assert(detail::explain_regressor<R>());

  /// Learner of the joint errors.
  R regressor;
  /// How commands are corrected.
  CorrectionOptions correction{};

  /// From measured full poses: the result is a kinematic model, corrected like any other.
  /// @throws std::invalid_argument for positions alone, where nothing could be labelled, or for data in other frames
  /// (50 mm)
  template <KinematicModel Model>
  Compensated<JointCorrected<Model, PredictorOf<R, Model::dof, Model::dof>>, NominalOf<Model>> fit(
      const Model& model, const Dataset<Model::dof>& data, const FitOptions& options = {}) const {
    demand(data.size() >= 1, "JointCompensation: no samples");
    detail::require_same_frames("JointCompensation", positions(model, data.joints()) - data.positions());
    const auto labels = joint_error_labels(model, data);
    demand(labels.joints.rows() >= 1, "JointCompensation: inverse kinematics failed for all ", data.size(), " poses");
    return {{model, regressor.fit(labels.joints, labels.errors, options),
             JointCoverage<Model::dof>::covering(labels.joints)},
            nominal_of(model),
            correction};
  }

  /// From the paper's labels, indexed by the target joints: the command is `theta - f(theta)`.
  template <KinematicModel Model>
  DirectJointCompensator<Model, PredictorOf<R, Model::dof, Model::dof>> fit(const Model& model,
                                                                            const JointErrorLabels<Model::dof>& labels,
                                                                            const FitOptions& options = {}) const {
    demand(labels.joints.rows() >= 1, "JointCompensation: no labels");
    return {model, regressor.fit(labels.joints, labels.errors, options),
            JointCoverage<Model::dof>::covering(labels.joints)};
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class R>
JointCompensation(R) -> JointCompensation<R>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R>
JointCompensation(R, CorrectionOptions) -> JointCompensation<R>;

}  // namespace vernier
