#pragma once

/// @file
/// A fitted error model: everything known of a real arm, as one kinematic model that is safe outside the data.

#include <optional>
#include <utility>

#include "vernier/core/so3.hpp"
#include "vernier/data/joint_coverage.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

/// An arm with geometric and joint errors, standing in identified frames. Transmission terms are functions of joint
/// angles, known where the joints were measured: outside, the model falls back smoothly (by `JointCoverage`) to one
/// fitted without them. It knows the nominal arm in the same frames, so that commands can be corrected towards it.
template <class C>
class ErrorModel {
 public:
  /// The kind of chain.
  using Chain = C;
  /// Chain, joint errors and frames.
  using Arm = Framed<WithJointErrors<Chain>>;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  /// A model that holds everywhere.
  ErrorModel(const Chain& nominal, Arm arm) : arm_(std::move(arm)), reference_(arm_.around(nominal)) {}

  /// @param nominal  the chain as designed
  /// @param arm      with all terms, for where the joints were measured
  /// @param fallback without transmission terms, for elsewhere
  /// @param coverage where the joints were measured
  ErrorModel(const Chain& nominal, Arm arm, Arm fallback, JointCoverage<dof> coverage)
      : arm_(std::move(arm)),
        outside_(Outside{std::move(fallback), std::move(coverage)}),
        reference_(arm_.around(nominal)) {}

  /// The arm with all terms.
  const Arm& arm() const { return arm_; }
  /// The arm that holds outside the measured joint ranges; null where `arm` holds everywhere.
  const Arm* fallback() const { return outside_ ? &outside_->arm : nullptr; }
  /// The measured joint ranges; null where `arm` holds everywhere.
  const JointCoverage<dof>* coverage() const { return outside_ ? &outside_->coverage : nullptr; }
  /// The nominal chain in the identified frames.
  const Framed<Chain>& reference() const { return reference_; }
  /// The same arm standing elsewhere, holding something else, with other joint zeros; the nominal arm stands there too.
  /// @param base    applied in front: where the frame of the measurements went
  /// @param offsets added to the joint values [rad, m]
  /// @param tool    applied behind
  [[gnu::noinline]] ErrorModel moved(const Isometry3& base, const JointVector<dof>& offsets,
                                     const Isometry3& tool) const {
    const auto move = [&](const Arm& arm) {
      auto p = arm.model().chain().parameters();
      for (int i = 0; i < dof; ++i) p(5 * i + (nominal().row(i).joint == JointType::revolute ? 3 : 2)) += offsets(i);
      return Arm(WithJointErrors<Chain>(arm.model().chain().with_parameters(p), arm.model().joint_errors()),
                 Isometry3(base * arm.base()), Isometry3(arm.tool() * tool));
    };
    if (!outside_) return {nominal(), move(arm_)};
    return {nominal(), move(arm_), move(outside_->arm), outside_->coverage};
  }

  /// The chain as designed.
  const Chain& nominal() const { return reference_.model(); }
  /// Share of `arm` in the answer at q, in [0, 1]; the rest is `fallback`.
  double gate(const JointVector<dof>& q) const noexcept { return outside_ ? outside_->coverage(q) : 1; }

  /// base_T_tool.
  [[gnu::noinline]] Isometry3 pose(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return arm_.pose(q);
    const Isometry3 far = outside_->arm.pose(q);
    return gate == 0 ? far : blend(gate, arm_.pose(q), far);
  }
  /// Tool position [m], base frame.
  [[gnu::noinline]] Vector3 position(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return arm_.position(q);
    const Vector3 far = outside_->arm.position(q);
    return gate == 0 ? far : Vector3(far + gate * (arm_.position(q) - far));
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  [[gnu::noinline]] PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return arm_.pose_and_jacobian(q);
    const PoseAndJacobian<dof> far = outside_->arm.pose_and_jacobian(q);
    if (gate == 0) return far;
    const PoseAndJacobian<dof> near = arm_.pose_and_jacobian(q);
    const Eigen::Matrix<double, 1, dof> slope = outside_->coverage.derivative(q);
    PoseAndJacobian<dof> out{blend(gate, near.pose, far.pose), far.jacobian};
    out.jacobian.template topRows<3>() += gate * (near.jacobian - far.jacobian).template topRows<3>() +
                                          (near.pose.translation() - far.pose.translation()) * slope;
    // R = Exp(gate * phi) R_far with Exp(phi) = R_near R_far'
    const Matrix3 between = near.pose.linear() * far.pose.linear().transpose();
    const Vector3 phi = log_so3(between);
    const Eigen::Matrix<double, 3, dof> omega_far = far.jacobian.template bottomRows<3>();
    const Eigen::Matrix<double, 3, dof> phi_rate =
        left_jacobian_inverse_so3(phi) * (near.jacobian.template bottomRows<3>() - between * omega_far);
    out.jacobian.template bottomRows<3>() = left_jacobian_so3(Vector3(gate * phi)) * (gate * phi_rate + phi * slope) +
                                            exp_so3(Vector3(gate * phi)) * omega_far;
    return out;
  }

 private:
  struct Outside {
    Arm arm;
    JointCoverage<dof> coverage;
  };

  static Isometry3 blend(double gate, const Isometry3& near, const Isometry3& far) noexcept {
    Isometry3 out = far;
    out.translation() += gate * (near.translation() - far.translation());
    out.linear() = exp_so3(Vector3(gate * log_so3(near.linear() * far.linear().transpose()))) * far.linear();
    return out;
  }

  Arm arm_;
  std::optional<Outside> outside_{};
  Framed<Chain> reference_;
};

}  // namespace vernier
