#pragma once

#include <cmath>

#include "vernier/regression/os_elm.hpp"

namespace vernier {

VERNIER_IMPL void OsElm::validate() const {
  layer().validate("OsElm");
  require(lambda > 0 && std::isfinite(lambda), "OsElm: lambda is ", lambda, ", must be positive");
  require(forgetting > 0 && forgetting <= 1, "OsElm: forgetting is ", forgetting, ", must lie in (0, 1]");
}

}  // namespace vernier
