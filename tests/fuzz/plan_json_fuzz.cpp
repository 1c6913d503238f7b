// SPDX-License-Identifier: BSD-3-Clause
// Plans of comparisons.
#include "cli.hpp"
#include "comparison.hpp"
#include "reader_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file<support::UsageError>(
      data, size, [](const std::string& path) { static_cast<void>(support::Plan::read(path)); });
}
