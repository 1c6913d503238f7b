// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Data that do not support a calibration.

#include <stdexcept>

#include "vernier/core/language.hpp"

namespace vernier {

/// A calibration that must not be used; the message names the reason and the remedy in one line.
class CalibrationFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace vernier
