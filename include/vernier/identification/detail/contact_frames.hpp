#pragma once

/// @file
/// Where touched objects are: the frame of each, in which the arm that touches it stands.

#include <vector>

#include "vernier/identification/detail/station.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier::detail {

/// The parameters of the base frame of a contact's station that are unknown: of a plane its height and two rotations,
/// of a ball or a socket its position, of a bar also two rotations.
VERNIER_API std::vector<Index> contact_unknowns(const Contact& contact);

/// An arm in the frame of what it touches, as its present geometry says.
/// @param arm     its base frame is not used
/// @param contact the touches
/// @param station the same as a station; its `height_sign` is set so that the frame turns by at most a right angle
VERNIER_API ArmGeometry contact_arm(const ArmGeometry& arm, const Contact& contact, Station& station);

/// Requires that the touches of a plane are spread over it, and not along a line.
/// @param arm as `contact_arm` returns it
/// @throws std::invalid_argument naming the contact
VERNIER_API void require_spread(const ArmGeometry& arm, const Contact& contact);

/// Joint values, the nearest ones, at which touches lie on their object exactly.
/// @param arm of a station, in its frame
VERNIER_API MatrixX touching_joints(const ArmGeometry& arm, const Station& station);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/contact_frames.ipp"
#endif
