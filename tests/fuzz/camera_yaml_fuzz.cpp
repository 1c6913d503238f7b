// SPDX-License-Identifier: BSD-3-Clause
// Intrinsics of a camera as OpenCV and ROS write them.
#include "reader_fuzz.hpp"
#include "vernier/urdf/camera_yaml.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(
      data, size, [](const std::string& path) { static_cast<void>(vernier::read_camera_yaml(path)); });
}
