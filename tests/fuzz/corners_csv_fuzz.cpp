// SPDX-License-Identifier: BSD-3-Clause
// Corners of a board in images.
#include "reader_fuzz.hpp"
#include "vernier/camera/corner_views.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    static_cast<void>(vernier::read_corners(path, {.rows = 7, .columns = 5, .square = 0.036}));
  });
}
