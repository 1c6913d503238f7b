// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/pose_values.hpp"

namespace vernier::detail {

VERNIER_IMPL bool euler_axes(std::string_view order) {
  if (order.size() != 3 || order[0] == order[1] || order[1] == order[2]) return false;
  const auto among = [&](std::string_view letters) {
    return std::all_of(order.begin(), order.end(), [&](char c) { return letters.find(c) != std::string_view::npos; });
  };
  return among("xyz") || among("XYZ");
}

VERNIER_IMPL Matrix3 euler_rotation(std::string_view order, const Vector3& angles) {
  Matrix3 out = Matrix3::Identity();
  for (Index k = 0; k < 3; ++k) {
    const char letter = order[static_cast<std::size_t>(k)];
    const bool moving = letter <= 'Z';
    Vector3 turn = Vector3::Zero();
    turn(letter - (moving ? 'X' : 'x')) = angles(k);
    const Matrix3 about = exp_so3(turn);
    out = moving ? Matrix3(out * about) : Matrix3(about * out);
  }
  return out;
}

/// Columns of three stems, if the file has one of them.
VERNIER_LOCAL std::vector<CsvColumn> three_columns(const CsvTable& table, const std::array<const char*, 3>& stems,
                                                   const Quantity& quantity) {
  std::vector<CsvColumn> out;
  if (std::any_of(stems.begin(), stems.end(), [&](const char* stem) { return table.find(stem, quantity).has_value(); }))
    for (const char* stem : stems) out.push_back(table.require_column(stem, quantity));
  return out;
}

/// Columns of Euler angles in the order of turning; none where the file has none.
VERNIER_LOCAL std::vector<CsvColumn> euler_columns(const CsvTable& table, const std::string& euler) {
  demand(euler_axes(euler), "CSV: '", printable(euler),
         "' are no axes of Euler angles; ZYX, about axes that turn along, or xyz, about axes that stay, are some");
  std::vector<CsvColumn> about = three_columns(table, {"rx", "ry", "rz"}, quantities::rotation_angle),
                         ordered = three_columns(table, {"euler1", "euler2", "euler3"}, quantities::rotation_angle);
  if (!about.empty() && !ordered.empty())
    table.fail_in_header("columns ", about[0].name, " and ", ordered[0].name, " both give an orientation");
  if (about.empty()) return ordered;
  if (euler[0] == euler[2])
    table.fail_in_header("Euler angles ", euler,
                         " turn twice about one axis; name them euler1_deg, euler2_deg and "
                         "euler3_deg in the order of turning, not ",
                         about[0].name);
  for (const char letter : euler) ordered.push_back(about[static_cast<std::size_t>((letter | 0x20) - 'x')]);
  return ordered;
}

/// Refuses columns that are named like Euler angles, where the file is not said to have any.
VERNIER_LOCAL void refuse_undeclared(const CsvTable& table) {
  constexpr std::array<const char*, 3> named[] = {
      {"euler1", "euler2", "euler3"}, {"roll", "pitch", "yaw"}, {"a", "b", "c"}, {"w", "p", "r"}};
  for (const auto& stems : named) {
    std::vector<std::string> names;
    for (const char* stem : stems)
      if (const auto column = table.find(stem, quantities::rotation_angle)) names.push_back(column->name);
    if (names.size() == 3)
      table.fail_in_header("columns ", names[0], ", ", names[1], " and ", names[2],
                           ": Euler angles need a stated convention; name them rx_deg, ry_deg and rz_deg (about x, y "
                           "and z) and state --euler ZYX, or another order of axes (CsvFormat)");
  }
}

/// Orientations as rotation vectors, n x 3; no rows where the file has none.
VERNIER_LOCAL MatrixX rotation_vectors(const CsvTable& table, const std::string& euler) {
  std::vector<CsvColumn> vector, angles, quaternion, matrix;
  if (euler.empty()) {
    vector = three_columns(table, {"rx", "ry", "rz"}, quantities::rotation_angle);
    refuse_undeclared(table);
  } else {
    angles = euler_columns(table, euler);
  }
  for (const char* name : {"qw", "qx", "qy", "qz"})
    if (auto found = table.find(name, quantities::covariance_entry)) quaternion.push_back(std::move(*found));
  for (int r = 1; r <= 3; ++r)
    for (int c = 1; c <= 3; ++c)
      if (auto found = table.find(message('r', r, c), quantities::covariance_entry))
        matrix.push_back(std::move(*found));
  const std::vector<CsvColumn>* columns = nullptr;
  for (const auto* one : {&vector, &angles, &quaternion, &matrix}) {
    if (one->empty()) continue;
    if (columns != nullptr)
      table.fail_in_header("columns ", columns->front().name, " and ", one->front().name, " both give an orientation");
    columns = one;
  }
  if (columns == nullptr) {
    if (!euler.empty())
      table.fail_in_header("no Euler angles (--euler ", euler, "); rx_deg, ry_deg and rz_deg are some");
    return MatrixX(0, 3);
  }
  if (!euler.empty() && columns != &angles)
    table.fail_in_header("columns ", columns->front().name, " .. are no Euler angles (--euler ", euler, ")");
  if (!quaternion.empty() && quaternion.size() != 4)
    table.fail_in_header("a quaternion needs the columns qw, qx, qy and qz");
  if (!matrix.empty() && matrix.size() != 9)
    table.fail_in_header("a rotation matrix needs the nine columns r11, r12 .. r33");
  const MatrixX values = table.numbers(*columns);
  if (columns == &vector) return values;
  MatrixX out(values.rows(), 3);
  for (Index i = 0; i < values.rows(); ++i) {
    Matrix3 turn;
    if (columns == &angles) {
      turn = euler_rotation(euler, Vector3(values(i, 0), values(i, 1), values(i, 2)));
    } else if (columns == &quaternion) {
      const Eigen::Quaterniond q(values(i, 0), values(i, 1), values(i, 2), values(i, 3));
      if (!(std::abs(q.norm() - 1) < 0.01))
        table.fail_in_row(i, quaternion[0], "a quaternion of norm ", q.norm(), ", must be 1");
      turn = q.normalized().toRotationMatrix();
    } else {
      for (Index k = 0; k < 9; ++k) turn(k / 3, k % 3) = values(i, k);
      const Matrix3 square = turn * turn.transpose();
      double off = 0;
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c) off = (std::max)(off, std::abs(square(r, c) - (r == c ? 1 : 0)));
      if (!(off < 1e-3) || !(turn.determinant() > 0))
        table.fail_in_row(i, matrix[0], "the columns r11 to r33 are no rotation matrix");
      turn = nearest_rotation(turn);
    }
    const Vector3 as_vector = log_so3(turn);
    for (Index k = 0; k < 3; ++k) out(i, k) = as_vector(k);
  }
  return out;
}

VERNIER_IMPL MatrixX oriented_values(const CsvTable& table, const std::string& euler) {
  std::vector<CsvColumn> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back(table.require_column(axis, quantities::coordinate));
  const MatrixX positions = table.numbers(columns), turns = rotation_vectors(table, euler);
  if (turns.rows() == 0) return positions;
  MatrixX out(positions.rows(), 6);
  for (Index i = 0; i < out.rows(); ++i)
    for (Index k = 0; k < 3; ++k) {
      out(i, k) = positions(i, k);
      out(i, 3 + k) = turns(i, k);
    }
  return out;
}

VERNIER_IMPL PoseValues pose_values(const CsvTable& table, const std::string& euler) {
  constexpr const char* axes[] = {"x", "y", "z"};
  const auto found = [&](const char* axis, int point) {
    return table.find(message(axis, point), quantities::coordinate);
  };
  if (!found("x", 1)) return {oriented_values(table, euler), {}, {}};
  if (table.find("x", quantities::coordinate) || table.find("point", quantities::words))
    table.fail_in_header("columns x1 .. of several points a line exclude x, y, z and point");
  std::vector<CsvColumn> columns;
  std::vector<VectorX> values;
  for (int point = 1; found("x", point); ++point)
    for (const char* axis : axes) {
      columns.push_back(table.require_column(message(axis, point), quantities::coordinate));
      values.push_back(table.optional_numbers(columns.back()));
    }
  for (int later = static_cast<int>(columns.size()) / 3 + 1; later < 100; ++later)
    for (const char* axis : axes)
      if (const auto column = found(axis, later))
        table.fail_in_header("column ", column->name, ", but no x", columns.size() / 3 + 1,
                             "; points of a line are counted from 1");
  if (rotation_vectors(table, euler).rows() > 0)
    table.fail_in_header("several points a line have no orientations; leave the columns of these out");
  PoseValues out;
  std::vector<double> numbers;
  for (Index i = 0; i < static_cast<Index>(table.lines().size()); ++i)
    for (std::size_t k = 0; k < values.size(); k += 3) {
      int there = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) there += std::isfinite(values[k + axis](i)) ? 1 : 0;
      if (there != 0 && there != 3)
        table.fail_in_row(i, columns[k], "a point needs three coordinates, or three empty cells where it was not seen");
      if (there == 0) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) numbers.push_back(values[k + axis](i));
      out.points.push_back(message(k / 3 + 1));
      out.rows.push_back(i);
    }
  out.values.resize(static_cast<Index>(out.rows.size()), 3);
  for (Index i = 0; i < out.values.rows(); ++i)
    for (Index axis = 0; axis < 3; ++axis) out.values(i, axis) = numbers[static_cast<std::size_t>(3 * i + axis)];
  return out;
}

}  // namespace vernier::detail
