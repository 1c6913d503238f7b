#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/calibration/detail/wording.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

/// Root of the mean squared distance from the mean of points [m].
VERNIER_API double point_spread(const PointRows& points) {
  const VectorX distances = distances_from(points, centroid(points));
  return std::sqrt(distances.squaredNorm() / static_cast<double>(points.rows()));
}

VERNIER_IMPL void require_plausible(const ArmGeometry& nominal, const Station& poses, double frames_rms,
                                    const std::string& arm, const std::string& data) {
  const double expected = point_spread(nominal.positions(poses.joints())), measured = point_spread(*poses.positions);
  const double limit = std::min(0.05, 0.1 * std::max(expected, measured));
  if (frames_rms <= std::max(limit, 1e-3)) return;  // an arm that did not move is another matter
  std::string hint = "wrong robot, units or columns?";
  const double ratio = measured / expected;
  double largest = 0;
  for (int i = 0; i < nominal.joints(); ++i)
    for (Index row = 0; nominal.chain().revolute(i) && row < poses.size(); ++row)
      largest = std::max(largest, std::abs(poses.joints()(row, i)));
  if (largest > 15)
    hint = "a joint of " + brief(largest) + " rad looks like degrees in a _rad column";
  else if (largest < 0.15)
    hint = "no joint exceeds " + brief(largest) + " rad: radians in a _deg column?";
  else if (ratio > 300)
    hint = "the measured positions spread " + brief(ratio) + " times as wide as the arm's: x, y, z in mm called _m?";
  else if (ratio < 1.0 / 300)
    hint = "the arm's positions spread " + brief(1 / ratio) +
           " times as wide as the measured ones: x, y, z in m called _mm?";
  throw CalibrationFailure(data + ": with registered frames the model of " + arm + " is off by " +
                           brief(frames_rms * 1e3) + " mm (rms): " + hint);
}

VERNIER_IMPL void require_plausible_distances(const ArmGeometry& registered, const Station& distances,
                                              const std::string& data) {
  const PointRows points = registered.positions(distances.joints());
  const Vector3 fixed_point = trilaterate(points, *distances.lengths);
  const VectorX off = distances_from(points, fixed_point) - *distances.lengths;
  const double rms = std::sqrt(off.squaredNorm() / static_cast<double>(points.rows()));
  if (!(rms <= 0.05))
    throw CalibrationFailure(data + ": no fixed point is consistent with these distances, the best one is off by " +
                             brief(rms * 1e3) + " mm (rms): wrong units, columns or rows?");
}

VERNIER_IMPL void require_plausible_contact(const ArmGeometry& registered, const Contact& contact) {
  Station station = station_of(contact, {});
  const PointRows points = contact_arm(registered, contact, station).positions(contact.joints());
  double sum = 0;
  for (Index i = 0; i < points.rows(); ++i) {
    const Vector3 tool = point(points, i);
    const double off = station.lengths != nullptr ? tool.norm() - (*station.lengths)(i)
                       : station.projected()      ? tool.z() - station.height(i)
                                                  : (tool - station.position(i)).norm();
    sum += off * off;
  }
  const double rms = std::sqrt(sum / static_cast<double>(points.rows()));
  if (!(rms <= 0.02))
    throw CalibrationFailure("contact " + contact.name() + ": the tool point of the poses misses it by " +
                             brief(rms * 1e3) + " mm (rms): another tool point, wrong units, columns or rows?");
}

VERNIER_IMPL void require_usable(const IdentificationReport& report, const std::string& step) {
  if (report.status == IdentifyStatus::underdetermined)
    throw CalibrationFailure(step + " is underdetermined: " + report.message +
                             "; measure more poses, with every joint moved widely, or fix parameters");
  if (report.status == IdentifyStatus::not_converged)
    throw CalibrationFailure(step + " did not converge: " + report.message +
                             "; look for outliers, wrong units or a wrong robot");
}

}  // namespace vernier::detail
