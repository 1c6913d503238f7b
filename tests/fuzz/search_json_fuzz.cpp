// SPDX-License-Identifier: BSD-3-Clause
// Ongoing searches.
#include "reader_fuzz.hpp"
#include "vernier/io/search_state.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/pso.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(
      data, size, [](const std::string& path) { static_cast<void>(vernier::load_state<vernier::Pso>(path)); });
}
