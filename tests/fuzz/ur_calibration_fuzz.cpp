// SPDX-License-Identifier: BSD-3-Clause
// The calibration.conf of a UR10's controller.
#include "reader_fuzz.hpp"
#include "vernier/io/ur_calibration.hpp"
#include "vernier/kinematics/robots.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto nominal = vernier::RobotDescription::of(vernier::robots::ur10());
  return vernier::fuzz::read_as_file(
      data, size, [](const std::string& path) { static_cast<void>(vernier::read_ur_calibration(path, nominal)); });
}
