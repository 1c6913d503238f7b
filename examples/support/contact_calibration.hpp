// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --contacts` without measured poses: an arm is identified from what it touches.

#include <string>

#include "cli.hpp"
#include "vernier/data/csv_format.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace support {

/// Identifies the geometry of an arm from a file of contacts, prints it with what contacts do not observe, and saves
/// the arm: its base stays nominal, and nothing joint-wise is estimated.
/// @param format  how that file is written
/// @param options which chain parameters are estimated
/// @param save    file for the calibrated model; empty: none
/// @param date    written into the model
/// @throws vernier::CalibrationFailure for contacts that do not support a calibration
int calibrate_by_contacts(Program& program, const vernier::RobotDescription& robot, const std::string& contacts,
                          const vernier::CsvFormat& format, vernier::IdentifyOptions options,
                          const vernier::SensorModel& sensors, const std::string& save, const std::string& date);

}  // namespace support
