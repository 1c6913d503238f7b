// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The exception for files with invalid content.

#include <stdexcept>

#include "vernier/core/language.hpp"

namespace vernier {

/// A file whose content is invalid; the message names the file and the place in it.
class DataError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace vernier
