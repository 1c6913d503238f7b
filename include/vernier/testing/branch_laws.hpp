// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a solver that returns all branches of the inverse kinematics must do, as a list of violations.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing {

/// How closely the laws are held.
template <int N>
struct BranchLawOptions {
  double position_tolerance = 1e-9;                     ///< what a branch may miss its target by [m]
  double rotation_tolerance = 1e-9;                     ///< likewise [rad]
  static constexpr double distinct = 1e-6;              ///< joint values that differ by less are the same [rad]
  static constexpr double generating_tolerance = 1e-6;  ///< of the joint values that made the target [rad]
  /// Samples whose Jacobian has a smaller singular value are next to a singularity: there a branch may be missing
  /// [m/rad].
  static constexpr double singular = 0.02;
  static constexpr double rotation_length = 0.3;  ///< 1 rad of rotation weighs as many metres in singular values [m]
  JointLimits<N> limits{};                        ///< those of the solver
  int held_joint = -1;                            ///< counted from 0; -1 where all move
};

namespace detail {

/// Differences of joint values without whole turns.
template <int N>
JointVector<N> turnless_difference(const JointVector<N>& a, const JointVector<N>& b) {
  JointVector<N> out;
  for (int i = 0; i < N; ++i) out(i) = std::remainder(a(i) - b(i), 2 * std::numbers::pi);
  return out;
}

/// The largest difference of joint values; infinite where one is not a number.
template <int N>
double largest_of(const JointVector<N>& differences) {
  double out = 0;
  for (int i = 0; i < N; ++i) {
    if (std::isnan(differences(i))) return std::numeric_limits<double>::infinity();
    out = (std::max)(out, std::abs(differences(i)));
  }
  return out;
}

/// The worst offence against one law of branches over all samples.
class BranchLaw {
 public:
  BranchLaw(std::string text, double tolerance) : text_(std::move(text)), tolerance_(tolerance) {}

  /// Notes by how much the law is missed at a sample; what is not a number misses it entirely.
  void miss(double by, Index sample) {
    if (std::isnan(by)) by = std::numeric_limits<double>::infinity();
    if (by > tolerance_) ++samples_;
    if (by <= worst_) return;
    worst_ = by;
    sample_ = sample;
  }
  /// Notes whether the law holds at a sample.
  void hold(bool holds, Index sample) { miss(holds ? 0 : std::numeric_limits<double>::infinity(), sample); }

  void report(std::vector<std::string>& violations) const {
    if (samples_ == 0) return;
    std::string sentence =
        message(text_, ": broken ", samples_, samples_ == 1 ? " time" : " times", ", at sample ", sample_);
    if (std::isfinite(worst_)) sentence += message(", by ", worst_, "; the tolerance is ", tolerance_);
    violations.push_back(std::move(sentence));
  }

 private:
  std::string text_;
  double tolerance_;
  double worst_ = 0;
  Index sample_ = 0, samples_ = 0;
};

/// Smallest singular value of the Jacobian of the joints that move, rotations weighted as lengths.
template <KinematicModel M>
double distance_from_singularity(const M& model, const JointVector<M::dof>& q,
                                 const BranchLawOptions<M::dof>& options) {
  const Jacobian<M::dof> jacobian = model.jacobian(q);
  const bool held = options.held_joint >= 0;
  MatrixX moving(6, M::dof - (held ? 1 : 0));
  for (Index j = 0, k = 0; j < M::dof; ++j) {
    if (j == options.held_joint) continue;
    for (Index r = 0; r < 6; ++r) moving(r, k) = r < 3 ? jacobian(r, j) : options.rotation_length * jacobian(r, j);
    ++k;
  }
  const VectorX values = vernier::detail::thin_svd(moving).s;
  return values(values.size() - 1);
}

/// Whether two answers are the same, bit for bit.
template <int N>
bool same_branches(const Branches<N>& a, const Branches<N>& b) {
  const auto numbers = [](const Branch<N>& of) {
    const auto distances = of.singularities.values();
    return VectorX{
        {of.position_error, of.rotation_error, of.sigma_min, of.radius, distances[0], distances[1], distances[2]}};
  };
  if (a.count != b.count || a.reach != b.reach || a.seeds_lost != b.seeds_lost || !(a.margin == b.margin)) return false;
  for (auto x = a.begin(), y = b.begin(); x != a.end(); ++x, ++y)
    if (!same_bits(x->joints, y->joints) || !same_bits(numbers(*x), numbers(*y)) || x->proven != y->proven ||
        x->iterations != y->iterations || x->within_limits != y->within_limits)
      return false;
  return true;
}

}  // namespace detail

/// Checks a solver of all branches at the poses of a model at each row of `samples`: every branch meets its target by
/// the model's own pose, no two are the same but for whole turns, `within_limits` says whether a branch is within them
/// and `reach` whether one is, the joint values that made the target are among them away from singularities, no branch
/// lies within the radius of another, errors, singular value and radius are finite and not negative, and a repeated
/// call gives the same bits.
///
///     branch_violations([&](const Isometry3& target) { return all_branches(closed_form, model, target); }, model, q)
///
/// @param solver  `solver(target)` is a `Branches<N>`
/// @param model   whose branches they are
/// @param samples joint configurations, n x dof, n >= 1; a held joint at the value at which it is held
/// @param options tolerances, and the solver's limits
/// @return        one sentence per law that is broken, naming the worst sample; empty when all hold
/// @throws std::invalid_argument without samples, or for a held joint that the model does not have
template <class Solver, KinematicModel M>
std::vector<std::string> branch_violations(const Solver& solver, const M& model, const JointRows<M::dof>& samples,
                                           const BranchLawOptions<M::dof>& options = {}) {
  constexpr int N = M::dof;
  demand(samples.rows() >= 1, "branch_violations: there are no samples");
  demand(options.held_joint >= -1 && options.held_joint < N, "branch_violations: no joint ", options.held_joint + 1,
         " to be held");
  detail::BranchLaw position("every branch has the model's tool at the target's position", options.position_tolerance);
  detail::BranchLaw rotation("every branch has the model's tool in the target's orientation",
                             options.rotation_tolerance);
  detail::BranchLaw distinct("no branch is there twice, whole turns aside", 0);
  detail::BranchLaw limits("within_limits says whether a branch is within the limits", 0);
  detail::BranchLaw reach("reach says whether there is a branch within the limits", 0);
  detail::BranchLaw generating("the joint values that made the target are among the branches", 0);
  detail::BranchLaw radius("no other branch lies within the radius of a branch", 0);
  detail::BranchLaw finite("errors, singular value and radius are finite and not negative", 0);
  detail::BranchLaw repeatable("a repeated call gives the same bits", 0);

  for (Index s = 0; s < samples.rows(); ++s) {
    const JointVector<N> q = configuration(samples, s);
    const Isometry3 target = model.pose(q);
    const Branches<N> branches = solver(target);
    repeatable.hold(detail::same_branches<N>(branches, solver(target)), s);

    bool found = false, within = false;
    for (const Branch<N>& branch : branches) {
      const Vector6 left = pose_difference(target, model.pose(branch.joints));
      position.miss(Vector3(left.template head<3>()).norm(), s);
      rotation.miss(Vector3(left.template tail<3>()).norm(), s);
      const bool inside = options.limits.contains(branch.joints);
      limits.hold(branch.within_limits == inside, s);
      within = within || inside;
      for (const double value : {branch.position_error, branch.rotation_error, branch.sigma_min, branch.radius})
        finite.hold(std::isfinite(value) && value >= 0, s);
      const JointVector<N> missed = detail::turnless_difference<N>(branch.joints, q);
      found = found || detail::largest_of<N>(missed) < options.generating_tolerance;
      for (const Branch<N>& other : branches) {
        if (&other == &branch) continue;
        const JointVector<N> apart = detail::turnless_difference<N>(branch.joints, other.joints);
        const bool same = detail::largest_of<N>(apart) < options.distinct;
        if (&other < &branch) distinct.hold(!same, s);
        if (!same) radius.hold(apart.norm() >= branch.radius, s);
      }
    }
    reach.hold(branches.count == 0 ? branches.reach != Reach::met && branches.reach != Reach::beyond_limits
                                   : branches.reach == (within ? Reach::met : Reach::beyond_limits),
               s);
    if (!found) generating.hold(detail::distance_from_singularity(model, q, options) < options.singular, s);
  }

  std::vector<std::string> violations;
  for (const detail::BranchLaw* law :
       {&position, &rotation, &distinct, &limits, &reach, &generating, &radius, &finite, &repeatable})
    law->report(violations);
  return violations;
}

}  // namespace vernier::testing
