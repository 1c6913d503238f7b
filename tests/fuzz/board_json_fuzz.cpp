// SPDX-License-Identifier: BSD-3-Clause
// Descriptions of printed boards.
#include "reader_fuzz.hpp"
#include "vernier/io/camera_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size,
                                     [](const std::string& path) { static_cast<void>(vernier::read_board(path)); });
}
