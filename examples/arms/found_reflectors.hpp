// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where the reflectors of a calibration are on the flange.

#include <cmath>
#include <string>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/io/report_input.hpp"

namespace support {

/// A reflector on the flange.
struct FoundReflector {
  std::string name;         ///< the set of poses that measured it
  vernier::Index rows = 0;  ///< number of poses it was fitted to
  vernier::Vector3 offset;  ///< its place in the frame of the flange [m]
  vernier::Vector3 std;     ///< standard deviations [m]; 0 where it was not estimated
};

/// The tools of sets that have their own.
template <class Chain>
std::vector<FoundReflector> reflectors_of(const vernier::Calibration<Chain>& calibration,
                                          const vernier::Measurements<Chain::dof>& measured) {
  std::vector<FoundReflector> out;
  const vernier::Index tool = vernier::ArmParameters::chain_end(Chain::dof);
  for (std::size_t s = 0; s < measured.poses().size(); ++s) {
    FoundReflector one{measured.sets()[s].name, measured.poses()[s].size(),
                       calibration.model(s).identified().tool().translation(), vernier::Vector3::Zero()};
    const vernier::ErrorModelEstimate estimate = calibration.errors.of_station(static_cast<int>(s));
    const auto& unknowns = estimate.arm.geometric();
    for (std::size_t k = 0; k < unknowns.size() && estimate.covariance.size() > 0; ++k)
      if (const vernier::Index axis = unknowns[k].parameter - tool; axis >= 0 && axis < 3 && !unknowns[k].thermal) {
        const auto at = static_cast<vernier::Index>(k);
        one.std(axis) = unknowns[k].scale * std::sqrt(estimate.covariance(at, at));
      }
    out.push_back(std::move(one));
  }
  return out;
}

/// What a page shows of reflectors.
inline vernier::ReportTable reflector_table(const std::vector<FoundReflector>& reflectors) {
  vernier::ReportTable out{.title = "Reflectors",
                           .note = "Where each measured point is in the frame of the flange, with standard deviations.",
                           .head = {"measured", "poses", "x [mm]", "y [mm]", "z [mm]", "std [mm]"}};
  const auto mm = [](double value) { return vernier::detail::fixed_digits(value * 1e3, 3); };
  for (const FoundReflector& one : reflectors)
    out.rows.push_back({one.name, std::to_string(one.rows), mm(one.offset.x()), mm(one.offset.y()), mm(one.offset.z()),
                        mm(one.std.x()) + ", " + mm(one.std.y()) + ", " + mm(one.std.z())});
  return out;
}

}  // namespace support
