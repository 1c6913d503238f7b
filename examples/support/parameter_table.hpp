// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Identified frames and links as a table.

#include <string>

#include "vernier/identification/identification_report.hpp"

namespace support {

/// One line for each parameter of base, links and tool: its name, the values as designed and identified, their
/// difference, the standard deviation and the status. Lengths are in mm, angles in degrees, differences in mm and mrad.
std::string parameter_table(const vernier::IdentificationReport& report);

}  // namespace support
