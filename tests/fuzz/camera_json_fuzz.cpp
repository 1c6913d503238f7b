// SPDX-License-Identifier: BSD-3-Clause
// Intrinsics of a camera as JSON.
#include "reader_fuzz.hpp"
#include "vernier/io/camera_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(
      data, size, [](const std::string& path) { static_cast<void>(vernier::read_camera_json(path)); });
}
