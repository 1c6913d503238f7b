#pragma once

/// @file
/// A fitted error model: all that is known of a real arm, as one kinematic model that is safe outside the data.

#include <optional>
#include <utility>

#include "vernier/data/joint_coverage.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

namespace detail {

/// Interpolates from `far` (gate 0) to `near` (gate 1), the rotation along the geodesic.
VERNIER_API Isometry3 blend_poses(double gate, const Isometry3& near, const Isometry3& far) noexcept;

/// The Jacobian of `blend_poses(gate(q), near(q), far(q))`; `jacobian` holds that of `far` and is overwritten.
/// @param slope gradient of the gate
VERNIER_API void blend_jacobians(double gate, const double* slope, const Isometry3& near, const double* near_jacobian,
                                 const Isometry3& far, Index joints, double* jacobian) noexcept;

}  // namespace detail

/// An arm with geometric and joint errors in identified frames. Transmission terms are functions of joint angles, known
/// where the joints were measured: outside, the model falls back smoothly (by `JointCoverage`) to one fitted without
/// them. It keeps the nominal arm in the same frames, so that commands can be corrected towards it.
template <class C>
class ErrorModel {
 public:
  /// The kind of chain.
  using Chain = C;
  /// Chain, joint errors and frames.
  using Arm = Framed<WithJointErrors<Chain>>;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  /// A model that is valid everywhere.
  ErrorModel(const Chain& nominal, Arm identified)
      : identified_(std::move(identified)), nominal_(identified_.around(nominal)) {}

  /// @param nominal    the chain as designed
  /// @param identified with all terms, for where the joints were measured
  /// @param fallback   without transmission terms, for elsewhere
  /// @param coverage   where the joints were measured
  ErrorModel(const Chain& nominal, Arm identified, Arm fallback, JointCoverage<dof> coverage)
      : identified_(std::move(identified)),
        outside_(Outside{std::move(fallback), std::move(coverage)}),
        nominal_(identified_.around(nominal)) {}

  /// The arm with all terms.
  const Arm& identified() const { return identified_; }
  /// The nominal chain in the identified frames.
  const Framed<Chain>& nominal() const { return nominal_; }
  /// The arm that is valid outside the measured joint ranges; null where `identified` is valid everywhere.
  const Arm* fallback() const { return outside_ ? &outside_->arm : nullptr; }
  /// The measured joint ranges; null where `identified` is valid everywhere.
  const JointCoverage<dof>* coverage() const { return outside_ ? &outside_->coverage : nullptr; }

  /// The same arm in another place, with another tool and other joint zeros; the nominal arm is moved along.
  /// @param base    applied in front: motion of the frame of the measurements
  /// @param offsets added to the joint values [rad, m]
  /// @param tool    applied behind
  ErrorModel moved(const Isometry3& base, const JointVector<dof>& offsets, const Isometry3& tool) const {
    const auto move = [&](const Arm& arm) {
      auto p = arm.chain().parameters();
      for (int i = 0; i < dof; ++i) p(5 * i + (arm.chain().row(i).joint == JointType::revolute ? 3 : 2)) += offsets(i);
      return Arm(WithJointErrors<Chain>(arm.chain().with_parameters(p), arm.model().joint_errors()),
                 Isometry3(base * arm.base()), Isometry3(arm.tool() * tool));
    };
    if (!outside_) return {nominal_.model(), move(identified_)};
    return {nominal_.model(), move(identified_), move(outside_->arm), outside_->coverage};
  }

  /// Share of `identified` in the prediction at q, in [0, 1]; the rest is `fallback`.
  double gate(const JointVector<dof>& q) const noexcept { return outside_ ? outside_->coverage(q) : 1; }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return identified_.pose(q);
    const Isometry3 far = outside_->arm.pose(q);
    return gate == 0 ? far : detail::blend_poses(gate, identified_.pose(q), far);
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return identified_.position(q);
    const Vector3 far = outside_->arm.position(q);
    return gate == 0 ? far : Vector3(far + gate * (identified_.position(q) - far));
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate == 1) return identified_.pose_and_jacobian(q);
    PoseAndJacobian<dof> far = outside_->arm.pose_and_jacobian(q);
    if (gate == 0) return far;
    const PoseAndJacobian<dof> near = identified_.pose_and_jacobian(q);
    const Eigen::Matrix<double, 1, dof> slope = outside_->coverage.derivative(q);
    detail::blend_jacobians(gate, slope.data(), near.pose, near.jacobian.data(), far.pose, dof, far.jacobian.data());
    far.pose = detail::blend_poses(gate, near.pose, far.pose);
    return far;
  }

 private:
  struct Outside {
    Arm arm;
    JointCoverage<dof> coverage;
  };

  Arm identified_;
  std::optional<Outside> outside_{};
  Framed<Chain> nominal_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/error_model.ipp"
#endif
