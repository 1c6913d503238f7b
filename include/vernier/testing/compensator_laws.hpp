// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What every `Compensator` must do beyond having the right member functions, as a list of violations.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing {

/// How closely the laws are held.
struct CompensatorLawOptions {
  double position_tolerance = 1e-6;  ///< of a converged correction: what `predict(command)` may miss the target by [m]
  double rotation_tolerance =
      1e-6;  ///< likewise [rad]; infinity for a compensator that leaves orientation to fall as it may
  static constexpr double value_tolerance =
      1e-12;  ///< two ways to the same value [m], and of rotations being orthonormal
};

namespace detail {

/// The worst offence against one law of compensators over all samples.
class CompensatorLaw {
 public:
  CompensatorLaw(std::string text, double tolerance) : text_(std::move(text)), tolerance_(tolerance) {}

  /// Notes by how much the law is missed at a sample; what is not a number misses it entirely.
  void miss(double by, Index sample) {
    if (std::isnan(by)) by = std::numeric_limits<double>::infinity();
    if (by <= worst_) return;
    worst_ = by;
    sample_ = sample;
  }

  void report(std::vector<std::string>& violations) const {
    if (worst_ > tolerance_)
      violations.push_back(
          message(text_, ": missed by ", worst_, " at sample ", sample_, "; the tolerance is ", tolerance_));
  }

 private:
  std::string text_;
  double tolerance_;
  double worst_ = 0;
  Index sample_ = 0;
};

/// The laws that need no reference.
template <Compensator C>
void check_compensator(const C& compensator, const JointRows<C::dof>& samples, const CompensatorLawOptions& options,
                       std::vector<std::string>& violations) {
  demand(samples.rows() >= 1, "compensator_violations: there are no samples");
  CompensatorLaw repeatable("a repeated call gives the same bits", 0);
  CompensatorLaw rigid("predict(q) is a rigid motion", options.value_tolerance);
  CompensatorLaw finite("correct(q) is finite, its predicted_error not negative, its gate within [0, 1]", 0);
  for (Index s = 0; s < samples.rows(); ++s) {
    const JointVector<C::dof> q = configuration(samples, s);
    const Isometry3 pose = compensator.predict(q);
    const Matrix3 rotation = vernier::rotation(pose), back = rotation.transpose(), product = back * rotation;
    const Matrix3 identity = Matrix3::Identity(), skewed = product - identity;
    rigid.miss(skewed.norm(), s);
    rigid.miss(std::abs(rotation.determinant() - 1), s);
    rigid.miss(std::hypot(std::hypot(pose(3, 0), pose(3, 1), pose(3, 2)), pose(3, 3) - 1), s);
    const Vector3 position = translation(pose);
    rigid.miss(vernier::detail::all_finite(position) ? 0 : std::numeric_limits<double>::infinity(), s);

    const Correction<C::dof> once = compensator.correct(q), again = compensator.correct(q);
    const VectorX numbers{{once.predicted_error, once.gate}}, numbers_again{{again.predicted_error, again.gate}};
    const bool same = same_bits(pose.matrix(), compensator.predict(q).matrix()) &&
                      same_bits(once.command, again.command) && same_bits(numbers, numbers_again) &&
                      once.status == again.status;
    repeatable.miss(same ? 0 : 1, s);
    const bool sane = vernier::detail::all_finite(once.command) && vernier::detail::all_finite(numbers) &&
                      once.predicted_error >= 0 && once.gate >= 0 && once.gate <= 1;
    finite.miss(sane ? 0 : 1, s);
  }
  for (const CompensatorLaw* law : {&repeatable, &rigid, &finite}) law->report(violations);
}

}  // namespace detail

/// Checks that a compensator obeys the laws of `Compensator` towards a reference at each row of `samples`: repeated
/// calls give the same bits, `predict(q)` is a rigid motion, corrections are finite, `predicted_error` is the distance
/// of `predict(command)` from the reference, and a correction that says converged brings `predict(command)` to the
/// reference's pose.
/// @param compensator the compensator
/// @param reference   the arm as it should be, in the same frames
/// @param samples     target joints, n x dof, n >= 1
/// @param options     tolerances
/// @return            one sentence per law that is broken, naming the worst sample; empty when all hold
/// @throws std::invalid_argument without samples
template <Compensator C, KinematicModel Reference>
std::vector<std::string> compensator_violations(const C& compensator, const Reference& reference,
                                                const JointRows<C::dof>& samples,
                                                const CompensatorLawOptions& options = {}) {
  std::vector<std::string> violations;
  detail::check_compensator(compensator, samples, options, violations);
  detail::CompensatorLaw predicted("predicted_error is the distance of predict(command) from the reference",
                                   options.value_tolerance);
  detail::CompensatorLaw position("a converged command has its predicted position at the reference's",
                                  options.position_tolerance);
  detail::CompensatorLaw rotation("a converged command has its predicted orientation at the reference's",
                                  options.rotation_tolerance);
  for (Index s = 0; s < samples.rows(); ++s) {
    const JointVector<C::dof> q = configuration(samples, s);
    const Correction<C::dof> correction = compensator.correct(q);
    const Vector6 left = pose_difference(reference.pose(q), compensator.predict(correction.command));
    const Vector3 shift = left.template head<3>(), turn = left.template tail<3>();
    predicted.miss(std::abs(shift.norm() - correction.predicted_error), s);
    if (correction.status != IkStatus::converged) continue;
    position.miss(shift.norm(), s);
    rotation.miss(turn.norm(), s);
  }
  for (const detail::CompensatorLaw* law : {&predicted, &position, &rotation}) law->report(violations);
  return violations;
}

/// Holds a compensator to the laws, with its own reference; without one, to the laws that need none.
/// @param compensator the compensator; `compensator.nominal()` is the arm as it should be
/// @param samples     target joints, n x dof, n >= 1
/// @param options     tolerances
/// @return            one sentence per law that is broken; empty when all hold
/// @throws std::invalid_argument without samples
template <Compensator C>
std::vector<std::string> compensator_violations(const C& compensator, const JointRows<C::dof>& samples,
                                                const CompensatorLawOptions& options = {}) {
  if constexpr (requires { compensator.nominal(); }) {
    return compensator_violations(compensator, compensator.nominal(), samples, options);
  } else {
    std::vector<std::string> violations;
    detail::check_compensator(compensator, samples, options, violations);
    return violations;
  }
}

}  // namespace vernier::testing
