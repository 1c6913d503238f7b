// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A catalogue of nominal arms. Tables are the makers' or the literature's nominal values.

#include <array>
#include <numbers>
#include <string>
#include <string_view>

#include "vernier/core/controller_map.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/joint_drive.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

/// A nominal arm: its chain, its joint limits and its name in the catalogue. Functions that take a `NominalArm` take it
/// as they take its chain.
template <int N, class Convention = StandardDh>
struct Robot {
  /// Number of joints.
  static constexpr int dof = N;

  /// The nominal chain.
  DhChain<N, Convention> chain;
  /// Joint limits, of the controller's joints.
  JointLimits<N> limits;
  /// Name in the catalogue.
  std::string_view name;
  /// Gears and encoders of the joints, as far as they are known.
  std::array<JointDrive, N> drives{};
  /// How the chain's joints follow from those of the controller.
  ControllerMap controller{};
};

namespace detail {

/// Limits from degrees.
template <int N>
JointLimits<N> limits_deg(const double (&lower)[N], const double (&upper)[N]) {
  constexpr double degree = std::numbers::pi / 180;
  JointLimits<N> out;
  for (int j = 0; j < N; ++j) {
    out.lower(j) = lower[j] * degree;
    out.upper(j) = upper[j] * degree;
  }
  return out;
}

/// The map of some formulas.
inline ControllerMap controller_map(const std::array<std::string, 6>& formulas) { return ControllerMap(formulas); }

}  // namespace detail

/// The arms of the catalogue.
namespace robots {

using namespace vernier::literals;

/// ABB IRB 120-3/0.6: the small six-axis arm of the paper's experiment.
VERNIER_API inline Robot<6> abb_irb120() {
  constexpr VERNIER_LATER_TYPE(DhChain<6>) chain{{{
      {.a = 0_mm, .alpha = -90_deg, .d = 290_mm, .theta = 0_deg},
      {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 70_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = 90_deg, .d = 302_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg},
  }}};
  return {chain, detail::limits_deg<6>({-165, -110, -110, -160, -120, -400}, {165, 110, 70, 160, 120, 400}),
          "abb_irb120"};
}

/// Universal Robots UR10 (CB series).
VERNIER_API inline Robot<6> ur10() {
  constexpr VERNIER_LATER_TYPE(DhChain<6>) chain{{{
      {.a = 0_mm, .alpha = 90_deg, .d = 127.3_mm},
      {.a = -612_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = -572.3_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 163.941_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 115.7_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 92.2_mm},
  }}};
  return {chain, detail::limits_deg<6>({-360, -360, -360, -360, -360, -360}, {360, 360, 360, 360, 360, 360}), "ur10"};
}

/// Universal Robots UR5 (CB series).
VERNIER_API inline Robot<6> ur5() {
  constexpr VERNIER_LATER_TYPE(DhChain<6>) chain{{{
      {.a = 0_mm, .alpha = 90_deg, .d = 89.159_mm},
      {.a = -425_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = -392.25_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 109.15_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 94.65_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 82.3_mm},
  }}};
  return {chain, detail::limits_deg<6>({-360, -360, -360, -360, -360, -360}, {360, 360, 360, 360, 360, 360}), "ur5"};
}

/// Barrett WAM, seven joints, cable-driven.
VERNIER_API inline Robot<7> barrett_wam() {
  constexpr VERNIER_LATER_TYPE(DhChain<7>) chain{{{
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 45_mm, .alpha = -90_deg, .d = 550_mm},
      {.a = -45_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 300_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 60_mm},
  }}};
  return {
      chain,
      {JointVector<7>{-2.6, -2.0, -2.8, -0.9, -4.76, -1.6, -3.0}, JointVector<7>{2.6, 2.0, 2.8, 3.1, 1.24, 1.6, 3.0}},
      "barrett_wam"};
}

namespace detail {

VERNIER_API inline JointLimits<6> puma560_limits() {
  return vernier::detail::limits_deg<6>({-160, -45, -225, -110, -100, -266}, {160, 225, 45, 170, 100, 266});
}

}  // namespace detail

/// Unimation PUMA 560, standard convention.
/// @cite Corke 2011
VERNIER_API inline Robot<6> puma560() {
  constexpr VERNIER_LATER_TYPE(DhChain<6>) chain{{{
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 431.8_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 20.3_mm, .alpha = -90_deg, .d = 150.05_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 431.8_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 0_mm},
  }}};
  return {chain, detail::puma560_limits(), "puma560"};
}

/// The PUMA 560 in the modified convention: every pose equals that of `puma560()`.
VERNIER_API inline Robot<6, ModifiedDh> puma560_modified() {
  constexpr VERNIER_LATER_TYPE(DhChain<6, ModifiedDh>) chain{{{
      {.a = 0_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 431.8_mm, .alpha = 0_deg, .d = 150.05_mm},
      {.a = 20.3_mm, .alpha = -90_deg, .d = 431.8_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
  }}};
  return {chain, detail::puma560_limits(), "puma560_modified"};
}

/// FANUC R-2000iB/165F. Its base frame is the controller's, at the height of joint 2; joint 3 is counted from the
/// horizontal.
inline Robot<6> fanuc_r2000ib_165f() {
  constexpr DhChain<6> chain{{{
      {.a = 312_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 1075_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 225_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 1280_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 215_mm},
  }}};
  return {chain,
          vernier::detail::limits_deg<6>({-180, -60, -132, -360, -125, -360}, {180, 76, 230, 360, 125, 360}),
          "fanuc_r2000ib_165f",
          {},
          vernier::detail::controller_map({"J1", "J2", "-J2 - J3", "-J4", "-J5", "-J6"})};
}

/// KUKA KR 6 R900 sixx (Agilus). Joints 1, 4 and 6 turn the other way than its frames.
inline Robot<6> kuka_kr6_r900() {
  constexpr DhChain<6> chain{{{
      {.a = 25_mm, .alpha = -90_deg, .d = 400_mm},
      {.a = 455_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 35_mm, .alpha = -90_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 0_mm, .alpha = 90_deg, .d = 420_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 80_mm, .theta = 180_deg},
  }}};
  return {chain,
          vernier::detail::limits_deg<6>({-170, -190, -120, -185, -120, -350}, {170, 45, 156, 185, 120, 350}),
          "kuka_kr6_r900",
          {},
          vernier::detail::controller_map({"-J1", "J2", "J3", "-J4", "J5", "-J6"})};
}

}  // namespace robots
}  // namespace vernier
