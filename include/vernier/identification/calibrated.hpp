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
  static constexpr int dof = Model::dof;

  /// @param actual  the identified chain in the identified frames
  /// @param nominal the chain as designed
  Calibrated(const Framed<Model>& actual, const Model& nominal) : actual_(actual), reference_(actual.around(nominal)) {}

  const Framed<Model>& actual() const { return actual_; }        ///< identified chain and frames
  const Framed<Model>& reference() const { return reference_; }  ///< nominal chain, identified frames

  Isometry3 pose(const JointVector<dof>& q) const noexcept { return actual_.pose(q); }
  Vector3 position(const JointVector<dof>& q) const noexcept { return actual_.position(q); }
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return actual_.jacobian(q); }
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return actual_.pose_and_jacobian(q);
  }

 private:
  Framed<Model> actual_, reference_;
};

}  // namespace vernier
