#pragma once

/// @file
/// Registration of base and tool frames in closed form.

#include "vernier/core/register_points.hpp"
#include "vernier/identification/detail/station.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// The fixed point at given distances from points, by linear least squares on squared distances. Points on a plane
/// leave open on which side of it the fixed point lies: then it is put on the plane.
/// @param points    n >= 1 rows
/// @param distances n values
/// @throws std::invalid_argument when the numbers differ
VERNIER_API Vector3 trilaterate(const PointRows& points, const VectorX& distances);

namespace detail {

/// See `vernier::starting_frames`.
VERNIER_API ArmGeometry starting_frames(const ArmGeometry& nominal, const Station& data, bool fit_base, bool fit_tool);

}  // namespace detail

/// Base and tool frames that roughly fit the data with the nominal chain: the base by registering positions with the
/// present tool point, the tool point by linear least squares, alternating; the tool's rotation as the mean over the
/// orientations. From distances: the base translated so that its origin is the fixed point. A start for `identify`.
/// @param nominal  the arm in known, or guessed, frames
/// @param data     n >= 1 samples, a `Dataset` or `Distances`
/// @param fit_base whether the base is unknown
/// @param fit_tool whether the tool is unknown
template <NominalArm Arm, class Data>
Framed<ChainOf<Arm>> starting_frames(const Arm& nominal, const Data& data, bool fit_base, bool fit_tool) {
  const Framed<ChainOf<Arm>> arm = in_frames(nominal);
  return detail::starting_frames(ArmGeometry(arm), detail::station_of(data, {}), fit_base, fit_tool)
      .framed(arm.model());
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/frames.ipp"
#endif
