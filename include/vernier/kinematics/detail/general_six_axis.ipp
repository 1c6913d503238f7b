// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/general_six_axis.hpp"
#include "vernier/kinematics/detail/hidden_joint.hpp"
#include "vernier/kinematics/detail/reflections.hpp"
#include "vernier/kinematics/detail/small_systems.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

VERNIER_LOCAL AxisLine axis_of(const SixAxes& arm, int joint) { return {arm.point_of(joint), arm.direction_of(joint)}; }

/// Angle in (-pi, pi].
VERNIER_LOCAL double half_turn_angle(double angle) {
  constexpr double pi = std::numbers::pi;
  const double out = std::remainder(angle, 2 * pi);
  return out > -pi ? out : pi;
}

/// Greatest difference of two joints, modulo turns [rad].
VERNIER_LOCAL double root_distance(const JointVector<6>& a, const JointVector<6>& b) {
  double out = 0;
  for (int i = 0; i < 6; ++i) out = (std::max)(out, std::abs(half_turn_angle(a(i) - b(i))));
  return out;
}

/// Moves the origin to the middle of the axes and makes their distance from it the unit of length, that the equations
/// of lengths, squares of lengths and directions weigh alike.
VERNIER_LOCAL void normalize_lengths(SixAxes& arm, Isometry3& target) {
  const auto nearest = [&](int i, const Vector3& to) {
    const AxisLine axis = axis_of(arm, i);
    const Vector3 off = to - axis.point;
    return Vector3(axis.point + axis.direction.dot(off) * axis.direction);
  };
  Vector3 centre = arm.point_of(0);
  for (int repeat = 0; repeat < 3; ++repeat) {
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < 6; ++i) sum += nearest(i, centre);
    centre = sum / 6;
  }
  const Vector3 closure = transformed(target, transformed(inverse_of(arm.tool), centre));
  double square = (closure - centre).squaredNorm();
  for (int i = 0; i < 6; ++i) {
    const Vector3 point = nearest(i, centre) - centre;
    for (int k = 0; k < 3; ++k) arm.point(k, i) = point(k);
    square += point.squaredNorm();
  }
  const double unit = square > 0 ? std::sqrt(square / 6) : 1;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 6; ++i) arm.point(k, i) /= unit;
    arm.tool(k, 3) = (arm.tool(k, 3) - centre(k)) / unit;
    target(k, 3) = (target(k, 3) - centre(k)) / unit;
  }
}

/// An arm whose axes are each displaced by 1e-7. Exactly parallel or intersecting axes can make the pencil singular
/// for every angle; displaced, they leave it regular, and Newton steps make up for it.
VERNIER_LOCAL SixAxes with_displaced_axes(SixAxes arm) {
  Rng rng;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 3; ++k) {
      arm.direction(k, i) += rng.uniform(-1e-7, 1e-7);
      arm.point(k, i) += rng.uniform(-1e-7, 1e-7);
    }
    const double length = arm.direction_of(i).norm();
    for (int k = 0; k < 3; ++k) arm.direction(k, i) /= length;
  }
  return arm;
}

/// The loop of an arm and its target in which joint `first` comes first, counted from 0. A joint moves from the start
/// of the product to its end with its axis moved by the inverse of the closure. Points next to the origin, so that the
/// coordinates of lines stay small.
VERNIER_LOCAL ClosedLoop loop_of(const SixAxes& arm, const Isometry3& target, int first) noexcept {
  const Isometry3 closure = composed(target, inverse_of(arm.tool)), back = inverse_of(closure);
  ClosedLoop out;
  for (int i = 0; i < 6; ++i) {
    const AxisLine axis = axis_of(arm, (first + i) % 6);
    out.axes[static_cast<std::size_t>(i)] = first + i < 6 ? axis : back * axis;
  }
  const Isometry3 frame = to_z_axis(out.axes[2]);
  for (AxisLine& axis : out.axes) {
    axis = frame * axis;
    axis.point -= axis.direction.dot(axis.point) * axis.direction;
  }
  out.closure = composed(frame, composed(closure, inverse_of(frame)));
  return out;
}

/// All joints of a loop, from the third.
VERNIER_LOCAL JointVector<6> back_substitute(const ClosedLoop& loop, const LoopPencil& pencil, double q3) noexcept {
  // The null vector of the pencil: (cos 3h, sin 3h, cos h, sin h) by (1, cos q5, sin q5), times any number.
  double equations[12][12], rows[12][12], null[12];
  equations_at(pencil, q3, equations);
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < 12; ++k) rows[i][k] = equations[k][i];
  orthogonal_complement(rows[0], 12, 12, 11, null);
  const double h = std::atan2(null[9], null[6]);
  const double of_half_angle[4] = {std::cos(3 * h), std::sin(3 * h), std::cos(h), std::sin(h)};
  double five[3] = {};
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) five[r] += null[3 * c + r] * of_half_angle[c];
  const double sign = five[0] < 0 ? -1 : 1;
  const double q4 = 2 * h, q5 = std::atan2(sign * five[2], sign * five[1]);

  // E_2 (E_3 E_4 E_5 line 6) = E_1^-1 (closure line 6): what joint 1 leaves alone is linear in cos q2 and sin q2.
  const auto& axes = loop.axes;
  const Isometry3 frame = to_z_axis(axes[0]);
  const Isometry3 wrist = composed(composed(turn_about(axes[2], q3), turn_about(axes[3], q4)), turn_about(axes[4], q5));
  const AxisLine last = wrist * axes[5];
  const LineCoordinates goal = coordinates_of(frame * (loop.closure * axes[5]));
  const auto turned_second = [&](double q2) { return coordinates_of(frame * (turn_about(axes[1], q2) * last)); };
  const LineCoordinates plus = turned_second(0), quarter = turned_second(std::numbers::pi / 2),
                        minus = turned_second(std::numbers::pi);
  double cc = 0, cs = 0, ss = 0, right_c = 0, right_s = 0;  // of the normal equations
  for (std::size_t k = 8; k < 14; ++k) {
    const double middle = (plus[k] + minus[k]) / 2, c = plus[k] - middle, s = quarter[k] - middle;
    cc += c * c;
    cs += c * s;
    ss += s * s;
    right_c += c * (goal[k] - middle);
    right_s += s * (goal[k] - middle);
  }
  const double q2 = std::atan2(cc * right_s - cs * right_c, ss * right_c - cs * right_s);

  // What joint 1 turns, and then joint 6 by the rotation left.
  const LineCoordinates from = turned_second(q2);
  double cosine = 0, sine = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    cosine += from[k] * goal[k] + from[k + 4] * goal[k + 4];
    sine += from[k] * goal[k + 4] - from[k + 4] * goal[k];
  }
  const double q1 = std::atan2(sine, cosine);
  const Isometry3 before_last = composed(composed(turn_about(axes[0], q1), turn_about(axes[1], q2)), wrist);
  const Vector3 x = unit_orthogonal(axes[5].direction), seen = rotated(rotation(loop.closure), x);
  const Vector3 turned = rotated_back(rotation(before_last), seen);
  const double q6 = std::atan2(axes[5].direction.dot(x.cross(turned)), x.dot(turned));
  return JointVector<6>{q1, q2, q3, q4, q5, q6};
}

/// Damped Newton steps until the pose is met. Returns whether it is.
/// @cite Levenberg 1944; Nakamura and Hanafusa 1986
VERNIER_LOCAL bool polish_root(const SixAxes& arm, const Isometry3& target, JointVector<6>& q) noexcept {
  constexpr int steps_to_come_near = 15, max_steps = 40;
  constexpr double longest_step = 0.3, close = 1e-3, enough = 1e-13, accepted = 1e-10;
  double jacobian[6][6], normal[6][6], newton[6];
  for (int step = 0;; ++step) {
    Matrix3 turned = Matrix3::Identity();
    Vector3 shift = Vector3::Zero(), directions[6], points[6];
    for (int i = 0; i < 6; ++i) {
      const AxisLine axis = axis_of(arm, i);
      const Matrix3 before = turned, turn = exp_so3(Vector3(q(i) * axis.direction));
      directions[i] = rotated(before, axis.direction);
      points[i] = shift + rotated(before, axis.point);
      turned = times3(before, turn);
      shift = points[i] - rotated(turned, axis.point);
    }
    const Isometry3 pose = composed(rigid_motion(turned, shift), arm.tool);
    const Vector3 position = translation(pose);
    for (int i = 0; i < 6; ++i) {
      const Vector3 lever = position - points[i], moved = directions[i].cross(lever);
      std::copy_n(moved.data(), 3, jacobian[i]);
      std::copy_n(directions[i].data(), 3, jacobian[i] + 3);
    }
    const Vector6 error = pose_difference(target, pose);
    const double left = error.norm();
    if (left < enough) return true;
    if (step == max_steps || (step >= steps_to_come_near && !(left < close)) || !std::isfinite(left))
      return left < accepted;
    // Damping in proportion to the square of the error: convergence stays quadratic.
    for (int j = 0; j < 6; ++j) {
      for (int i = j; i < 6; ++i) normal[j][i] = dot6(jacobian[i], jacobian[j]);
      normal[j][j] += 1e-2 * left * left + 1e-15;
      newton[j] = dot6(jacobian[j], error.data());
    }
    solve_few(normal[0], newton, 6);
    double largest = 0;
    for (const double value : newton) largest = (std::max)(largest, std::abs(value));
    for (int i = 0; i < 6; ++i) q(i) += newton[i] * (std::min)(1.0, longest_step / largest);
  }
}

/// Whether the joints were new.
VERNIER_LOCAL bool insert_root(SixAxisRoots& roots, const JointVector<6>& q) {
  constexpr double same = 1e-5;  // rad
  for (const SixAxisRoot& root : roots)
    if (root_distance(root.joints, q) < same) return false;
  if (roots.count == SixAxisRoots::capacity) return false;
  JointVector<6>& joints = roots.roots[static_cast<std::size_t>(roots.count++)].joints;
  for (int i = 0; i < 6; ++i) joints(i) = half_turn_angle(q(i));
  return true;
}

/// Adds the roots that one elimination on an arm near by finds. Returns whether they are likely to be all: the
/// elimination is to be trusted, and each real value of the hidden joint led to a root of its own with that value.
VERNIER_LOCAL bool find_roots_hiding(const SixAxes& arm, const SixAxes& nearby, const Isometry3& target, int hidden,
                                     SixAxisRoots& roots) noexcept {
  constexpr double largest_imaginary = 0.2, nearly_real = 0.01;  // rad; Newton steps and the residual decide
  constexpr double trusted_condition = 1e6, accounted = 1e-3;
  const int first = (hidden + 4) % 6;
  const ClosedLoop loop = loop_of(nearby, target, first);
  const LoopPencil pencil = eliminate(loop);
  const HiddenJointValues values = hidden_joint_values(pencil);
  roots.condition = (std::min)(roots.condition, values.condition);
  bool complete = values.count > 0 && values.condition < trusted_condition;
  SixAxisRoots found;
  for (int i = 0; i < values.count; ++i) {
    const std::complex<double> angle = values.angles[static_cast<std::size_t>(i)];
    if (!(angle.imag() >= 0 && angle.imag() < largest_imaginary)) continue;  // one of a conjugate pair
    const JointVector<6> from_first = back_substitute(loop, pencil, angle.real());
    JointVector<6> start;
    for (int k = 0; k < 6; ++k) start((first + k) % 6) = from_first(k);
    JointVector<6> q = start;
    const bool is_root = polish_root(arm, target, q), is_new = is_root && insert_root(found, q);
    if (angle.imag() >= nearly_real) continue;
    complete &= is_new && std::abs(half_turn_angle(q(hidden) - angle.real())) < accounted;
    // A conjugate pair may be two roots that rounding, or the displacement, has merged: the other is opposite.
    if (angle.imag() > 0 && is_root) {
      JointVector<6> opposite;
      for (int k = 0; k < 6; ++k) opposite(k) = 2 * start(k) - q(k);
      if (polish_root(arm, target, opposite)) insert_root(found, opposite);
    }
  }
  for (const SixAxisRoot& root : found) insert_root(roots, root.joints);
  return complete && roots.count % 2 == 0;  // real roots come and go in pairs
}

VERNIER_IMPL SixAxisRoots solve_six_axes(const SixAxes& arm, const Isometry3& target) noexcept {
  SixAxisRoots out;
  out.condition = std::numeric_limits<double>::infinity();
  SixAxes scaled = arm;
  Isometry3 scaled_target = target;
  normalize_lengths(scaled, scaled_target);
  if (!are_finite(scaled.point.data(), 18) || !are_finite(scaled.direction.data(), 18) ||
      !are_finite(scaled.tool.data(), 16) || !are_finite(scaled_target.data(), 16))
    return out;
  const SixAxes nearby = with_displaced_axes(scaled);
  constexpr int order[] = {3, 1, 4, 5, 2, 0};  // industrial arms need the fewest eliminations so
  for (const int hidden : order)
    if (find_roots_hiding(scaled, nearby, scaled_target, hidden, out)) break;
  return out;
}

VERNIER_IMPL SingularityDistances unfactored_distance(const SixAxes& arm, const JointVector<6>& q) noexcept {
  double columns[6][6];
  Isometry3 moved = Isometry3::Identity();
  const double length = (std::max)(arm_length(arm), 1e-9);
  for (int i = 0; i < 6; ++i) {
    const AxisLine axis = axis_of(arm, i), at = moved * axis;
    const Vector3 moment = at.point.cross(at.direction) / length;
    const double inverse = 1 / std::sqrt(moment.squaredNorm() + at.direction.squaredNorm());
    for (int k = 0; k < 3; ++k) {
      columns[i][k] = moment(k) * inverse;
      columns[i][3 + k] = at.direction(k) * inverse;
    }
    if (i < 5) moved = composed(moved, turn_about(axis, q(i)));
  }
  return {1, 1, determinant_few(columns), false};
}

}  // namespace vernier::detail
