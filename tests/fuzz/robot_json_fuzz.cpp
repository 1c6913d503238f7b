// SPDX-License-Identifier: BSD-3-Clause
// Nominal arms, as far as their geometry.
#include "reader_fuzz.hpp"
#include "vernier/io/robot_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(
      data, size, [](const std::string& path) { static_cast<void>(vernier::load_robot(path).geometry()); });
}
