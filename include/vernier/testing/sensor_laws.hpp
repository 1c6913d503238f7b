// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The laws of `Sensor`, checked at run time: a list of violations.

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::testing {

namespace detail {

/// Checks one set. Not a template on the sensor.
VERNIER_API std::vector<std::string> set_violations(MeasuredSet set, std::span<const Isometry3> poses);
/// How many parameters of the base frame have an effect of their own on a set's measurements.
/// @param all whether all six are counted, or those that `unknown_frame` names
VERNIER_API Index frame_rank(MeasuredSet set, std::span<const Isometry3> poses, bool all);

}  // namespace detail

/// Violations of the laws of sensors:
/// - the residual at a pose does not change from call to call, and rows that are not measured are zero;
/// - `base_from` brings exact measurements to residuals of zero;
/// - `motion` is the derivative of the residual by shifts and rotations of the pose;
/// - each parameter of the frame that `unknown_frame` names has an effect of its own;
/// - the others have none beside these, unless they are known.
/// @param sensor with exact measurements of `poses`
/// @param poses  of the tool point in the arm's base frame, wherever that stands in the sensor's; many, and spread
/// @param known  whether parameters of the frame that `unknown_frame` leaves out are known, and not without effect
template <Sensor S>
std::vector<std::string> sensor_violations(const S& sensor, std::span<const Isometry3> poses, bool known = false) {
  const auto n = static_cast<Index>(poses.size());
  std::vector<std::string> out;
  if (static_cast<Index>(sensor.size()) != n)
    return {message("sensor: size() is ", sensor.size(), " of ", n, " poses")};
  MeasuredSet set("sensor", MatrixX::Zero(n, 1), sensor);
  out = detail::set_violations(set, poses);
  const Index effect = detail::frame_rank(set, poses, false), of_all = detail::frame_rank(set, poses, true);
  Index unknown = 0;
  for (const bool free : set.unknown_frame()) unknown += free;
  if (effect < unknown)
    out.push_back(
        message("sensor: unknown_frame() has ", unknown, " parameters, of which ", effect, " have an effect"));
  if (!known && of_all > effect)
    out.push_back(message("sensor: parameters of its frame that unknown_frame() leaves out have an effect"));
  return out;
}

}  // namespace vernier::testing

#if VERNIER_HEADER_ONLY
#include "vernier/testing/sensor_laws.ipp"
#endif
