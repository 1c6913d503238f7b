// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/io/ur_calibration.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/text_lines.hpp"
#include "vernier/io/json.hpp"
#include "vernier/kinematics/detail/rows_of_axes.hpp"

namespace vernier {

namespace detail {

/// The four lists of a calibration.conf.
struct UrDeltas {
  static constexpr std::array<const char*, 4> keys{"delta_theta", "delta_a", "delta_d", "delta_alpha"};
  std::array<std::array<double, 6>, 4> values{};
  std::array<std::size_t, 4> lines{};  ///< where each list is; 0: nowhere
  std::string hash{};                  ///< SHA-256 of the file
};

/// `[ x, x, x, x, x, x]`
VERNIER_LOCAL std::array<double, 6> six_numbers(std::string_view list, const std::string& place) {
  if (!list.starts_with('[') || !list.ends_with(']')) throw DataError(place + " must be a list, [x, x, x, x, x, x]");
  std::array<double, 6> out{};
  std::string_view rest = list.substr(1, list.size() - 2);
  std::size_t count = 0;
  for (bool more = !trimmed(rest).empty(); more; ++count) {
    const std::size_t comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view word = trimmed(rest.substr(0, comma));
    if (more) rest.remove_prefix(comma + 1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
      throw DataError(place + ": '" + quotable(word) + "' is not a number");
    constexpr double largest = 1e5;
    if (std::abs(value) > largest) throw DataError(message(place, ": ", value, " is beyond any length or angle"));
    if (count < out.size()) out[count] = value;
  }
  if (count != out.size()) throw DataError(message(place, " has ", count, " values, must have 6"));
  return out;
}

VERNIER_LOCAL UrDeltas read_ur_deltas(const std::string& path) {
  std::string content;
  try {
    content = read_file(path, std::size_t{1} << 20);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
  UrDeltas out;
  out.hash = sha256(content);
  std::string_view rest = content;
  std::string section;
  bool mounting = false;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos && line.starts_with('[') && line.ends_with(']')) {
      section = trimmed(line.substr(1, line.size() - 2));
      mounting = mounting || section == "mounting";
      continue;
    }
    if (equals == std::string_view::npos)
      throw DataError(
          message(path, ", line ", number, ": '", quotable(line), "' is neither a [section] nor key = value"));
    if (section != "mounting") continue;
    const std::string_view key = trimmed(line.substr(0, equals));
    for (std::size_t k = 0; k < out.keys.size(); ++k) {
      if (key != out.keys[k]) continue;
      const std::string place = message(path, ", line ", number, ": ", key);
      if (out.lines[k] > 0) throw DataError(message(place, " is given twice, also in line ", out.lines[k]));
      out.lines[k] = number;
      out.values[k] = six_numbers(trimmed(line.substr(equals + 1)), place);
    }
  }
  if (!mounting) throw DataError(path + ": section [mounting] is missing; is it the controller's calibration.conf?");
  for (std::size_t k = 0; k < out.keys.size(); ++k)
    if (out.lines[k] == 0) throw DataError(path + ": key '" + out.keys[k] + "' is missing");
  return out;
}

/// base_T_end of rows of the standard convention without beta, all joints zero, and each joint's axis on the way.
VERNIER_LOCAL Isometry3 end_of_rows(const std::vector<DhRow>& rows, std::vector<JointAxis>& axes) {
  Isometry3 at = Isometry3::Identity();
  for (const DhRow& row : rows) {
    axes.push_back({{at(0, 2), at(1, 2), at(2, 2)}, translation(at), row.joint});
    const Isometry3 turned = rigid_motion(exp_so3(Vector3(0, 0, row.theta)), Vector3::Zero());
    const Isometry3 moved = rigid_motion(exp_so3(Vector3(row.alpha, 0, 0)), Vector3(row.a, 0, row.d));
    at = composed(at, composed(turned, moved));
  }
  return at;
}

}  // namespace detail

VERNIER_IMPL RobotDescription read_ur_calibration(const std::string& path, const RobotDescription& nominal) {
  bool fits = nominal.dof() == 6 && !nominal.modified;
  for (const DhRow& row : nominal.rows) fits = fits && row.joint == JointType::revolute && same_value(row.beta, 0);
  demand(fits, "read_ur_calibration: '", nominal.name,
         "' is not an arm of six revolute joints in the standard convention, without beta");
  const detail::UrDeltas deltas = detail::read_ur_deltas(path);
  std::vector<DhRow> exact = nominal.rows;
  std::vector<double> thetas;
  for (std::size_t i = 0; i < 6; ++i) {
    thetas.push_back(nominal.rows[i].theta);
    exact[i].theta += deltas.values[0][i];
    exact[i].a += deltas.values[1][i];
    exact[i].d += deltas.values[2][i];
    exact[i].alpha += deltas.values[3][i];
  }
  std::vector<detail::JointAxis> axes;
  const Isometry3 end = detail::end_of_rows(exact, axes);
  const detail::AxisRows found = detail::rows_of_axes(axes, thetas);

  RobotDescription out = nominal;
  out.files.push_back({path, deltas.hash});
  out.rows = found.rows;
  // What is left behind the last axis keeps a and alpha, and so d of the last row its meaning.
  const Isometry3 left = composed(inverse_of(found.frames.back()), end);
  const double alpha = exact.back().alpha;
  // its turn about x leaves the first column as it is
  out.rows.back() = {exact.back().a, alpha, left(2, 3), std::atan2(left(1, 0), left(0, 0))};
  double& theta = out.rows.back().theta;
  theta += std::round((thetas.back() - theta) / (2 * std::numbers::pi)) * 2 * std::numbers::pi;

  constexpr double farthest_length = 0.1, farthest_angle = 0.3;  // of arms as made: 5 mm, 0.1 rad
  for (std::size_t i = 0; i < 6; ++i) {
    const DhRow &row = out.rows[i], &design = nominal.rows[i];
    const auto limit = [&](const char* name, double value, double nominal_value, double farthest, const char* unit) {
      if (!(std::abs(value - nominal_value) <= farthest))
        throw DataError(message(path, ": ", name, i + 1, " becomes ", value, " ", unit, ", far from ", nominal_value,
                                " ", unit, " of '", detail::quotable(nominal.name), "'; is it of another arm?"));
    };
    limit("a", row.a, design.a, farthest_length, "m");
    limit("d", row.d, design.d, farthest_length, "m");
    limit("alpha", row.alpha, design.alpha, farthest_angle, "rad");
    limit("theta", row.theta, design.theta, farthest_angle, "rad");
  }
  return out;
}

}  // namespace vernier
