// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

/// Root of the mean squared distance from the mean of points [m].
VERNIER_LOCAL double point_spread(const PointRows& points) {
  const VectorX distances = distances_from(points, centroid(points));
  return std::sqrt(distances.squaredNorm() / static_cast<double>(points.rows()));
}

VERNIER_IMPL void require_plausible(const ArmGeometry& nominal, const MeasuredSet& poses, double frames_rms,
                                    const std::string& arm) {
  const double expected = point_spread(nominal.positions(poses.joints)), measured = point_spread(*poses.positions());
  const double limit = (std::min)(0.05, 0.1 * (std::max)(expected, measured));
  if (frames_rms <= (std::max)(limit, 1e-3)) return;  // an arm that did not move is another matter
  std::string hint = "wrong robot, units or columns?";
  const double ratio = measured / expected;
  double largest = 0;
  for (int i = 0; i < nominal.joints(); ++i)
    for (Index row = 0; nominal.chain().revolute(i) && row < poses.size(); ++row)
      largest = (std::max)(largest, std::abs(poses.joints(row, i)));
  if (largest > 15)
    hint = "a joint of " + brief(largest) + " rad looks like degrees in a _rad column";
  else if (largest < 0.15)
    hint = "no joint exceeds " + brief(largest) + " rad: radians in a _deg column?";
  else if (ratio > 300)
    hint = "the measured positions spread " + brief(ratio) + " times as wide as the arm's: x, y, z in mm called _m?";
  else if (ratio < 1.0 / 300)
    hint = "the arm's positions spread " + brief(1 / ratio) +
           " times as wide as the measured ones: x, y, z in m called _mm?";
  throw CalibrationFailure(poses.name + ": with registered frames the model of " + arm + " is off by " +
                           brief(frames_rms * 1e3) + " mm (rms): " + hint);
}

VERNIER_IMPL void require_plausible_set(const ArmGeometry& registered, MeasuredSet set) {
  if (set.seen_from.rows() > 0) return;
  const std::vector<Isometry3> poses = placed(registered, set).poses(set.joints);
  SensedRows sensed;
  double sum = 0;
  for (Index i = 0; i < set.size(); ++i) {
    set.sense(i, poses[static_cast<std::size_t>(i)], sensed);
    sum += VERNIER_LATER(sensed.residual).template head<3>().squaredNorm();
  }
  const double rms = std::sqrt(sum / static_cast<double>(set.size()));
  if (!(rms <= set.plausibility().rms))
    throw CalibrationFailure(message(set.name, ": ", set.plausibility().complaint, ' ', brief(rms * 1e3),
                                     " mm (rms): ", set.plausibility().causes));
}

VERNIER_IMPL void require_usable(const IdentificationReport& report, const std::string& step) {
  if (report.too_few)
    throw CalibrationFailure(step + " is underdetermined: " + report.message +
                             "; measure more poses, with every joint moved widely, or fix parameters");
  if (report.status == IdentifyStatus::not_converged)
    throw CalibrationFailure(step + " did not converge: " + report.message +
                             "; look for outliers, wrong units or a wrong robot");
}

}  // namespace vernier::detail
