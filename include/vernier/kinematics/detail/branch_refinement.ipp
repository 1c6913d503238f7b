// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/branch_refinement.hpp"
#include "vernier/kinematics/detail/small_systems.hpp"
#include "vernier/kinematics/detail/wrist.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace vernier::detail {

inline constexpr double accepted_error = 1e-10;  // m and rad

/// The model at joint values: rows of rotations weighted as lengths.
struct BranchIterate {
  Matrix6 jacobian, inverse;
  Vector6 error;  ///< what lacks to the target [m]
  double position_error, rotation_error;
  double moved;  ///< from where the inverse was computed [rad]

  bool accepted() const { return position_error < accepted_error && rotation_error < accepted_error; }
};

/// a x
VERNIER_LOCAL inline Vector6 product6(const Matrix6& a, const Vector6& x) noexcept {
  Vector6 out;
  multiply_few<6, 6>(a.data(), x.data(), out.data());
  return out;
}

/// out = a b
VERNIER_LOCAL inline void product66(const Matrix6& a, const Matrix6& b, Matrix6& out) noexcept {
  for (int j = 0; j < 6; ++j) multiply_few<6, 6>(a.data(), b.data() + 6 * j, out.data() + 6 * j);
}

/// a' x
VERNIER_LOCAL inline Vector6 transposed_product6(const Matrix6& a, const Vector6& x) noexcept {
  Vector6 out;
  for (int j = 0; j < 6; ++j) out(j) = dot6(a.data() + 6 * j, x.data());
  return out;
}

/// out = factor a a'
VERNIER_LOCAL inline void product_with_transpose(const Matrix6& a, double factor, Matrix6& out) noexcept {
  Matrix6 scaled_transpose;
  for (int j = 0; j < 6; ++j)
    for (int k = 0; k < 6; ++k) scaled_transpose(k, j) = factor * a(j, k);
  product66(a, scaled_transpose, out);
}

/// Squared Frobenius norm.
VERNIER_LOCAL inline double square6(const Matrix6& a) noexcept {
  double out = 0;
  for (int j = 0; j < 6; ++j) out += dot6(a.data() + 6 * j, a.data() + 6 * j);
  return out;
}

/// Eigenvector of the largest eigenvalue of a symmetric matrix whose eigenvalues are not negative and whose trace is 1:
/// power iteration on a matrix squared thrice. What is left cannot underflow: that eigenvalue is at least a sixth.
VERNIER_LOCAL Vector6 dominant_eigenvector(const Matrix6& matrix) noexcept {
  Matrix6 square, power;
  product66(matrix, matrix, power);
  product66(power, power, square);
  product66(square, square, power);
  int widest = 0;
  for (int k = 1; k < 6; ++k)
    if (power(k, k) > power(widest, widest)) widest = k;
  Vector6 out;
  std::copy_n(power.data() + 6 * widest, 6, out.data());
  for (int k = 0; k < 4; ++k) out = product6(power, out);
  return out / out.norm();
}

VERNIER_LOCAL void evaluate_iterate(const BranchProblem& problem, const double* q, BranchIterate& out) noexcept {
  Isometry3 pose;
  problem.model(q, pose, out.jacobian.data());
  // between rotations that are nearly the same, two terms of the arc sine have an error of 1e-11
  const auto between = [&](int r, int c) {
    return problem.target(r, 0) * pose(c, 0) + problem.target(r, 1) * pose(c, 1) + problem.target(r, 2) * pose(c, 2);
  };
  const Vector3 position = translation(problem.target) - translation(pose);
  const Vector3 sine(0.5 * (between(2, 1) - between(1, 2)), 0.5 * (between(0, 2) - between(2, 0)),
                     0.5 * (between(1, 0) - between(0, 1)));
  const double square = sine.squaredNorm(), trace = between(0, 0) + between(1, 1) + between(2, 2);
  const Vector3 rest = square < 1e-4 && trace > 2 ? Vector3((1 + square / 6) * sine)
                                                  : rotation_difference(rotation(problem.target), rotation(pose));
  out.position_error = position.norm();
  out.rotation_error = rest.norm();
  for (int k = 0; k < 3; ++k) {
    out.error(k) = position(k);
    out.error(3 + k) = problem.rotation_length * rest(k);
    for (int j = 0; j < 6; ++j) out.jacobian(3 + k, j) *= problem.rotation_length;
  }
}

VERNIER_IMPL double nearest_turn(double angle, double close_to, double lower, double upper) noexcept {
  constexpr double turn = 2 * std::numbers::pi, slack = 1e-9;
  const double least = std::ceil((lower - slack - angle) / turn), most = std::floor((upper + slack - angle) / turn);
  double k = std::nearbyint((close_to - angle) / turn);
  if (least <= most) {
    k = std::clamp(k, least, most);
  } else if (std::isfinite(lower) && std::isfinite(upper)) {
    k = std::nearbyint((0.5 * (lower + upper) - angle) / turn);
  }
  return angle + k * turn;
}

VERNIER_IMPL bool is_pose(const Isometry3& target) noexcept {
  const auto row = [&](int r) { return Vector3(target(r, 0), target(r, 1), target(r, 2)); };
  const Vector3 x = row(0), y = row(1), z = row(2);
  const double off[] = {x.dot(x) - 1, y.dot(y) - 1, z.dot(z) - 1, x.dot(y), x.dot(z), y.dot(z)};
  const bool unit = std::all_of(std::begin(off), std::end(off), [](double d) { return std::abs(d) < 1e-9; });
  return unit && z.dot(x.cross(y)) > 0 && std::isfinite(translation(target).sum());
}

VERNIER_IMPL double lipschitz_bound(double arm_length, double rotation_length) noexcept {
  // Each second derivative of a revolute arm is at most as long as the arm; twice that covers the rotation's logarithm.
  return 2 * 6 * std::hypot(arm_length, rotation_length);
}

/// Newton's method, damped least squares where that does not converge. The last step takes the inverse of the step
/// before, and is not evaluated, where the Lipschitz bound proves that nothing is left.
/// @param damped whether damped least squares, which take many more evaluations, are tried; without, a step of
///               more than half a turn ends the search early
/// @return whether the target is met
VERNIER_LOCAL bool solve_near(const BranchProblem& problem, double* q, BranchIterate& at, int& iterations,
                              bool damped = true) noexcept {
  constexpr double longest_step = 0.3;                  // rad
  constexpr double negligible = 1e-2 * accepted_error;  // m
  double start[most_branch_joints];
  std::copy_n(q, problem.joints, start);
  double before = std::numeric_limits<double>::infinity();
  const auto advance = [&](const Vector6& step, double share, double length) {
    for (int i = 0; i < 6; ++i) q[problem.moving[static_cast<std::size_t>(i)]] += share * step(i);
    at.moved += share * length;
  };
  const auto finish = [&](double left) {
    at.position_error = (std::min)(at.position_error, left);
    at.rotation_error = (std::min)(at.rotation_error, left / problem.rotation_length);
    return true;
  };
  at.moved = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 8; ++k) {
    evaluate_iterate(problem, q, at);
    ++iterations;
    const double size = at.error.norm();
    if (!(size < 2 * before)) break;
    before = size;
    if (at.moved < 1e-3) {
      const Vector6 step = product6(at.inverse, at.error);
      const double length = step.norm(), left = problem.lipschitz * (at.moved + length) * length;
      if (left < negligible) {
        advance(step, 1, length);
        return finish(left);
      }
    }
    invert_few<6>(at.jacobian.data(), at.inverse.data());
    at.moved = 0;
    const Vector6 step = product6(at.inverse, at.error);
    const double length = step.norm();
    double largest = 0;
    for (int i = 0; i < 6; ++i) largest = (std::max)(largest, std::abs(step(i)));
    if (!std::isfinite(length) || (!damped && k < 2 && largest > std::numbers::pi)) break;
    const double share = (std::min)(1.0, longest_step / largest);
    advance(step, share, length);
    if (const double left = 0.5 * problem.lipschitz * length * length; left < negligible) return finish(left);
  }

  if (!damped) return false;

  // near a singularity
  double lower[most_branch_joints], upper[most_branch_joints], jacobian[36];
  for (int i = 0; i < problem.joints; ++i) lower[i] = upper[i] = start[i];
  for (const int i : problem.moving) {
    lower[i] = start[i] - std::numbers::pi;
    upper[i] = start[i] + std::numbers::pi;
  }
  const auto whole = [&](const double* joints, Isometry3& pose, double* columns) {
    problem.model(joints, pose, jacobian);
    std::fill_n(columns, 6 * problem.joints, 0.0);
    for (std::size_t k = 0; k < 6; ++k) std::copy_n(jacobian + 6 * k, 6, columns + 6 * problem.moving[k]);
  };
  const IkOutcome found =
      solve_inverse_kinematics({problem.joints, problem.joints, 0, 30, whole, problem.target, true, start, lower, upper,
                                0.1 * accepted_error, 0.1 * accepted_error, problem.rotation_length},
                               q);
  iterations += found.iterations;
  evaluate_iterate(problem, q, at);
  invert_few<6>(at.jacobian.data(), at.inverse.data());
  at.moved = product6(at.inverse, at.error).norm();
  ++iterations;
  return at.accepted();
}

/// Whether joint values differ by less than a distance [rad], whole turns aside.
VERNIER_LOCAL bool are_near(const BranchProblem& problem, const double* a, const double* b, double distance) noexcept {
  for (int i = 0; i < problem.joints; ++i) {
    const double turns = (a[i] - b[i]) / (2 * std::numbers::pi);
    if (!(std::abs(turns - std::nearbyint(turns)) * (2 * std::numbers::pi) < distance)) return false;
  }
  return true;
}

/// Whether a branch was found so near to q.
VERNIER_LOCAL bool is_known(const BranchSet& set, const BranchProblem& problem, const double* q,
                            double distance) noexcept {
  return std::any_of(set.branches.begin(), set.branches.begin() + set.count,
                     [&](const FoundBranch& branch) { return are_near(problem, q, branch.q, distance); });
}

/// Adds a solution unless it is there.
VERNIER_LOCAL bool add_branch(BranchSet& set, const BranchProblem& problem, const double* q, const BranchIterate& at,
                              int iterations) noexcept {
  if (is_known(set, problem, q, 1e-5)) return false;
  if (set.count == BranchSet::capacity) return false;
  FoundBranch& out = set.branches[static_cast<std::size_t>(set.count++)];
  std::copy_n(q, problem.joints, out.q);
  out.position_error = at.position_error;
  out.rotation_error = at.rotation_error;
  out.iterations = iterations;

  const double bound = std::sqrt(square6(at.inverse));  // of the largest singular value of the inverse
  if (!std::isfinite(bound)) {
    out.sigma_min = out.radius = 0;
    return true;
  }
  Matrix6 spread;
  product_with_transpose(at.inverse, 1 / (bound * bound), spread);
  const Vector6 direction = dominant_eigenvector(spread);
  out.sigma_min = 1 / transposed_product6(at.inverse, direction).norm();

  const double step = at.moved + 1e-15 * bound;
  const double h = bound * problem.lipschitz * step;
  out.radius = h < 0.5 ? (1 + std::sqrt(1 - 2 * h)) / (bound * problem.lipschitz) - at.moved : 0;
  return true;
}

VERNIER_IMPL void BranchSet::refine(const BranchProblem& problem, const double* seed, double margin,
                                    bool sampled) noexcept {
  double q[most_branch_joints];
  for (int i = 0; i < problem.joints; ++i) q[i] = seed[i];
  for (const int i : problem.moving) q[i] = nearest_turn(q[i], problem.close_to[i], problem.lower[i], problem.upper[i]);
  BranchIterate at;
  int iterations = 0;
  if (margin > 0) suspicious = true;
  const bool damped = !sampled || margin > sampled_margin;  // beyond a boundary the Jacobian is singular
  // Newton's method may lead across a limit, or farther than half a turn from `close_to`
  const auto turned = [&] {
    bool changed = false;
    for (const int i : problem.moving) {
      const double value = nearest_turn(q[i], problem.close_to[i], problem.lower[i], problem.upper[i]);
      changed = changed || !same_value(value, q[i]);
      q[i] = value;
    }
    return !changed || solve_near(problem, q, at, iterations, damped);
  };
  if (!solve_near(problem, q, at, iterations, damped) || !turned()) {
    if (sampled) return;  // one of many
    if (same_value(margin, 0)) ++seeds_lost;
    suspicious = true;
    const bool known = std::any_of(stalled, stalled + stalled_count,
                                   [&](const auto& other) { return are_near(problem, q, other.data(), 0.01); });
    if (!known && stalled_count < max_stalled) std::copy_n(q, problem.joints, stalled[stalled_count++].data());
  } else if (!add_branch(*this, problem, q, at, iterations)) {
    suspicious = true;
  }
}

/// Looks for branches on the other side of a fold: along the direction in which the Jacobian is singular, two solutions
/// lie on a parabola, whose curvature gives the distance of the other one.
VERNIER_LOCAL void cross_folds(BranchSet& set, const BranchProblem& problem, const double* from, bool met,
                               double near_fold) noexcept {
  BranchIterate here;
  evaluate_iterate(problem, from, here);
  if (!std::isfinite(square6(here.jacobian))) return;
  // singular vectors of small singular values are those of large ones of the inverse, which shall exist
  for (int k = 0; k < 6; ++k) here.jacobian(k, k) += 1e-12;
  invert_few<6>(here.jacobian.data(), here.inverse.data());
  Matrix6 spread;
  product_with_transpose(here.inverse, 1 / square6(here.inverse), spread);
  constexpr double h = 1e-4, wide = 0.25 * std::numbers::pi;
  double start[most_branch_joints], q[most_branch_joints];
  std::copy_n(from, problem.joints, start);
  Vector6 v;
  const auto displace = [&](double by) {
    std::copy_n(start, problem.joints, q);
    for (int i = 0; i < 6; ++i) q[problem.moving[static_cast<std::size_t>(i)]] += by * v(i);
  };
  for (int direction = 0; direction < 2; ++direction) {
    v = dominant_eigenvector(spread);
    Vector6 u = transposed_product6(here.inverse, v);
    const double sigma = 1 / u.norm();
    if (!(sigma < near_fold)) break;
    u *= sigma;
    const double eigenvalue = v.dot(product6(spread, v));
    double trace = 0;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) spread(i, j) -= eigenvalue * v(i) * v(j);
      trace += spread(j, j);
    }
    for (int k = 0; k < 36; ++k) spread.data()[k] /= trace;
    BranchIterate ahead, at;
    displace(h);
    evaluate_iterate(problem, q, ahead);
    const double curvature = (u.dot(product6(ahead.jacobian, v)) - u.dot(product6(here.jacobian, v))) / h;
    // the other solution; where the seed stalled, it is at the vertex, and both sides have one if the square is
    // positive
    const double square = 2 * u.dot(here.error) / curvature;
    const double twin = met ? -2 * sigma / curvature : std::sqrt(std::abs(square));
    displace(twin);
    if (met && std::abs(twin) < 0.3 && is_known(set, problem, q, 0.5 * std::abs(twin))) continue;
    const auto search = [&](double by, bool damped) {
      if (!(std::abs(by) < 2)) return;
      displace(by);
      int iterations = 2;
      if (!solve_near(problem, q, at, iterations, damped)) return;
      double turned[most_branch_joints];
      std::copy_n(q, problem.joints, turned);
      bool same = true;
      for (const int i : problem.moving) {
        turned[i] = nearest_turn(q[i], problem.close_to[i], problem.lower[i], problem.upper[i]);
        same = same && same_value(turned[i], q[i]);
      }
      if (same || solve_near(problem, turned, at, iterations)) add_branch(set, problem, turned, at, iterations);
    };
    const bool likely = met ? set.suspicious || set.count % 2 != 0 : square > 0;
    search(twin, likely);
    search(met ? 0.5 * twin : -twin, !met && likely);
    search(2 * twin, met && likely);
    if (met && set.count % 2 == 0) continue;
    for (const double by : {wide, -wide}) search(by, false);
  }
}

VERNIER_IMPL void BranchSet::complete(const BranchProblem& problem) noexcept {
  const auto across = [&](double near_fold) {
    for (int b = 0; b < count; ++b) {
      const FoundBranch& from = branches[static_cast<std::size_t>(b)];
      if (from.sigma_min < near_fold) cross_folds(*this, problem, from.q, true, near_fold);
    }
  };
  const double near_fold = may_be_incomplete() ? 0.05 : 0.005;  // m/rad
  across(near_fold);
  for (int k = 0; k < stalled_count; ++k) cross_folds(*this, problem, stalled[k].data(), false, near_fold);
  if (count % 2 != 0) across(0.2);
}

VERNIER_IMPL std::string describe_reach(Reach reach, int branches, double margin) {
  switch (reach) {
    case Reach::met: return counted(branches, "branch", "branches");
    case Reach::beyond_limits: return message("joint limits exclude all ", branches, " branches");
    case Reach::proven_out:
      return message("out of reach: ", significant_digits(margin * 1e3, 3), " mm farther away than the arm is long");
    case Reach::invalid_target: return "the target is no pose: not finite, or no rotation";
    default: break;
  }
  return std::isfinite(margin) ? message("no branch found: the target lies ", significant_digits(100 * margin, 3),
                                         " % beyond a boundary of the nominal arm")
                               : std::string("no branch found");
}

}  // namespace vernier::detail
