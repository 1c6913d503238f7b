// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The options that say what an arm carries.

#include <optional>
#include <vector>

#include "cli.hpp"
#include "vernier/error_terms/payload_compliance.hpp"

namespace support {

/// What an arm carries.
struct PayloadOption {
  std::optional<double> mass{};     ///< [kg]; none: the mean one of the measurements
  std::vector<double> centre_mm{};  ///< in the frame of the flange; none: at the tool point

  /// Adds --payload-kg and --payload-centre to a command line.
  /// @param help of --payload-kg
  void add_to(Program& program, const char* help =
                                    "what the arm carries, for a model of measurements with a column "
                                    "payload_kg; by default their mean payload");
  /// As the library has it.
  vernier::Payload payload() const;
};

/// @throws UsageError: what a model that states no payload says to --payload-kg
[[noreturn]] void refuse_payload();

/// A robot under the payload of a command line, if that has one.
/// @param robot a `CalibratedRobot`
/// @throws UsageError for a model whose measurements state no payload
template <class Robot>
Robot carrying(const Robot& robot, const PayloadOption& option) {
  if (!option.mass) return robot;
  if (!robot.identified().model().joint_errors().terms().payload) refuse_payload();
  return robot.carrying(option.payload());
}

}  // namespace support
