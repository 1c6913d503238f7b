#pragma once

/// @file
/// Touches of a virtual arm: joint values at which its tool point lies on an object.

#include <cstdint>
#include <string>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
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

/// How far a point is from an object: one residual, or three of a socket; and their derivatives by the point, rows.
VERNIER_API std::pair<VectorX, MatrixX> distance_from(const VirtualObject& object, const Vector3& point, double known);

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
    require(tries < 2000 * known.size(), "touch: the arm hardly reaches ", name);
    JointVector<N> q;
    for (int j = 0; j < N; ++j) q(j) = rng.uniform(limits.lower(j), limits.upper(j));
    const Vector3 noise = sigma * Vector3(rng.normal(), rng.normal(), rng.normal());
    double left = 1;
    for (int step = 0; step < 12 && left > 1e-13; ++step) {
      const auto at = actual.pose_and_jacobian(q);
      const auto [residual, rows] = detail::distance_from(object, at.pose.translation() + noise, known(i));
      const MatrixX columns = rows * at.jacobian.template topRows<3>();
      MatrixX gram = columns * columns.transpose();
      gram.diagonal().array() += 1e-9 * gram.trace();
      VectorX move = residual;
      detail::solve_general(gram, move);
      q -= columns.transpose() * move;
      left = residual.norm();
    }
    const Vector3 reached = actual.position(q) - object.point;
    const Vector3 along = reached - object.direction.dot(reached) * object.direction;
    if (!(left < 1e-9) || (q.array() < limits.lower.array()).any() || (q.array() > limits.upper.array()).any() ||
        (object.kind == ContactKind::plane && along.norm() > object.extent))
      continue;
    joints.row(i++) = q.transpose();
  }
  return Contact(std::move(name), object.kind, std::move(joints), known);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/touches.ipp"
#endif
