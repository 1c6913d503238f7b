#pragma once

/// @file
/// An identified arm beside its nominal one, both standing in the identified frames.

#include "vernier/kinematics/framed.hpp"

namespace vernier {

/// The arm as identified; it knows the nominal arm in the same base and tool frames, so that commands can be corrected
/// towards it.
template <KinematicModel Model>
class Calibrated {
 public:
  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// @param actual  the identified chain in the identified frames
  /// @param nominal the chain as designed
  Calibrated(const Framed<Model>& actual, const Model& nominal) : actual_(actual), reference_(actual.around(nominal)) {}

  const Framed<Model>& actual() const { return actual_; }        ///< identified chain and frames
  const Framed<Model>& reference() const { return reference_; }  ///< nominal chain, identified frames

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return actual_.pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return actual_.position(q); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return actual_.jacobian(q); }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return actual_.pose_and_jacobian(q);
  }

 private:
  Framed<Model> actual_, reference_;
};

}  // namespace vernier
