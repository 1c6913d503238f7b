// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Base and tool of any kinematic model, from measured poses.

#include <span>
#include <vector>

#include "vernier/data/dataset.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

namespace detail {

/// Base and tool that bring flanges closest to what a sensor measured.
struct RegisteredFrames {
  FrameParameters base, tool;
};

/// @param flanges      poses of the flange in the model's base frame
/// @param positions    of the tool point in the sensor's frame [m], a row each
/// @param orientations of the tool as rotation vectors [rad], a row each; no rows where none were measured
/// @throws std::invalid_argument on fewer than six poses
VERNIER_API RegisteredFrames register_flanges(std::span<const Isometry3> flanges, const PointRows& positions,
                                              const PointRows& orientations);

}  // namespace detail

/// A model between the base and the tool point with which it predicts measured positions best, by least squares. The
/// tool's axes follow the measured orientations on average; they are the flange's where none were measured. If the
/// flange turns about one direction alone, the tool point has no offset along it: the base has it. The prior behind
/// that costs less than a micrometre where the offset is determined.
/// @param model any arm, whose own base need not be the sensor's frame
/// @param data  six poses at least
/// @throws std::invalid_argument on fewer
template <KinematicModel Model>
Framed<Model> register_frames(const Model& model, const Dataset<Model::dof>& data) {
  const std::vector<Isometry3> flanges = poses(model, data.joints());
  const detail::RegisteredFrames found = detail::register_flanges(flanges, data.positions(), data.orientations());
  return Framed<Model>(model, found.base, found.tool);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/registration/register_frames.ipp"
#endif
