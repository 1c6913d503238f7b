// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An identified arm beside its nominal one, both in the identified frames.

#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

/// The arm as identified. It keeps the nominal arm in the same base and tool frames, so that commands can be corrected
/// towards it.
template <KinematicModel Model>
class Calibrated : public ChecksJoints<Calibrated<Model>> {
  using Checks = ChecksJoints<Calibrated>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// @param identified the identified chain in the identified frames
  /// @param nominal    the chain as designed
  Calibrated(const Framed<Model>& identified, const Model& nominal)
      : identified_(identified), nominal_(identified.around(nominal)) {}

  const Framed<Model>& identified() const { return identified_; }  ///< identified chain and frames
  const Framed<Model>& nominal() const { return nominal_; }        ///< nominal chain, identified frames

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

 private:
  Framed<Model> identified_, nominal_;
};

}  // namespace vernier
