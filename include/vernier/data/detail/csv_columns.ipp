// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>

#include "vernier/data/detail/csv_columns.hpp"

namespace vernier::detail {

/// The beginnings of names that a unit follows, joints apart.
struct ColumnStem {
  std::string_view stem;
  const Quantity& quantity;
};
inline constexpr std::array<ColumnStem, 24> column_stems{
    {{"euler1", quantities::rotation_angle},  {"euler2", quantities::rotation_angle},
     {"euler3", quantities::rotation_angle},  {"sx", quantities::standard_length},
     {"sy", quantities::standard_length},     {"sz", quantities::standard_length},
     {"srx", quantities::standard_angle},     {"sry", quantities::standard_angle},
     {"srz", quantities::standard_angle},     {"x", quantities::coordinate},
     {"y", quantities::coordinate},           {"z", quantities::coordinate},
     {"rx", quantities::rotation_angle},      {"ry", quantities::rotation_angle},
     {"rz", quantities::rotation_angle},      {"distance", quantities::measured_distance},
     {"radius", quantities::gauge_length},    {"offset", quantities::gauge_length},
     {"time", quantities::time_of_measuring}, {"temperature", quantities::temperature},
     {"payload_x", quantities::gauge_length}, {"payload_y", quantities::gauge_length},
     {"payload_z", quantities::gauge_length}, {"payload", quantities::payload}}};

/// Names without unit that a reader knows.
inline constexpr std::array<std::string_view, 7> read_names{"segment",   "move",       "pose", "cycle",
                                                            "direction", "contact_id", "kind"};

/// Names that programs write for people.
inline constexpr std::array<std::string_view, 14> noted_names{"visit",        "image",
                                                              "joints_line",  "points_line",
                                                              "status",       "predicted_error_mm",
                                                              "gate",         "target",
                                                              "point",        "predicted_rotation_mrad",
                                                              "deviation_mm", "radius95_mm",
                                                              "singularity",  "singularity_deg"};

/// The number behind q that begins a text, and how many characters both take; no characters where there is none.
struct JointNumber {
  int number = 0;
  std::size_t length = 0;
};
VERNIER_LOCAL JointNumber joint_number(std::string_view text) {
  if (!text.starts_with('q') || text.size() < 2 || text[1] < '0' || text[1] > '9') return {};
  int number = 0;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
  if (error != std::errc{} || (text[1] == '0' && end != text.data() + 2)) return {};
  return {number, static_cast<std::size_t>(end - text.data())};
}

/// The rest of a name behind what a unit follows, and the first unit that may; none for a name that begins otherwise.
VERNIER_LOCAL std::optional<std::pair<std::string_view, std::string_view>> behind_stem(std::string_view name) {
  const std::string_view of_joint = name.starts_with("from_q") ? name.substr(5) : name;
  if (const JointNumber joint = joint_number(of_joint); joint.length > 0)
    return std::pair{of_joint.substr(joint.length), angle_units[0].first};
  for (const auto& [stem, quantity] : column_stems)
    if (name.starts_with(stem) && (name.size() == stem.size() || name[stem.size()] == '_'))
      return std::pair{name.substr(stem.size()), quantity.units[0].first};
  return {};
}

VERNIER_IMPL std::optional<int> joint_of(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return {};
  name.remove_prefix(prefix.size());
  const JointNumber joint = joint_number(name);
  if (joint.length == 0) return {};
  name.remove_prefix(joint.length);
  const auto is = [&](const Quantity::Unit& unit) { return unit.first == name; };
  const bool known = std::any_of(length_units.begin(), length_units.end(), is) ||
                     std::any_of(angle_units.begin(), angle_units.end(), is);
  return known ? std::optional<int>(joint.number) : std::nullopt;
}

/// Whether a name is that of a coordinate of one of several points of a line: x1_mm.
VERNIER_LOCAL bool coordinate_of_point(std::string_view name) {
  if (name.empty() || name[0] < 'x' || name[0] > 'z') return false;
  const std::size_t end = (std::min)(name.find_first_not_of("0123456789", 1), name.size());
  return end > 1 && std::any_of(length_units.begin(), length_units.end(),
                                [&](const Quantity::Unit& unit) { return unit.first == name.substr(end); });
}

VERNIER_IMPL bool known_quantity(std::string_view name) {
  if (joint_of(name, "") || joint_of(name, "from_") || coordinate_of_point(name)) return true;
  for (const auto& [stem, quantity] : column_stems)
    for (const auto& [unit, size] : quantity.units)
      if (name.size() == stem.size() + unit.size() && name.starts_with(stem) && name.ends_with(unit)) return true;
  return false;
}

VERNIER_IMPL bool known_column(std::string_view name) {
  return known_quantity(name) || std::find(read_names.begin(), read_names.end(), name) != read_names.end() ||
         std::find(noted_names.begin(), noted_names.end(), name) != noted_names.end();
}

VERNIER_IMPL bool needs_no_reader(std::string_view name) {
  if (joint_of(name, "") || std::find(noted_names.begin(), noted_names.end(), name) != noted_names.end()) return true;
  return known_quantity(name) && (name.starts_with('x') || name.starts_with('y') || name.starts_with('z') ||
                                  name.starts_with("rx") || name.starts_with("ry") || name.starts_with("rz"));
}

VERNIER_IMPL std::string nearest_column(std::string_view name) {
  if (known_column(name)) return {};
  std::string plain;  // small letters and digits, everything else as one _
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool capital = c >= 'A' && c <= 'Z';
    const bool mu = name.substr(i).starts_with("\xC2\xB5") || name.substr(i).starts_with("\xCE\xBC");
    if (mu || capital || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      plain += mu ? 'u' : capital ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!plain.empty() && plain.back() != '_')
      plain += '_';
    if (mu) ++i;
  }
  while (plain.ends_with('_')) plain.pop_back();
  if (known_column(plain)) return plain;
  const auto behind = behind_stem(plain);
  if (!behind) return {};
  constexpr std::string_view units[] = {
      "",       "_mm",      "_m",      "_um",      "_cm",         "_dm",     "_in",      "_inch",  "_ft",  "_rad",
      "_mrad",  "_urad",    "_deg",    "_grad",    "_s",          "_ms",     "_us",      "_ns",    "_min", "_sec",
      "_c",     "_f",       "_k",      "_degree",  "_degrees",    "_radian", "_radians", "_turns", "_rev", "_metre",
      "_meter", "_seconds", "_kelvin", "_celsius", "_fahrenheit", "_degc",   "_deg_c"};
  if (std::find(std::begin(units), std::end(units), behind->first) == std::end(units)) return {};
  return plain.substr(0, plain.size() - behind->first.size()) + std::string(behind->second);
}

}  // namespace vernier::detail
