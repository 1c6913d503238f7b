// SPDX-License-Identifier: BSD-3-Clause
// Poses with numbers of their own.
#include "reader_fuzz.hpp"
#include "vernier/data/csv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    static_cast<void>(vernier::read_labelled_poses(path, {"pose"}, {"cycle"}));
  });
}
