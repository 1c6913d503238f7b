// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/board.hpp"

#include <cmath>

#include "vernier/core/check.hpp"

namespace vernier {

VERNIER_IMPL double Board::half_diagonal() const {
  return square * std::hypot(static_cast<double>(rows), static_cast<double>(columns)) / 2;
}

VERNIER_IMPL void Board::validate() const {
  constexpr Index most = 1000;
  demand(rows >= 3 && columns >= 3 && rows <= most && columns <= most, "Board: ", rows, " rows and ", columns,
         " columns of squares, both must be 3 to ", most);
  demand(square > 0 && square < 10, "Board: squares of ", square, " m, must be more than 0 and less than 10");
  demand(scale_sigma >= 0 && scale_sigma <= 0.1, "Board: the standard deviation of the scale is ", scale_sigma,
         ", must be 0 to 0.1");
  demand(marker >= 0 && marker < square, "Board: markers of ", marker, " m in squares of ", square, " m");
}

}  // namespace vernier
