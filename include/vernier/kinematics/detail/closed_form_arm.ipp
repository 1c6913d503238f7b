// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/detail/closed_form_arm.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

/// Lines as seen from an end of the arm.
struct AxisLines {
  Vector3 h[6], o[6];

  VERNIER_LOCAL double angle(int i, int j) const { return std::atan2(h[i].cross(h[j]).norm(), h[i].dot(h[j])); }
  /// Angle between lines, whatever their directions.
  VERNIER_LOCAL double deviation(int i, int j) const {
    const double a = angle(i, j);
    return (std::min)(a, std::numbers::pi - a);
  }
  VERNIER_LOCAL double distance(int i, const Vector3& point) const { return h[i].cross(Vector3(point - o[i])).norm(); }
  /// The point nearest to lines i..j, and the largest distance from one of them.
  VERNIER_LOCAL double meeting(int i, int j, Vector3& point) const {
    const MeetingPoint found = meeting_point(h + i, o + i, j - i + 1);
    point = found.point;
    return found.miss;
  }
};

/// Sorts an arm, seen from one of its ends, into a family.
/// @param why what keeps it out of each, where there is none
VERNIER_LOCAL bool classify(AxisLines& lines, double tolerance, ArmKind& kind, std::string& why) {
  constexpr double apart = 0.05;  // rad: axes that have to be distinct
  Vector3 centre;
  const double spherical = lines.meeting(3, 5, centre);
  if (spherical <= tolerance && lines.deviation(3, 4) > apart && lines.deviation(4, 5) > apart) {
    constexpr double lever = 1e-3;  // m: a shorter one moves nothing
    Vector3 shoulder;
    const bool distinct = lines.deviation(0, 1) > apart, bends = lines.distance(2, centre) > lever;
    if (lines.deviation(1, 2) <= tolerance && distinct && bends && lines.distance(2, lines.o[1]) > lever) {
      kind = ArmKind::second_parallel_to_third;
    } else if (lines.deviation(0, 1) <= tolerance && lines.deviation(1, 2) > apart && bends &&
               lines.distance(1, lines.o[0]) > lever) {
      kind = ArmKind::first_parallel_to_second;
    } else if (distinct && bends && lines.meeting(0, 1, shoulder) <= tolerance && lines.distance(2, shoulder) > lever) {
      kind = ArmKind::first_meets_second;
      lines.o[0] = lines.o[1] = shoulder;
    } else if (lines.deviation(1, 2) > apart && bends && lines.meeting(1, 2, shoulder) <= tolerance &&
               lines.distance(0, shoulder) > lever) {
      kind = ArmKind::second_meets_third;
      lines.o[1] = lines.o[2] = shoulder;
    } else {
      why +=
          "the last three axes meet in a point, but the other three have no neighbours that are parallel or meet, and "
          "bend the arm";
      return false;
    }
    lines.o[3] = lines.o[4] = lines.o[5] = centre;
    return true;
  }
  Vector3 meeting;
  const double parallel = (std::max)(lines.deviation(1, 2), lines.deviation(1, 3));
  const double last = lines.meeting(4, 5, meeting);
  if (parallel <= tolerance && last <= tolerance && lines.deviation(0, 1) > apart && lines.deviation(3, 4) > apart &&
      lines.deviation(4, 5) > apart) {
    kind = ArmKind::three_parallel;
    lines.o[4] = lines.o[5] = meeting;
    return true;
  }
  why +=
      message("the last three axes miss a common point by ", spherical * 1e3, " mm, the middle three are ",
              parallel * 180 / std::numbers::pi, " deg from parallel and the last two ", 2 * last * 1e3, " mm apart");
  return false;
}

VERNIER_IMPL ClosedFormArm::ClosedFormArm(const SixAxes& axes, double tolerance) : axes_(axes), mirrored_(false) {
  AxisLines lines;
  std::string forward = "seen from the base, ", backward = "; seen from the tool, ";
  const auto collect = [&] {
    for (int i = 0; i < 6; ++i) {
      const int from = mirrored_ ? 5 - i : i;
      const Vector3 direction = axes.direction_of(from);
      lines.h[i] = direction / (mirrored_ ? -direction.norm() : direction.norm());
      lines.o[i] = axes.point_of(from);
    }
  };
  collect();
  if (!classify(lines, tolerance, kind_, forward)) {
    mirrored_ = true;
    collect();
    demand(classify(lines, tolerance, kind_, backward), "ClosedForm: the arm has no closed form: ", forward, backward);
  }
  // Along its axis a point may lie anywhere; next to its neighbour, rounding errors are smallest.
  const auto slide = [&](int i, int to) {
    const Vector3 off = lines.o[to] - lines.o[i];
    lines.o[i] += lines.h[i].dot(off) * lines.h[i];
  };
  const bool fixed_first = kind_ == ArmKind::first_meets_second, fixed_middle = kind_ == ArmKind::second_meets_third;
  if (kind_ == ArmKind::three_parallel) slide(3, 4);
  if (!fixed_middle) slide(2, 3);
  if (!fixed_middle && !fixed_first) slide(1, 2);
  if (!fixed_first) slide(0, 1);
  for (int i = 0; i < 6; ++i) {
    h_[i] = lines.h[i];
    o_[i] = lines.o[i];
    p_[i] = lines.o[i < 5 ? i + 1 : 5] - lines.o[i];
  }
  third_ = h_[1].dot(h_[2]) < 0 ? -1 : 1;
  fourth_ = h_[1].dot(h_[3]) < 0 ? -1 : 1;
  wrist_ = wrist_of(kind_ == ArmKind::three_parallel ? h_[1] : h_[3], h_[4], h_[5]);
}

VERNIER_IMPL SixAxisRoots ClosedFormArm::solve(const Isometry3& target, const JointVector<6>& close_to,
                                               double width) const noexcept {
  SixAxisRoots out;
  const auto nearby = [&](int i) { return close_to(mirrored_ ? 5 - i : i); };
  const auto offer = [&](const double(&q)[6], double margin, unsigned free, bool sampled) {
    if (out.count >= SixAxisRoots::capacity) return;
    SixAxisRoot& root = out.roots[static_cast<std::size_t>(out.count++)];
    root.margin = margin;
    root.free = 0;
    root.sampled = sampled;
    for (int i = 0; i < 6; ++i) {
      const int joint = mirrored_ ? 5 - i : i;
      root.joints(joint) = wrapped_angle(q[i]);
      if ((free >> i & 1u) != 0) root.free |= 1u << joint;
    }
  };
  const auto missed = [&](double margin) {
    if (margin > most_margin) out.nearest_margin = (std::min)(out.nearest_margin, margin);
  };

  // displacement of the arm: rotation, and from the point of the first axis to that of the last
  const Matrix3 back_at_zero = VERNIER_LATER(rotation(axes_.tool)).transpose();
  Matrix3 turn = times3(rotation(target), back_at_zero);
  const Vector3 lever = (mirrored_ ? o_[0] : o_[5]) - translation(axes_.tool), moved = rotated(turn, lever);
  Vector3 w = translation(target) + moved;
  w -= mirrored_ ? o_[5] : o_[0];
  if (mirrored_) {
    const Matrix3 forward = turn;
    turn = VERNIER_LATER(forward).transpose();
    w = rotated(turn, -w);
  }

  // the component along an axis of the vector from the point of joint 1 to that of joint links + 1
  const auto along = [&](const Vector3& axis, int links) {
    double sum = 0;
    for (int i = 0; i < links; ++i) sum += axis.dot(p_[i]);
    return sum;
  };

  // with the first three joints known, a spherical wrist does the rest
  const auto finish = [&](double q1, double q2, double q3, const Matrix3& r1, const Matrix3& r3, double margin,
                          unsigned free, bool sampled) {
    const Matrix3 to_wrist = times3(times3(r1, rotation_about(h_[1], q2)), r3);
    const WristAngles end = solve_wrist(wrist_, transposed_times3(to_wrist, turn), nearby(3), sampled ? 0 : width);
    missed(end.margin);
    for (int k = 0; k < end.count; ++k)
      offer({q1, q2, q3, end.q4[k], end.q5[k], end.q6[k]}, (std::max)(margin, end.margin_of(k)),
            free | (end.any ? 8u : 0u), sampled || k >= end.exact);
  };

  switch (kind_) {
    case ArmKind::second_parallel_to_third:
    case ArmKind::second_meets_third: {
      const bool parallel = kind_ == ArmKind::second_parallel_to_third;
      const Candidates firsts(parallel ? angles_to_plane(h_[1], -h_[0], w, along(h_[1], 3), negligible_length)
                                       : angles_to_distance(-h_[0], w, p_[0], p_[2].norm(), negligible_length),
                              nearby(0), parallel ? width : 0);
      missed(firsts.margin);
      for (int i = 0; i < firsts.count; ++i) {
        const double q1 = firsts.angles[i];
        const Matrix3 r1 = rotation_about(h_[0], q1);
        const Vector3 u = rotated_back(r1, w) - p_[0];
        const Candidates thirds(parallel ? angles_to_distance(h_[2], p_[2], -p_[1], u.norm(), negligible_length)
                                         : angles_to_plane(h_[1], h_[2], p_[2], h_[1].dot(u), negligible_length),
                                nearby(2));
        missed(thirds.margin);
        for (int k = 0; k < thirds.count; ++k) {
          const Matrix3 r3 = rotation_about(h_[2], thirds.angles[k]);
          const Vector3 bent = p_[1] + rotated(r3, p_[2]);
          const AngleAbout second = angle_between(h_[1], bent, u, negligible_length);
          const double q2 = second.any ? nearby(1) : second.angle,
                       margin = (std::max)(firsts.margin_of(i), thirds.margin);
          const unsigned free = (firsts.any ? 1u : 0u) | (second.any ? 2u : 0u) | (thirds.any ? 4u : 0u);
          finish(q1, q2, thirds.angles[k], r1, r3, margin, free, i >= firsts.exact);
          // folded, the arm has its wrist next to the second axis
          if (i < firsts.exact && (std::max)(h_[1].cross(bent).norm(), h_[1].cross(u).norm()) < width)
            for (int m = 0; m < angle_samples; ++m)
              finish(q1, q2 + (m + 0.5) * 2 * std::numbers::pi / angle_samples, thirds.angles[k], r1, r3, margin, free,
                     true);
        }
      }
      break;
    }
    case ArmKind::first_parallel_to_second:
    case ArmKind::first_meets_second: {
      const bool parallel = kind_ == ArmKind::first_parallel_to_second;
      const Candidates thirds(
          parallel ? angles_to_plane(h_[0], h_[2], p_[2], h_[0].dot(w) - along(h_[0], 2), negligible_length)
                   : angles_to_distance(h_[2], p_[2], -p_[1], w.norm(), negligible_length),
          nearby(2), parallel ? width : 0);
      missed(thirds.margin);
      for (int i = 0; i < thirds.count; ++i) {
        const Matrix3 r3 = rotation_about(h_[2], thirds.angles[i]);
        const Vector3 v = p_[1] + rotated(r3, p_[2]);
        const Candidates seconds(parallel ? angles_to_distance(h_[1], v, -p_[0], w.norm(), negligible_length)
                                          : angles_to_plane(h_[0], h_[1], v, h_[0].dot(w), negligible_length),
                                 nearby(1), parallel ? 0 : width);
        missed(seconds.margin);
        for (int k = 0; k < seconds.count; ++k) {
          const double q2 = seconds.angles[k];
          const Vector3 end = p_[0] + rotated(rotation_about(h_[1], q2), v);
          const AngleAbout q1 = angle_between(h_[0], end, w, negligible_length);
          const double first = q1.any ? nearby(0) : q1.angle;
          finish(first, q2, thirds.angles[i], rotation_about(h_[0], first), r3,
                 (std::max)(thirds.margin_of(i), seconds.margin_of(k)),
                 (q1.any ? 1u : 0u) | (seconds.any ? 2u : 0u) | (thirds.any ? 4u : 0u),
                 i >= thirds.exact || k >= seconds.exact);
        }
      }
      break;
    }
    case ArmKind::three_parallel: {
      const double near_sum = nearby(1) + third_ * nearby(2) + fourth_ * nearby(3);
      const Candidates firsts(angles_to_plane(h_[1], -h_[0], w, along(h_[1], 4), negligible_length), nearby(0), width);
      missed(firsts.margin);
      for (int i = 0; i < firsts.count; ++i) {
        const Matrix3 back = rotation_about(h_[0], -firsts.angles[i]);
        const Matrix3 seen = times3(back, turn);
        const Vector3 to_second = rotated(back, w) - p_[0];
        WristAngles end = solve_wrist(wrist_, seen, near_sum, width);
        // from axis 2 to axis 4, seen from joint 1
        const auto middle = [&](double sum) { return Vector3(to_second - rotated(rotation_about(h_[1], sum), p_[3])); };
        // with a straight wrist any sum of the parallel joints will do that the arm reaches: the nearest of a few
        const auto out_of_reach = [&] {
          return angles_to_distance(h_[2], p_[2], -p_[1], middle(end.q4[0]).norm(), negligible_length).margin > 0;
        };
        for (int k = 1; k <= 16 && end.any && out_of_reach(); ++k)
          end =
              solve_wrist(wrist_, seen, near_sum + (k % 2 == 0 ? 1 : -1) * ((k + 1) / 2) * std::numbers::pi / 8, width);
        missed(end.margin);
        for (int m = 0; m < end.count; ++m) {
          const Vector3 u = middle(end.q4[m]);
          const Candidates thirds(angles_to_distance(h_[2], p_[2], -p_[1], u.norm(), negligible_length), nearby(2));
          missed(thirds.margin);
          for (int k = 0; k < thirds.count; ++k) {
            const double q3 = thirds.angles[k];
            const Vector3 bent = p_[1] + rotated(rotation_about(h_[2], q3), p_[2]);
            const AngleAbout second = angle_between(h_[1], bent, u, negligible_length);
            const double q2 = second.any ? nearby(1) : second.angle;
            offer({firsts.angles[i], q2, q3, fourth_ * (end.q4[m] - q2 - third_ * q3), end.q5[m], end.q6[m]},
                  (std::max)({firsts.margin_of(i), end.margin_of(m), thirds.margin}),
                  (firsts.any ? 1u : 0u) | (second.any ? 2u : 0u) | (thirds.any ? 4u : 0u) | (end.any ? 8u : 0u),
                  i >= firsts.exact);
          }
        }
      }
      break;
    }
  }
  return out;
}

VERNIER_IMPL SingularityDistances ClosedFormArm::distances(const JointVector<6>& joints) const noexcept {
  double q[6];
  for (int i = 0; i < 6; ++i) q[i] = joints(mirrored_ ? 5 - i : i);
  const auto off = [](const Vector3& axis, const Vector3& v) { return axis.cross(v).norm(); };
  const Vector3 bent = rotated(rotation_about(h_[2], q[2]), p_[2]);  // from axis 3 on, seen from before joint 3
  const Vector3 both = p_[1] + bent,
                turned = rotated(rotation_about(h_[1], q[1]), both);  // from axis 2 on, seen from joint 1
  const Vector3 last = rotated(rotation_about(wrist_.k5, q[4]), wrist_.k6);
  const double upper = off(h_[2], p_[1]), fore = off(h_[2], p_[2]);
  SingularityDistances out;
  out.wrist = wrist_.k4.dot(wrist_.k5.cross(last)) / (std::sin(wrist_.alpha) * std::sin(wrist_.beta));
  switch (kind_) {
    case ArmKind::second_parallel_to_third:
    case ArmKind::three_parallel: {
      Vector3 end = p_[0] + turned;
      double length = upper + fore;
      if (kind_ == ArmKind::three_parallel) {
        end += rotated(rotation_about(h_[1], q[1] + third_ * q[2] + fourth_ * q[3]), p_[3]);
        length += off(h_[1], p_[3]);
      }
      out.shoulder = h_[1].dot(h_[0].cross(end)) / (off(h_[0], h_[1]) * (length + off(h_[1], p_[0])));
      out.elbow = h_[2].dot(p_[1].cross(bent)) / (upper * fore);
      break;
    }
    case ArmKind::first_meets_second:
      out.shoulder = turned.dot(h_[0].cross(h_[1])) / (off(h_[0], h_[1]) * (p_[1].norm() + p_[2].norm()));
      out.elbow = p_[1].dot(h_[2].cross(bent)) / (upper * fore);
      break;
    case ArmKind::first_parallel_to_second:
      out.shoulder = h_[0].dot(h_[2].cross(bent)) / (off(h_[0], h_[2]) * fore);
      out.elbow = h_[0].dot(p_[0].cross(turned)) / (off(h_[0], p_[0]) * (off(h_[0], p_[1]) + p_[2].norm()));
      break;
    case ArmKind::second_meets_third:  // p_[1] is zero
      out.shoulder = turned.dot(h_[0].cross(p_[0])) / (off(h_[0], p_[0]) * p_[2].norm());
      out.elbow = bent.dot(h_[1].cross(h_[2])) / (off(h_[1], h_[2]) * p_[2].norm());
      break;
  }
  return out;
}

}  // namespace vernier::detail
