// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How far an arm's touches of an object are off: of an object that it was not identified from, a test.

#include <limits>
#include <string>

#include "vernier/data/contacts.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// Touches of an object by an arm that is known. The object is where it fits them best, by least squares.
struct ObjectErrors {
  std::string name;                    ///< of the object
  ContactKind kind;                    ///< what it is
  VectorX distances;                   ///< of each touch: across the face or ball, or from the socket [m]
  PointRows points = PointRows(0, 3);  ///< touches in the arm's base frame, n x 3 [m]
  /// The longest known length as the arm measures it, less what is known [m]: between sockets or faces, or the radius
  /// of a ball. NaN for an object without a length, or where touches do not determine it.
  double length_error = std::numeric_limits<double>::quiet_NaN();

  /// Root mean square of the distances [m].
  VERNIER_API double rms() const;
};

/// Errors of touches.
/// @param arm     with its tool point, in any base frame
/// @param contact touches of one object
/// @throws std::invalid_argument for another number of joints
VERNIER_API ObjectErrors object_errors(const ArmGeometry& arm, const Contact& contact);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/object_errors.ipp"
#endif
