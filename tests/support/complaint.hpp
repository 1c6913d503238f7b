// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What misuse is told.

#include <stdexcept>
#include <string>

namespace vernier_test {

/// The message of the `std::invalid_argument` that `f` throws; empty where it throws none.
template <class F>
std::string complaint(F&& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return {};
}

}  // namespace vernier_test
