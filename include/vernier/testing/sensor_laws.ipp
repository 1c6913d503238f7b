// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/testing/sensor_laws.hpp"

namespace vernier::testing::detail {

VERNIER_IMPL std::vector<std::string> set_violations(MeasuredSet set, std::span<const Isometry3> poses) {
  std::vector<std::string> out;
  const auto complain = [&](const std::string& law) {
    const std::string line = "sensor: " + law;
    if (std::find(out.begin(), out.end(), line) == out.end()) out.push_back(line);
  };
  const Isometry3 base = set.register_base(poses);
  const Index values = set.values();
  SensedRows first, again, moved;
  for (Index i = 0; i < set.size(); ++i) {
    const Isometry3 there = composed(base, poses[static_cast<std::size_t>(i)]);
    set.sense(i, there, first);
    set.sense(i, there, again);
    if (first.residual != again.residual || first.motion != again.motion) complain("another answer to the same pose");
    for (Index r = 0; r < 6; ++r) {
      const double scale = r < 3 ? set.sigma().length : set.sigma().angle;
      if (r >= values && !same_value(first.residual(r), 0)) complain("a residual in a row that it does not measure");
      if (r < values && !(std::abs(first.residual(r)) <= 1e-6 * scale + 1e-9))
        complain("base_from() leaves residuals of exact measurements");
    }
    // derivatives, beside the registered pose as well as at it
    for (const double off : {0.0, 0.01}) {
      Vector6 aside = Vector6::Zero();
      for (Index k = 0; k < 6; ++k) aside(k) = off * static_cast<double>(k + 1) / 6;
      const Isometry3 at = vernier::detail::shifted(there, aside);
      set.sense(i, at, first);
      for (Index k = 0; k < 6; ++k) {
        constexpr double h = 1e-6;
        Vector6 step = Vector6::Zero();
        step(k) = h;
        set.sense(i, vernier::detail::shifted(at, step), moved);
        step(k) = -h;
        set.sense(i, vernier::detail::shifted(at, step), again);
        for (Index r = 0; r < 6; ++r) {
          const double slope = (moved.residual(r) - again.residual(r)) / (2 * h);
          if (!(std::abs(slope - first.motion(r, k)) <= 1e-5 * (1 + std::abs(slope))))
            complain(message("motion is not the derivative of the residual: row ", r, " by ",
                             k < 3 ? "a shift along " : "a rotation about ", "xyz"[k % 3]));
        }
      }
    }
  }
  return out;
}

VERNIER_IMPL Index frame_rank(MeasuredSet set, std::span<const Isometry3> poses, bool all) {
  const Vector6 base = FrameParameters(set.register_base(poses)).values();
  std::vector<Index> parameters;
  for (Index k = 0; k < 6; ++k)
    if (all || set.unknown_frame()[static_cast<std::size_t>(k)]) parameters.push_back(k);
  const Index values = set.values();
  MatrixX effects(values * set.size(), static_cast<Index>(parameters.size()));
  SensedRows up, down;
  for (Index c = 0; c < effects.cols(); ++c) {
    constexpr double h = 1e-5;
    Vector6 step = base, back = base;
    step(parameters[static_cast<std::size_t>(c)]) += h;
    back(parameters[static_cast<std::size_t>(c)]) -= h;
    const Isometry3 above = FrameParameters(step).isometry(), below = FrameParameters(back).isometry();
    for (Index i = 0; i < set.size(); ++i) {
      const Isometry3& pose = poses[static_cast<std::size_t>(i)];
      set.sense(i, composed(above, pose), up);
      set.sense(i, composed(below, pose), down);
      for (Index r = 0; r < values; ++r) effects(values * i + r, c) = (up.residual(r) - down.residual(r)) / (2 * h);
    }
  }
  if (effects.cols() == 0) return 0;
  const VectorX spectrum = vernier::detail::right_singular(effects).values;
  return static_cast<Index>(std::count_if(spectrum.begin(), spectrum.end(),
                                          [&](double value) { return value > 1e-6 * spectrum(0) && value > 0; }));
}

}  // namespace vernier::testing::detail
