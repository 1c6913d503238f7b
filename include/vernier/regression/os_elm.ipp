// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/regression/os_elm.hpp"

namespace vernier {

VERNIER_IMPL void OsElm::validate() const {
  layer().validate("OsElm");
  demand(lambda > 0 && std::isfinite(lambda), "OsElm: lambda is ", lambda, ", must be positive");
  demand(forgetting > 0 && forgetting <= 1, "OsElm: forgetting is ", forgetting, ", must lie in (0, 1]");
}

}  // namespace vernier
