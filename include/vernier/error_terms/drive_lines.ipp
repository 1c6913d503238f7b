// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/error_terms/drive_lines.hpp"

namespace vernier {

namespace detail {

/// Errors of a strain-wave gear a turn of its input; 2 and 4 by the ellipse of the wave generator.
inline constexpr std::array<int, 9> periods_of_input{1, 2, 4, 5, 8, 10, 12, 20, 24};

/// What of a drive errs at an order.
VERNIER_LOCAL std::string source_at(int order, const JointDrive& drive) {
  if (drive.encoder_periods > 0)
    for (const int multiple : {1, 2})
      if (std::abs(order - multiple * drive.encoder_periods) <= 1)
        return message(multiple == 1 ? "the period" : "half the period", " of an encoder of ", drive.encoder_periods,
                       " periods a turn");
  if (drive.gear_ratio > 0)
    for (const int periods : periods_of_input)
      if (std::abs(order - periods * drive.gear_ratio) <= 1.5)
        return message(periods, " a turn of a ", drive.gear_ratio, ":1 gear");
  return {};
}

}  // namespace detail

VERNIER_IMPL HarmonicSpectrum lines_of(const JointDrive& drive) {
  HarmonicSpectrum out;
  if (const int n = drive.encoder_periods; n > 0) {
    out.push_back({(std::max)(1, n - 2), n + 2, 10e-6});
    out.push_back({(std::max)(1, 2 * n - 2), 2 * n + 2, 6e-6});
  }
  for (const int periods : {2, 4, 5, 8, 10, 12, 20, 24}) {
    const int order = static_cast<int>(std::lround(periods * drive.gear_ratio));
    const int width = periods == 4 ? 4 : 1;  // the largest; over a part of a turn it spreads
    if (order > 140 && order <= 2500) out.push_back({order - width, order + width, periods == 4 ? 12e-6 : 7e-6});
  }
  return out;
}

VERNIER_IMPL std::string cause_of(int order, const JointDrive& drive) {
  if (order == 1) return "once a turn: an eccentric encoder or gear";
  if (order == 2) return "twice a turn: an oval encoder or gear";
  if (const std::string stated = detail::source_at(order, drive); !stated.empty()) return stated;
  JointDrive typical;
  if (drive.encoder_periods == 0) typical.encoder_periods = 128;
  if (same_value(drive.gear_ratio, 0)) typical.gear_ratio = 101;
  const std::string source = detail::source_at(order, typical);
  return source.empty() ? source : "probably " + source;
}

}  // namespace vernier
