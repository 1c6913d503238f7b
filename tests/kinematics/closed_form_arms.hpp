// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Arms that have closed forms, one of each kind and their mirror images, and what the roots of a target are like.

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "branch_helpers.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier_test::closed_forms {

using namespace vernier;
using namespace vernier::literals;
using vernier::detail::ArmKind;
using vernier::detail::ClosedFormArm;

constexpr double pi = std::numbers::pi;
constexpr double exact = 1e-10;  // m, and entries of rotations
/// A margin below this is a rounding error: the target is on the boundary.
constexpr double rounding = 1e-12;

/// What the roots of one target are like.
struct Quality {
  int roots = 0;          ///< that meet the target, by their margin
  double residual = 0;    ///< worst of them
  double generating = 9;  ///< distance of the nearest of them from the joints that made the target [rad]
  double nearest = 9;     ///< smallest distance of two of them [rad]
  bool in_range = true;   ///< moving joints in (-pi, pi]
};

template <class Arm, int N>
Quality quality(const Arm& arm, const InverseRoots<N>& roots, const Isometry3& target, const JointVector<N>& q) {
  Quality out;
  for (const InverseRoot<N>& root : roots) {
    for (const double angle : root.joints) out.in_range = out.in_range && angle > -pi && angle <= pi;
    if (root.margin > rounding) continue;
    ++out.roots;
    out.residual = vernier_test::larger(out.residual, difference(arm.pose(root.joints), target));
    out.generating = std::min(out.generating, joint_difference<N>(root.joints, q));
    for (const InverseRoot<N>* other = roots.begin(); other != &root; ++other)
      if (other->margin <= rounding)
        out.nearest = std::min(out.nearest, joint_difference<N>(root.joints, other->joints));
  }
  return out;
}

struct Case {
  std::string name;
  DhChain<6> chain;
  ArmKind kind;
};

constexpr DhRow wrist_4{.a = 0_mm, .alpha = 90_deg, .d = 302_mm}, wrist_5{.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
    wrist_6{.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg};

/// Three joints in front of a spherical wrist.
inline DhChain<6> with_wrist(const DhRow& first, const DhRow& second, const DhRow& third) {
  return DhChain<6>{{{first, second, third, wrist_4, wrist_5, wrist_6}}};
}

/// An arm of the UR kind whose axes 3 and 4 may run against axis 2.
inline DhChain<6> three_parallel(double alpha2, double alpha3) {
  return DhChain<6>{{{
      {.a = 0_mm, .alpha = 90_deg, .d = 127.3_mm},
      {.a = -612_mm, .alpha = alpha2, .d = 20_mm},
      {.a = -572.3_mm, .alpha = alpha3, .d = -35_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 163.941_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 115.7_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 92.2_mm},
  }}};
}

/// An arm of every kind, and variants in which what is usually orthogonal, parallel or zero is not.
inline const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"irb 120", robots::abb_irb120().chain, ArmKind::second_parallel_to_third},
      {"puma 560", robots::puma560().chain, ArmKind::second_parallel_to_third},
      {"offset shoulder, oblique first axis",
       with_wrist({.a = 50_mm, .alpha = -70_deg, .d = 290_mm},
                  {.a = 270_mm, .alpha = 0_deg, .d = 40_mm, .theta = -90_deg},
                  {.a = 70_mm, .alpha = -60_deg, .d = -15_mm}),
       ArmKind::second_parallel_to_third},
      {"third against second",
       with_wrist({.a = 30_mm, .alpha = -90_deg, .d = 290_mm},
                  {.a = 270_mm, .alpha = 180_deg, .d = 10_mm, .theta = -90_deg},
                  {.a = 70_mm, .alpha = 90_deg, .d = 0_mm}),
       ArmKind::second_parallel_to_third},
      {"oblique wrist",
       DhChain<6>{{{{.a = 0_mm, .alpha = -90_deg, .d = 290_mm},
                    {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
                    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm},
                    {.a = 0_mm, .alpha = 60_deg, .d = 302_mm},
                    {.a = 0_mm, .alpha = -50_deg, .d = 0_mm},
                    wrist_6}}},
       ArmKind::second_parallel_to_third},
      {"first parallel to second",
       with_wrist({.a = 400_mm, .alpha = 0_deg, .d = 200_mm}, {.a = 300_mm, .alpha = 90_deg, .d = 50_mm},
                  {.a = 70_mm, .alpha = -90_deg, .d = 25_mm}),
       ArmKind::first_parallel_to_second},
      {"second against first",
       with_wrist({.a = 400_mm, .alpha = 180_deg, .d = 200_mm}, {.a = 300_mm, .alpha = 75_deg, .d = 50_mm},
                  {.a = 70_mm, .alpha = -90_deg, .d = 0_mm}),
       ArmKind::first_parallel_to_second},
      {"first meets second",
       with_wrist({.a = 0_mm, .alpha = -80_deg, .d = 300_mm}, {.a = 100_mm, .alpha = 70_deg, .d = 250_mm},
                  {.a = 60_mm, .alpha = -90_deg, .d = 0_mm}),
       ArmKind::first_meets_second},
      {"second meets third",
       with_wrist({.a = 150_mm, .alpha = -80_deg, .d = 300_mm}, {.a = 0_mm, .alpha = 90_deg, .d = 40_mm},
                  {.a = 200_mm, .alpha = -90_deg, .d = 120_mm}),
       ArmKind::second_meets_third},
      {"ur10", robots::ur10().chain, ArmKind::three_parallel},
      {"three parallel, third against second", three_parallel(180_deg, 180_deg), ArmKind::three_parallel},
      {"three parallel, third and fourth against second", three_parallel(180_deg, 0_deg), ArmKind::three_parallel},
      {"three parallel, fourth against second", three_parallel(0_deg, 180_deg), ArmKind::three_parallel},
      {"three parallel, oblique",
       DhChain<6>{{{{.a = 40_mm, .alpha = 75_deg, .d = 127.3_mm},
                    {.a = -612_mm, .alpha = 0_deg, .d = 0_mm},
                    {.a = -572.3_mm, .alpha = 0_deg, .d = 0_mm},
                    {.a = 0_mm, .alpha = 70_deg, .d = 163.941_mm},
                    {.a = 0_mm, .alpha = -60_deg, .d = 115.7_mm},
                    {.a = 0_mm, .alpha = 0_deg, .d = 92.2_mm}}}},
       ArmKind::three_parallel},
  };
  return all;
}

/// The arm held by its tool: its joint i is joint 7 - i of the other, turned backwards. The inverse of a row of the
/// standard convention is one of the modified convention.
inline DhChain<6, ModifiedDh> mirror_image(const DhChain<6>& arm) {
  std::array<DhRow, 6> rows;
  for (int i = 0; i < 6; ++i) {
    const DhRow& row = arm.row(5 - i);
    rows[static_cast<std::size_t>(i)] = {.a = -row.a, .alpha = -row.alpha, .d = -row.d, .theta = -row.theta};
  }
  return DhChain<6, ModifiedDh>::from_rows(rows);
}

template <class Arm>
ClosedFormArm internals(const Arm& arm) {
  return {vernier::detail::six_axes_of(arm, {-1, 0}), 1e-6};
}

/// Calls `f(name, chain)` for all arms and their mirror images.
template <class F>
void for_all_arms(const F& f) {
  for (const Case& arm : cases()) {
    f(arm.name, arm.chain);
    f(arm.name + ", mirrored", mirror_image(arm.chain));
  }
}

}  // namespace vernier_test::closed_forms
