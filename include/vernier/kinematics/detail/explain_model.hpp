// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a type lacks to be a `KinematicModel`, in one sentence for each requirement.

#include <concepts>

#include "vernier/kinematics/concepts.hpp"

namespace vernier::detail {

/// Does not compile for a type that is no `KinematicModel`: each failed assertion names one requirement. The last one
/// is for requirements that have no sentence.
template <class M>
constexpr bool explain_kinematic_model() {
  if constexpr (!requires { requires M::dof >= 1; }) {
    static_assert(
        requires { requires M::dof >= 1; },
        "KinematicModel: the model needs `static constexpr int dof`, its number of joints, at least 1");
  } else if constexpr (!KinematicModel<M>) {
    using Q = JointVector<M::dof>;
    static_assert(
        requires(const M& model, const Q& q) {
          { model.pose(q) }
          noexcept->std::same_as<Isometry3>;
        },
        "KinematicModel: `pose(q)` must be const and noexcept and return vernier::Isometry3");
    static_assert(
        requires(const M& model, const Q& q) {
          { model.position(q) }
          noexcept->std::same_as<Vector3>;
        },
        "KinematicModel: `position(q)` must be const and noexcept and return vernier::Vector3");
    static_assert(
        requires(const M& model, const Q& q) {
          { model.jacobian(q) }
          noexcept->std::same_as<Jacobian<M::dof>>;
        },
        "KinematicModel: `jacobian(q)` must be const and noexcept and return vernier::Jacobian<dof>");
    static_assert(
        requires(const M& model, const Q& q) {
          { model.pose_and_jacobian(q) }
          noexcept->std::same_as<PoseAndJacobian<M::dof>>;
        },
        "KinematicModel: `pose_and_jacobian(q)` must be const and noexcept and return vernier::PoseAndJacobian<dof>");
    static_assert(KinematicModel<M>, "KinematicModel: the type does not satisfy the concept");
  }
  return true;
}

}  // namespace vernier::detail
