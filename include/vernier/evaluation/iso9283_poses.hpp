// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The poses of an ISO 9283 test.

#include <array>
#include <optional>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A cube with edges parallel to the axes of the robot's base.
struct Iso9283Cube {
  Vector3 centre = Vector3::Zero();  ///< [m]
  double edge = 1;                   ///< length of an edge [m]
};

/// The five poses P1 to P5 of a cube, all of one orientation: P1 at its centre, P2 to P5 in one of its diagonal planes,
/// 10 % of the cube's diagonal from its corners. P2 and P4 are on one diagonal, P3 and P5 on the other. Of corners
/// C1 to C4 above, counterclockwise from (+x, +y), and C5 to C8 below them, the planes are
///
///     1  C1 C2 C7 C8      2  C2 C3 C8 C5      3  C3 C4 C5 C6      4  C4 C1 C6 C7
///
/// with P2 at the first corner, P3 at the second, and so on.
/// @param cube        see there
/// @param orientation of the tool
/// @param plane       1 to 4
/// @throws std::invalid_argument unless the edge is positive, the orientation a rotation, the plane 1 to 4
/// @cite ISO 9283
VERNIER_API std::array<Isometry3, 5> iso9283_poses(const Iso9283Cube& cube,
                                                   const Matrix3& orientation = Matrix3::Identity(), int plane = 1);

/// The largest cube within a box of which `reachable` accepts the five poses, to about 2 % of the box: edges of 1/50,
/// 2/50, ... of its shortest side are tried, the longest first, each at 9 x 9 x 9 places; of several places of one edge
/// the one nearest to the middle of the box. Empty where none is.
/// @param lower,upper corners of the box, the most used part of the working space [m]
/// @param reachable   whether the tool can stand at a pose, e.g. by inverse kinematics within the joint limits
/// @param orientation of the tool
/// @param plane       1 to 4, see `iso9283_poses`
/// @throws std::invalid_argument unless lower < upper; as `iso9283_poses`
VERNIER_API std::optional<Iso9283Cube> largest_iso9283_cube(const Vector3& lower, const Vector3& upper,
                                                            FunctionRef<bool(const Isometry3&)> reachable,
                                                            const Matrix3& orientation = Matrix3::Identity(),
                                                            int plane = 1);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/iso9283_poses.ipp"
#endif
