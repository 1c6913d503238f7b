// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Registration of base and tool frames in closed form.

#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

namespace detail {

/// `vernier::starting_frames` for an arm whose number of joints is known at run time.
VERNIER_API ArmGeometry starting_frames(const ArmGeometry& nominal, const MeasuredSet& data, bool fit_base,
                                        bool fit_tool);
/// An arm in the frame of a set, as its present geometry says; its own base frame is not used.
VERNIER_API ArmGeometry placed(const ArmGeometry& arm, MeasuredSet& set);

}  // namespace detail

/// Base and tool frames that roughly fit the data with the nominal chain: the base by registering positions with the
/// present tool point, the tool point by linear least squares, alternating; the tool's rotation as the mean over the
/// orientations. From distances: the base translated so that its origin is the fixed point. A start for `identify`.
/// @param nominal  the arm in known, or guessed, frames
/// @param data     n >= 1 measurements from one place
/// @param fit_base whether the base is unknown
/// @param fit_tool whether the tool is unknown
template <NominalArm Arm>
Framed<ChainOf<Arm>> starting_frames(const Arm& nominal, const Measurements<ChainOf<Arm>::dof>& data, bool fit_base,
                                     bool fit_tool) {
  const Framed<ChainOf<Arm>> arm = in_frames(nominal);
  demand(data.sets().size() == 1, "starting_frames: ", data.sets().size(), " sets of measurements, one is needed");
  return detail::starting_frames(ArmGeometry(arm), data.sets().front(), fit_base, fit_tool).framed(arm.model());
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/frames.ipp"
#endif
