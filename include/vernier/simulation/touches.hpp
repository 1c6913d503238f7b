// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Touches of a virtual arm: joint values at which its tool point lies on an object.

#include <cstdint>
#include <string>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/data/contacts.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier {

/// An object in the base frame of an arm.
struct VirtualObject {
  ContactKind kind = ContactKind::plane;  ///< what it is
  Vector3 point = Vector3::Zero();        ///< of the first face, centre of a ball, first socket [m]
  Vector3 direction = Vector3::UnitZ();   ///< normal of faces, direction of a bar; a unit vector
  double extent = 0.15;                   ///< of a face: touches lie within this distance from `point` along it [m]
};

namespace detail {

/// A step of Newton's method towards an object.
struct TouchStep {
  VectorX step;  ///< to be subtracted from the joint values
  double left;   ///< distance of the point before it [m]
};
/// The step of the joints that brings a point closer to the surface of an object.
/// @param jacobian of the point by the joints: its first three rows
VERNIER_API TouchStep step_towards(const VirtualObject& object, const Vector3& point, double known,
                                   const ConstMatrixRef& jacobian);

}  // namespace detail

/// Touches of an object by an arm, found by Newton's method from sampled joint values, within limits.
/// @param actual the arm
/// @param object what is touched
/// @param name   of the contact
/// @param known  known length of each touch, see `Contact`; its size is the number of touches
/// @param limits of the joints
/// @param sigma  standard deviation of the touches, per component [m]
/// @param seed   same seed, same touches
/// @throws std::invalid_argument where the arm hardly reaches the object
template <KinematicModel Actual>
Contact touch(const Actual& actual, const VirtualObject& object, std::string name, const VectorX& known,
              const JointLimits<Actual::dof>& limits, double sigma, std::uint64_t seed) {
  constexpr int N = Actual::dof;
  Rng rng(seed);
  MatrixX joints(known.size(), N);
  for (Index i = 0, tries = 0; i < known.size(); ++tries) {
    demand(tries < 2000 * known.size(), "touch: the arm hardly reaches ", name);
    JointVector<N> q;
    for (int j = 0; j < N; ++j) q(j) = rng.uniform(limits.lower(j), limits.upper(j));
    const Vector3 noise = sigma * Vector3(rng.normal(), rng.normal(), rng.normal());
    double left = 1;
    for (int step = 0; step < 12 && left > 1e-13; ++step) {
      const auto at = actual.pose_and_jacobian(q);
      const auto [change, before] = detail::step_towards(object, translation(at.pose) + noise, known(i), at.jacobian);
      for (int j = 0; j < N; ++j) q(j) -= change(j);
      left = before;
    }
    const Vector3 reached = actual.position(q) - object.point;
    const Vector3 across = object.direction.dot(reached) * object.direction, along = reached - across;
    bool valid = left < 1e-9 && (object.kind != ContactKind::plane || along.norm() <= object.extent);
    for (int j = 0; j < N; ++j) valid = valid && q(j) >= limits.lower(j) && q(j) <= limits.upper(j);
    if (!valid) continue;
    for (int j = 0; j < N; ++j) joints(i, j) = q(j);
    ++i;
  }
  return Contact(std::move(name), object.kind, std::move(joints), known);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/touches.ipp"
#endif
