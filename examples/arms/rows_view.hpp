// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows of numbers in somebody else's memory.

#include "vernier/core/types.hpp"

namespace support {

/// Rows of numbers, one behind the other in memory; they outlive the view. Null for none.
struct RowsView {
  const double* data = nullptr;  ///< the first number
  vernier::Index rows = 0;       ///< number of rows
  vernier::Index columns = 0;    ///< numbers in a row

  /// Whether there are any.
  explicit operator bool() const { return data != nullptr; }
  /// The first number of a row.
  const double* row(vernier::Index i) const { return data + i * columns; }
};

}  // namespace support
