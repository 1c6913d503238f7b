// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Inverse kinematics of six revolute joints whose axes lie anyhow.

#include "vernier/kinematics/detail/six_axes.hpp"
#include "vernier/kinematics/singularities.hpp"

namespace vernier::detail {

/// All joint values that bring an arm's tool to a target, for any axes: parallel, intersecting or neither.
///
/// One joint is hidden, the others are eliminated, its values are eigenvalues, and damped Newton steps on the pose end
/// each candidate: residual below 1e-10 rad, and lengths in units of the arm. Joint 4 is hidden first. Where the
/// elimination is conditioned badly, or a real eigenvalue does not lead to a root of its own (as when two roots share
/// the hidden joint's value), another joint is, and the roots found are united. Always the same bits; does not
/// allocate.
///
/// May be lost: one of two roots within about 1e-4 rad of each other, where the arm is all but singular. An arm that
/// can move with its tool at rest has no isolated roots; then up to 16 points of that motion are found.
/// @param arm    lengths in any unit, the same as the target's
/// @param target base_T_tool
/// @return       roots more than 1e-5 rad apart, margins 0; `condition` is the least of the eliminations made, infinite
///               where there was none
/// @cite Raghavan and Roth 1993; Manocha and Canny 1994
VERNIER_API SixAxisRoots solve_six_axes(const SixAxes& arm, const Isometry3& target) noexcept;

/// The determinant of the Jacobian over the product of its columns' lengths.
VERNIER_API SingularityDistances unfactored_distance(const SixAxes& arm, const JointVector<6>& q) noexcept;

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/general_six_axis.ipp"
#endif
