// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/kinematics/dh.hpp"

namespace vernier::detail {

VERNIER_IMPL [[noreturn]] void length_above_100_m_is_the_unit_right(int row, const char* name, double value) {
  throw std::invalid_argument(
      message("DhChain: row ", row, ": ", name, " is a length of ", value, " m; is the unit right?"));
}

VERNIER_IMPL [[noreturn]] void angle_above_100_rad_is_the_unit_right(int row, const char* name, double value) {
  throw std::invalid_argument(
      message("DhChain: row ", row, ": ", name, " is an angle of ", value, " rad; is the unit right?"));
}

}  // namespace vernier::detail
