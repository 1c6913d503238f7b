// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows of a chain from the axes of its joints.

#include <span>
#include <vector>

#include "vernier/kinematics/dh.hpp"

namespace vernier::detail {

/// The axis of a joint where all joints are zero, base frame.
struct JointAxis {
  Vector3 direction;                     ///< unit vector
  Vector3 point;                         ///< on the axis [m]; any for a prismatic joint
  JointType type = JointType::revolute;  ///< of the joint
};

/// Rows of the standard convention with the frames in which they stand.
struct AxisRows {
  Isometry3 base;                   ///< frame of the first row
  std::vector<DhRow> rows{};        ///< one a joint; the last one is zero
  std::vector<Isometry3> frames{};  ///< base_T_row of each joint where all joints are zero, theta of its row included:
                                    ///< z along its axis
};

/// The rows of a chain whose joints move about (along) axes, exact for any axes. A joint next to a nearly parallel one
/// (or one turned over; below 0.2 rad) has d = 0 and Hayati's beta, every other one beta = 0. What is behind the last
/// joint is not part of them.
/// @param axes   one a joint
/// @param thetas where given, one a joint: of the two rows that describe the same (theta half a turn apart, signs of a
///               and alpha changed), the one next to this angle is taken; else the one next to zero, a > 0 where both
///               are as near
/// @cite Denavit and Hartenberg 1955; Hayati and Mirmirani 1985
VERNIER_API AxisRows rows_of_axes(std::span<const JointAxis> axes, std::span<const double> thetas = {});

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/rows_of_axes.ipp"
#endif
