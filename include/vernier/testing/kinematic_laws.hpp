// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a kinematic model must do beyond having the right member functions: laws, checked at sample configurations.
/// They return a list of violations in words, so any test framework, or none, will do.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/concepts.hpp"

/// Law suites for the library's own types and for users' types.
namespace vernier::testing {

/// How closely the laws are held. Differences are measured per entry, relative to the entry where that exceeds 1.
struct KinematicLawOptions {
  static constexpr double value_tolerance = 1e-12;       ///< two ways to the same value [m, or as a ratio]
  double derivative_tolerance = 1e-8;                    ///< a derivative and its central difference
  static constexpr double difference_step = 1e-5;        ///< of the central differences [rad, m]
  static constexpr double parameter_perturbation = 0.1;  ///< how far from its own parameters a model is tried [rad, m]
};

namespace detail {

/// The worst offence against one law over all samples; one sentence when it exceeds the tolerance.
class Law {
 public:
  Law(std::string text, double tolerance) : text_(std::move(text)), tolerance_(tolerance) {}

  /// Compares entry by entry; a value that is not finite is an infinite difference.
  template <class A, class B>
  void compare(const A& a, const B& b, Index sample) {
    for (Index j = 0; j < a.cols(); ++j)
      for (Index i = 0; i < a.rows(); ++i) compare_entry(a(i, j), b(i, j), i, j, sample);
  }

  /// Compares one entry.
  void compare_entry(double a, double b, Index row, Index column, Index sample) {
    double difference = std::abs(a - b) / (std::max)(1.0, std::abs(b));
    if (!std::isfinite(difference)) difference = std::numeric_limits<double>::infinity();
    if (difference <= worst_) return;
    worst_ = difference;
    where_ = message("row ", row, ", column ", column, " at sample ", sample);
  }

  /// Compares a row, entry by entry, with numbers.
  template <class A>
  void compare_row(const A& a, Index row, const double* b, Index sample) {
    for (Index j = 0; j < a.cols(); ++j) compare_entry(a(row, j), b[j], row, j, sample);
  }

  /// Compares the stored numbers bit by bit.
  template <class A>
  void same_bits(const A& a, const A& b, Index sample) {
    if (std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0) return;
    compare(a, b, sample);
    if (worst_ <= tolerance_) {  // a zero's sign, or a NaN's payload
      worst_ = (std::numeric_limits<double>::min)();
      where_ = message("at sample ", sample);
    }
  }

  void report(std::vector<std::string>& violations) const {
    if (worst_ > tolerance_)
      violations.push_back(message(text_, ": differs by ", worst_, ", ", where_, "; the tolerance is ", tolerance_));
  }

 private:
  std::string text_;
  double tolerance_;
  double worst_ = 0;
  std::string where_;
};

/// Rate of change from one pose to another, `step` apart: the twist at the tool point, in the base frame.
inline Vector6 difference_quotient(const Isometry3& after, const Isometry3& before, double step) {
  return pose_difference(after, before) / step;
}

}  // namespace detail

/// Checks that a model obeys the laws of `KinematicModel` at each row of `samples`:
/// position is the pose's translation, the rotation is orthonormal and right-handed, `jacobian` and `pose` are those of
/// `pose_and_jacobian`, the Jacobian is the central difference of the pose, a repeated call gives the same bits, and
/// all samples at once (`positions`, `poses`, `poses_and_jacobians`) give what each gives.
/// @param model   the model
/// @param samples joint configurations, n x dof, n >= 1; a step of the central difference away from any kink
/// @param options tolerances
/// @return        one sentence per law that is broken, naming the worst entry; empty when all hold
/// @throws std::invalid_argument without samples
template <KinematicModel M>
std::vector<std::string> kinematic_model_violations(const M& model, const JointRows<M::dof>& samples,
                                                    const KinematicLawOptions& options = {}) {
  demand(samples.rows() >= 1, "kinematic_model_violations: there are no samples");
  detail::Law translation("position(q) is the translation of pose(q)", options.value_tolerance);
  detail::Law orthonormal("the rotation of pose(q) is orthonormal and right-handed", options.value_tolerance);
  detail::Law same_pose("pose(q) is the pose of pose_and_jacobian(q)", options.value_tolerance);
  detail::Law same_jacobian("jacobian(q) is the jacobian of pose_and_jacobian(q)", options.value_tolerance);
  detail::Law derivative("jacobian(q) is the central difference of pose(q)", options.derivative_tolerance);
  detail::Law repeatable("a repeated call gives the same bits", 0);
  detail::Law blocks("many configurations at once give what each gives", options.value_tolerance);

  const PointRows points = positions(model, samples);
  const std::vector<Isometry3> all = poses(model, samples);
  const auto derivatives = poses_and_jacobians(model, samples);
  for (Index s = 0; s < samples.rows(); ++s) {
    const JointVector<M::dof> q = configuration(samples, s);
    const Isometry3 pose = model.pose(q);
    const Vector3 position = model.position(q);
    const Jacobian<M::dof> jacobian = model.jacobian(q);
    const PoseAndJacobian<M::dof> both = model.pose_and_jacobian(q);
    const Matrix3 rotation = vernier::rotation(pose), back = rotation.transpose();

    translation.compare(position, vernier::translation(pose), s);
    orthonormal.compare(Matrix3(back * rotation), Matrix3(Matrix3::Identity()), s);
    orthonormal.compare_entry(rotation.determinant(), 1, 0, 0, s);
    for (Index j = 0; j < 4; ++j) orthonormal.compare_entry(pose(3, j), j == 3 ? 1 : 0, 3, j, s);
    same_pose.compare(pose.matrix(), both.pose.matrix(), s);
    same_jacobian.compare(jacobian, both.jacobian, s);

    Jacobian<M::dof> difference;
    for (int k = 0; k < M::dof; ++k) {
      JointVector<M::dof> after = q, before = q;
      after(k) += options.difference_step;
      before(k) -= options.difference_step;
      const Vector6 column = detail::difference_quotient(model.pose(after), model.pose(before), after(k) - before(k));
      for (Index r = 0; r < 6; ++r) difference(r, k) = column(r);
    }
    derivative.compare(jacobian, difference, s);

    repeatable.same_bits(pose.matrix(), model.pose(q).matrix(), s);
    repeatable.same_bits(position, model.position(q), s);
    repeatable.same_bits(jacobian, model.jacobian(q), s);
    const PoseAndJacobian<M::dof> again = model.pose_and_jacobian(q);
    repeatable.same_bits(both.pose.matrix(), again.pose.matrix(), s);
    repeatable.same_bits(both.jacobian, again.jacobian, s);

    blocks.compare_row(points, s, position.data(), s);
    blocks.compare(all[static_cast<std::size_t>(s)].matrix(), pose.matrix(), s);
    blocks.compare(derivatives.poses[static_cast<std::size_t>(s)].matrix(), pose.matrix(), s);
    blocks.compare_row(derivatives.jacobians, s, jacobian.data(), s);
  }

  std::vector<std::string> violations;
  for (const detail::Law* law :
       {&translation, &orthonormal, &same_pose, &same_jacobian, &derivative, &repeatable, &blocks})
    law->report(violations);
  return violations;
}

/// Checks that a model obeys what `ParametricModel` adds to `KinematicModel`:
/// parameters survive `with_parameters` bit for bit, names and kinds have one entry per parameter and no name is given
/// twice, `pose(q, p)` equals `with_parameters(p).pose(q)`, `with_parameters(parameters())` is the same model, and
/// `parameter_jacobian` is the central difference of the pose, of all samples at once too; at the model's own
/// parameters and away from them.
/// @param model   the model
/// @param samples joint configurations, n x dof, n >= 1
/// @param options tolerances
/// @return        one sentence per law that is broken; empty when all hold
/// @throws std::invalid_argument without samples
template <ParametricModel M>
std::vector<std::string> parametric_model_violations(const M& model, const JointRows<M::dof>& samples,
                                                     const KinematicLawOptions& options = {}) {
  demand(samples.rows() >= 1, "parametric_model_violations: there are no samples");
  constexpr int P = M::num_parameters;
  using Parameters = Eigen::Matrix<double, P, 1>;
  std::vector<std::string> violations;

  const std::vector<std::string> names = M::parameter_names();
  if (names.size() != P)
    violations.push_back(message("parameter_names() has ", names.size(), " entries for ", P, " parameters"));
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) violations.push_back(message("parameter_names() has '", name, "' twice"));
  if (M::parameter_kinds().size() != P)
    violations.push_back(
        message("parameter_kinds() has ", M::parameter_kinds().size(), " entries for ", P, " parameters"));

  detail::Law round_trip("with_parameters(p).parameters() is p bit for bit", 0);
  detail::Law same_model("with_parameters(parameters()) is the same model", options.value_tolerance);
  detail::Law same_pose("pose(q, p) is with_parameters(p).pose(q)", options.value_tolerance);
  detail::Law derivative("parameter_jacobian(q) is the central difference over parameters",
                         options.derivative_tolerance);

  const Parameters own = model.parameters();
  Parameters away = own;  // incommensurate steps, so that no two parameters move alike
  for (int k = 0; k < P; ++k) away(k) += options.parameter_perturbation * std::sin(1.0 + 2.4 * k);

  for (const Parameters& p : {own, away}) {
    const M moved = model.with_parameters(p);
    round_trip.same_bits(moved.parameters(), p, 0);
    const auto all = poses_and_parameter_jacobians(moved, samples);
    for (Index s = 0; s < samples.rows(); ++s) {
      const JointVector<M::dof> q = configuration(samples, s);
      const Isometry3 pose = model.template pose<double>(q, p);
      same_pose.compare(pose.matrix(), moved.pose(q).matrix(), s);
      if (p == own) same_model.compare(moved.pose(q).matrix(), model.pose(q).matrix(), s);

      ParameterJacobian<P> difference;
      for (int k = 0; k < P; ++k) {
        Parameters after = p, before = p;
        after(k) += options.difference_step;
        before(k) -= options.difference_step;
        const Vector6 column = detail::difference_quotient(model.with_parameters(after).pose(q),
                                                           model.with_parameters(before).pose(q), after(k) - before(k));
        for (Index r = 0; r < 6; ++r) difference(r, k) = column(r);
      }
      derivative.compare(moved.parameter_jacobian(q), difference, s);
      derivative.compare_row(all.jacobians, s, difference.data(), s);
    }
  }
  for (const detail::Law* law : {&round_trip, &same_model, &same_pose, &derivative}) law->report(violations);
  return violations;
}

}  // namespace vernier::testing
