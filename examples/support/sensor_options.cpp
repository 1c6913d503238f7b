// SPDX-License-Identifier: BSD-3-Clause
#include "sensor_options.hpp"

#include <fmt/format.h>

namespace support {

void SensorOptions::add_to(Program& program) {
  program
      .add_setting("--position-sigma", position_mm,
                   "standard deviation of a measured position, per component [mm]; columns sx_mm .. of a row win", "MM")
      .within(1e-6, 1e3);
  program
      .add_setting("--orientation-sigma", orientation_mrad,
                   "of a measured orientation, per component [mrad]; columns srx_rad .. of a row win", "MRAD")
      .within(1e-6, 1e3);
}

void SensorOptions::note(const Program& program) {
  for (const char* option : {"--position-sigma", "--orientation-sigma"})
    if (program.given(option)) stated += (stated.empty() ? "" : " and ") + std::string(option);
}

void SensorOptions::apply(vernier::SensorModel& sensors) const {
  sensors.position_sigma = position_mm * 1e-3;
  sensors.orientation_sigma = orientation_mrad * 1e-3;
}

void SensorOptions::remark(const std::string& file, bool rows) const {
  if (rows && !stated.empty())
    fmt::print("{}: its columns state the accuracy of each row; {} does not hold there\n", file, stated);
}

}  // namespace support
