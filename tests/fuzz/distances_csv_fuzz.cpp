// SPDX-License-Identifier: BSD-3-Clause
// Measured distances, of three joints of given types.
#include "reader_fuzz.hpp"
#include "vernier/data/csv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    using enum vernier::JointType;
    static_cast<void>(vernier::read_distances<3>(path, std::array{revolute, prismatic, revolute}));
  });
}
