// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The names of the columns of CSV files, their units, and the values that can be meant.

#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// What a column of numbers holds.
struct Quantity {
  using Unit = std::pair<std::string_view, double>;  ///< the end of the name, and its size in m, rad, s or deg C
  std::span<const Unit> units;                       ///< the first one is what messages propose
  double smallest, largest;                          ///< values lie between these [m, rad, s, deg C]
  std::string_view otherwise;                        ///< what is said of a value that does not
};

inline constexpr std::array<Quantity::Unit, 3> length_units{{{"_mm", 1e-3}, {"_m", 1.0}, {"_um", 1e-6}}};
inline constexpr std::array<Quantity::Unit, 3> angle_units{
    {{"_rad", 1.0}, {"_deg", std::numbers::pi / 180}, {"_mrad", 1e-3}}};
inline constexpr std::array<Quantity::Unit, 2> time_units{{{"_s", 1.0}, {"_ms", 1e-3}}};
inline constexpr std::array<Quantity::Unit, 1> celsius_unit{{{"_c", 1.0}}}, kilogram_unit{{{"_kg", 1.0}}},
    no_unit{{{"", 1.0}}};

namespace quantities {

inline constexpr Quantity joint_angle{angle_units, -1e4, 1e4, "beyond any joint angle (1e4 rad)"};
inline constexpr Quantity joint_travel{length_units, -1e4, 1e4, "beyond any travel of a joint (1e4 m)"};
inline constexpr Quantity coordinate{length_units, -1e7, 1e7, "beyond any coordinate on Earth (1e7 m)"};
inline constexpr Quantity rotation_angle{angle_units, -1e3, 1e3, "beyond any rotation vector (1e3 rad)"};
inline constexpr Quantity measured_distance{length_units, -1e5, 1e5, "beyond any measured distance (1e5 m)"};
inline constexpr Quantity gauge_length{length_units, -1e3, 1e3, "beyond any gauge (1e3 m)"};
inline constexpr Quantity time_of_measuring{
    time_units, -1e11, 1e11, "beyond any time (1e11 s); time_s is in seconds, milliseconds are a column time_ms"};
inline constexpr Quantity temperature{celsius_unit, -100, 200, "no temperature of an arm (-100 to 200 deg C); kelvin?"};
inline constexpr Quantity payload{kilogram_unit, -1e-300, 1e5, "no payload of an arm (0 to 1e5 kg)"};
inline constexpr Quantity whole_number{no_unit, -1e9, 1e9, "beyond any number of a pose (1e9)"};
inline constexpr Quantity standard_length{length_units, -1e3, 1e3, "beyond any standard deviation (1e3 m)"};
inline constexpr Quantity standard_angle{angle_units, -10, 10, "beyond any standard deviation (10 rad)"};
inline constexpr Quantity covariance_entry{no_unit, -1e9, 1e9, "beyond any covariance (1e9)"};
inline constexpr Quantity words{no_unit, 0, 0, ""};  // no number
inline constexpr Quantity segment_number{no_unit, -9e15, 9e15, "beyond numbers that can be told apart (9e15)"};

}  // namespace quantities

/// The joint that a name is of: `q3_deg`, or `from_q3_deg` for the prefix `from_`; none where it is of none.
VERNIER_API std::optional<int> joint_of(std::string_view name, std::string_view prefix);

/// Whether any of our files has a column of this name with numbers that have a unit.
VERNIER_API bool known_quantity(std::string_view name);

/// Whether any of our files has a column of this name.
VERNIER_API bool known_column(std::string_view name);

/// Whether a column is known, but nothing to be read again: joints and poses beside others, and what programs note.
VERNIER_API bool needs_no_reader(std::string_view name);

/// The known name that a name differs from by case, by blanks and brackets or by its unit alone; empty where there is
/// none: `x_mm` for `X [mm]` and for `x_inch`.
VERNIER_API std::string nearest_column(std::string_view name);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/csv_columns.ipp"
#endif
