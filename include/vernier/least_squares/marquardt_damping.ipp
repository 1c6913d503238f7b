// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/least_squares/marquardt_damping.hpp"

namespace vernier {

VERNIER_IMPL void MarquardtDamping::accept(double actual, double predicted) {
  const double surplus = 2 * actual / predicted - 1;
  value_ *= (std::max)(1.0 / 3, 1 - surplus * surplus * surplus);
  raise_ = 2;
}

VERNIER_IMPL void MarquardtDamping::reject() {
  value_ = value_ > 0 ? value_ * raise_ : 1e-3;
  raise_ *= 2;
}

}  // namespace vernier
