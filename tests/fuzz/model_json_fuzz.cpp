// SPDX-License-Identifier: BSD-3-Clause
// Calibrated arms of three joints: loaded, then asked for a correction.
#include "reader_fuzz.hpp"
#include "vernier/io/model_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    const auto robot = vernier::load<3>(path);
    static_cast<void>(robot.correct(vernier::JointVector<3>::Constant(0.1)));
  });
}
