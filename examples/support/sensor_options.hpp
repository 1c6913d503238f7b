// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The options that state the accuracy of a sensor, for all rows of a file.

#include <string>

#include "cli.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace support {

/// The accuracy of a sensor, as a command line states it.
struct SensorOptions {
  // divided, so that multiplied by 1e-3 it is that number again, to the last bit
  double position_mm = vernier::SensorModel{}.position_sigma / 1e-3;          ///< of a position, per component [mm]
  double orientation_mrad = vernier::SensorModel{}.orientation_sigma / 1e-3;  ///< of an orientation, likewise [mrad]
  std::string stated{};  ///< the options that were given, for messages; empty: none

  /// Adds --position-sigma and --orientation-sigma to a command line.
  void add_to(Program& program);
  /// Takes note of which of them were given.
  void note(const Program& program);
  /// Writes them to a sensor's accuracy.
  void apply(vernier::SensorModel& sensors) const;
  /// Says that the rows of a file have standard deviations of their own, where options state some, too.
  /// @param file its name
  /// @param rows whether its rows have
  void remark(const std::string& file, bool rows) const;
};

}  // namespace support
