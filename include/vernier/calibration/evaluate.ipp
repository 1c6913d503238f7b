// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/calibration/evaluate.hpp"

namespace vernier::detail {

VERNIER_IMPL bool payload_matters(const JointErrors& errors) {
  for (const JointTermBlock& block : errors.terms().blocks())
    for (Index k = 0; block.kind == JointTermBlock::Kind::payload && k < block.count; ++k)
      if (std::abs(errors.coefficients()(block.begin + k)) > 1e-9) return true;  // tens of nanometres
  return false;
}

VERNIER_IMPL std::vector<std::pair<double, double>> within_limits(
    const std::vector<JointRange>& ranges, const std::vector<std::pair<double, double>>& measured, double lower,
    double upper) {
  if (!measured.empty()) {
    lower = (std::min)(lower, measured.front().first);
    upper = (std::max)(upper, measured.back().second);
  }
  std::vector<std::pair<double, double>> out;
  for (const JointRange& range : ranges)
    out.emplace_back((std::max)(range.lower, lower), (std::min)(range.upper, upper));
  return out;
}

VERNIER_IMPL void describe_transmission(const ErrorModelEstimate& estimate, int joint, JointReport& out) {
  for (const auto& [lower, upper] : out.measured_ranges) {
    const int samples = (std::max)(360, static_cast<int>(200 * (upper - lower)));  // three a period of order 404
    for (int k = 0; k <= samples; ++k) out.angle.push_back(lower + (upper - lower) * k / samples);
  }
  if (out.angle.empty()) return;
  out.spectrum = joint_spectrum(estimate, joint);
  Index trials = 0;
  for (const Fourier& fourier : estimate.arm.terms().transmission) trials += fourier.size() / 2;
  out.lines = lines_in(out.spectrum, line_threshold(trials));
  if (!estimate.drives.empty()) out.drive = estimate.drives[static_cast<std::size_t>(joint)];
  JointFunction f = estimate.transmission(joint, out.angle);
  out.transmission = std::move(f.value);
  out.transmission_std = std::move(f.std);
}

}  // namespace vernier::detail
