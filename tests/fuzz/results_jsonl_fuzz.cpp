// SPDX-License-Identifier: BSD-3-Clause
// The results of comparisons: read, then merged with themselves.
#include "reader_fuzz.hpp"
#include "results.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file<std::invalid_argument>(
      data, size, [](const std::string& path) { static_cast<void>(support::read_results(path)); });
}
