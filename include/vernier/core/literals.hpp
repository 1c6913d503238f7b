// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Unit literals; each yields metres, radians, kilograms or newtons: `290_mm`, `90_deg`.

#include "vernier/core/language.hpp"

#include <numbers>

/// Unit literals, brought in with `using namespace vernier::literals`.
namespace vernier::literals {

/// Millimetres as metres.
constexpr double operator""_mm(long double v) { return static_cast<double>(v / 1000.0L); }
/// Millimetres as metres.
constexpr double operator""_mm(unsigned long long v) {
  return static_cast<double>(static_cast<long double>(v) / 1000.0L);
}
/// Micrometres as metres.
constexpr double operator""_um(long double v) { return static_cast<double>(v / 1.0e6L); }
/// Micrometres as metres.
constexpr double operator""_um(unsigned long long v) {
  return static_cast<double>(static_cast<long double>(v) / 1.0e6L);
}
/// Metres.
constexpr double operator""_m(long double v) { return static_cast<double>(v); }
/// Metres.
constexpr double operator""_m(unsigned long long v) { return static_cast<double>(v); }
/// Degrees as radians.
constexpr double operator""_deg(long double v) {
  return static_cast<double>(v * std::numbers::pi_v<long double> / 180.0L);
}
/// Degrees as radians.
constexpr double operator""_deg(unsigned long long v) {
  return static_cast<double>(static_cast<long double>(v) * std::numbers::pi_v<long double> / 180.0L);
}
/// Radians.
constexpr double operator""_rad(long double v) { return static_cast<double>(v); }
/// Radians.
constexpr double operator""_rad(unsigned long long v) { return static_cast<double>(v); }
/// Milliradians as radians.
constexpr double operator""_mrad(long double v) { return static_cast<double>(v / 1000.0L); }
/// Milliradians as radians.
constexpr double operator""_mrad(unsigned long long v) {
  return static_cast<double>(static_cast<long double>(v) / 1000.0L);
}

}  // namespace vernier::literals
