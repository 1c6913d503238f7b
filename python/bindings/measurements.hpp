// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `vernier.Measurements`: poses, distances and touches.

#include "measured_data.hpp"

namespace python {

/// Measurements of one arm, of any kinds.
struct Measurements {
  support::MeasuredData data{};  ///< all of them
};

}  // namespace python
