// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Command correction on any model: inverse kinematics on the best model of the arm, started from the nominal joints.

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/concepts.hpp"

namespace vernier {

/// The arm as identified beside the nominal one. A kinematic model itself: that of the identified arm.
/// @tparam Arm     the best model of the real arm; a learned one has a `gate(q)`
/// @tparam Nominal the nominal arm, in the same base and tool frames
template <KinematicModel Arm, KinematicModel Nominal>
class Compensated : public ChecksJoints<Compensated<Arm, Nominal>> {
  static_assert(Arm::dof == Nominal::dof);
  using Checks = ChecksJoints<Compensated>;

 public:
  using Checks::correct;
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;
  using Checks::predict;

  /// Number of joints.
  static constexpr int dof = Arm::dof;

  /// Joins the parts; throws `std::invalid_argument` on an unusable option.
  Compensated(const Arm& identified, const Nominal& nominal, const CorrectionOptions& options = {})
      : identified_(identified), nominal_(nominal), options_(options) {
    options.validate(dof);
  }

  /// The best model of the arm.
  const Arm& identified() const { return identified_; }
  /// The nominal arm in the same frames.
  const Nominal& nominal() const { return nominal_; }
  /// How commands are corrected.
  const CorrectionOptions& options() const { return options_; }

  /// This arm with commands kept within joint limits.
  Compensated within(const JointLimits<dof>& limits) const {
    Compensated out = *this;
    out.limits_ = limits;
    return out;
  }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return identified_.pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return identified_.position(q); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return identified_.jacobian(q); }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return identified_.pose_and_jacobian(q);
  }

  /// The pose the arm takes when commanded q.
  Isometry3 predict(const JointVector<dof>& q) const noexcept { return pose(q); }

  /// The command that brings the arm to the pose of the nominal one at q. Stays on the branch of q; the best iterate is
  /// kept.
  [[nodiscard]] Correction<dof> correct(const JointVector<dof>& q) const noexcept {
    return correct(nominal_.pose(q), q);
  }

  /// The command that brings the arm to a pose.
  /// @param target base_T_tool in the frames of the model
  /// @param seed   joints near the solution; they choose the branch
  [[nodiscard]] Correction<dof> correct(const Isometry3& target, const JointVector<dof>& seed) const noexcept {
    IkOptions<dof> options;
    options.limits = limits_;
    options.position_tolerance = options_.position_tolerance;
    options.rotation_tolerance = options_.rotation_tolerance;
    options.max_iterations = options_.max_iterations;
    options.moving_joints = options_.moving_joints == 0 ? dof : options_.moving_joints;
    const bool full =
        options_.target == CorrectionTarget::pose || (options_.target == CorrectionTarget::automatic && dof >= 6);
    const IkResult<dof> found = detail::inverse_kinematics(identified_, target, full, seed, options);
    Correction<dof> out{found.joints, found.status, found.position_error, 1};
    if constexpr (requires { identified_.gate(found.joints); }) out.gate = identified_.gate(found.joints);
    return out;
  }

 private:
  Arm identified_;
  Nominal nominal_;
  CorrectionOptions options_;
  JointLimits<dof> limits_{};
};

/// Corrects commands on a model that keeps its nominal arm, e.g. an identified one.
template <KinematicModel Model>
Compensated<Model, NominalOf<Model>> compensate(const Model& model, const CorrectionOptions& options = {}) {
  return {model, nominal_of(model), options};
}

}  // namespace vernier
