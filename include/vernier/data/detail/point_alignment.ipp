// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/detail/point_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::detail {

/// Adds three equations to normal equations, of which the lower triangle is used.
/// @param coefficients unknowns x 3
VERNIER_LOCAL void add_equations(const MatrixX& coefficients, const Vector3& values, MatrixX& normal, VectorX& right) {
  for (Index j = 0; j < right.size(); ++j) {
    const double a = coefficients(j, 0), b = coefficients(j, 1), c = coefficients(j, 2);
    for (Index i = j; i < right.size(); ++i)
      normal(i, j) += a * coefficients(i, 0) + b * coefficients(i, 1) + c * coefficients(i, 2);
    right(j) += a * values(0) + b * values(1) + c * values(2);
  }
}

/// Adds a share of the trace to the diagonal.
VERNIER_LOCAL void damp(MatrixX& normal, double share) {
  const double more = share * diagonal_of(normal).sum();
  for (Index k = 0; k < normal.rows(); ++k) normal(k, k) += more;
}

/// Rotation of the base where the inverse of the base is taken for an affine map A p + b: A m - R t + b = p is linear.
VERNIER_LOCAL Matrix3 affine_base_rotation(std::span<const Isometry3> flanges, const PointRows& points,
                                           std::span<const PointPair> pairs) {
  constexpr int unknowns = 15;
  MatrixX normal = MatrixX::Zero(unknowns, unknowns);
  VectorX right = VectorX::Zero(unknowns);
  MatrixX coefficients = MatrixX::Zero(unknowns, 3);
  Vector3 mean = Vector3::Zero();
  for (const PointPair& pair : pairs) mean += point(points, pair.point);
  mean /= static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) {
    const Isometry3& flange = flanges[static_cast<std::size_t>(pair.row)];
    const Vector3 arm = point(points, pair.point) - mean;
    for (Index k = 0; k < 3; ++k) {
      for (Index c = 0; c < 3; ++c) {
        coefficients(3 * k + c, k) = arm(c);
        coefficients(9 + c, k) = -flange(k, c);
      }
      coefficients(12 + k, k) = 1;
    }
    add_equations(coefficients, translation(flange), normal, right);
  }
  damp(normal, 1e-9);
  if (!cholesky(normal)) return Matrix3::Identity();
  solve_cholesky(normal, right);
  Matrix3 base;  // column k is row k of A
  for (Index k = 0; k < 3; ++k)
    for (Index c = 0; c < 3; ++c) base(c, k) = right(3 * k + c);
  return nearest_rotation(base);
}

/// Gauss-Newton from a rotation of the base.
VERNIER_LOCAL PointFrames refined_frames(std::span<const Isometry3> flanges, const PointRows& points,
                                         std::span<const PointPair> pairs, const Matrix3& start, int max_steps) {
  constexpr double offset_weight = 1e-6;  // a prior of little: an offset of 1 m is worth 1 mm at every point
  const auto n = static_cast<double>(pairs.size());
  PointFrames frames;
  frames.base.linear() = start;
  MatrixX coefficients(9, 3);  // of the point by rotation, translation and offset
  for (int step_number = 0; step_number < max_steps; ++step_number) {
    const Vector3 base = translation(frames.base);
    MatrixX normal = MatrixX::Zero(9, 9);
    VectorX step = VectorX::Zero(9);
    for (const PointPair& pair : pairs) {
      const Isometry3& flange = flanges[static_cast<std::size_t>(pair.row)];
      const Vector3 turned = transformed(frames.base, transformed(flange, frames.offset)) - base;
      const Vector3 left = point(points, pair.point) - turned - base;
      const Isometry3 tool = composed(frames.base, flange);
      const Matrix3 lever = skew(turned);
      for (Index c = 0; c < 3; ++c)
        for (Index k = 0; k < 3; ++k) {
          coefficients(k, c) = -lever(c, k);
          coefficients(3 + k, c) = c == k;
          coefficients(6 + k, c) = tool(c, k);
        }
      add_equations(coefficients, left, normal, step);
    }
    for (Index k = 0; k < 3; ++k) {
      normal(6 + k, 6 + k) += n * offset_weight;
      step(6 + k) -= n * offset_weight * frames.offset(k);
    }
    damp(normal, 1e-12);
    if (!cholesky(normal)) break;
    solve_cholesky(normal, step);
    const Vector3 turn = step.head(3), shift = step.segment(3, 3), further = step.tail(3);
    frames.base = rigid_motion(exp_so3(turn) * rotation(frames.base), base + shift);
    frames.offset += further;
    if (!(step.norm() > 1e-9)) break;
  }
  double sum = 0;
  for (const PointPair& pair : pairs)
    sum += (point(points, pair.point) - frames.point(flanges[static_cast<std::size_t>(pair.row)])).squaredNorm();
  frames.rms = std::sqrt(sum / (n - 3));
  return frames;
}

VERNIER_IMPL PointFrames fit_point_frames(std::span<const Isometry3> flanges, const PointRows& points,
                                          std::span<const PointPair> pairs, int max_steps) {
  PointRows from(static_cast<Index>(pairs.size()), 3), to(static_cast<Index>(pairs.size()), 3);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    set_point(from, static_cast<Index>(k), translation(flanges[static_cast<std::size_t>(pairs[k].row)]));
    set_point(to, static_cast<Index>(k), point(points, pairs[k].point));
  }
  const PointFrames affine =
      refined_frames(flanges, points, pairs, affine_base_rotation(flanges, points, pairs), max_steps);
  const PointFrames rigid = refined_frames(flanges, points, pairs, rotation(register_points(from, to)), max_steps);
  return rigid.rms < affine.rms || !std::isfinite(affine.rms) ? rigid : affine;
}

VERNIER_IMPL std::vector<PointPair> align_with_gaps(Index rows, Index points, FunctionRef<double(Index, Index)> cost) {
  enum Step : unsigned char { pair, skip_row, skip_point };
  const auto width = static_cast<std::size_t>(points + 1);
  std::vector<unsigned char> steps(static_cast<std::size_t>(rows + 1) * width, skip_point);
  std::vector<double> above(width), here(width);  // smallest costs of the first rows and points
  for (std::size_t j = 0; j < width; ++j) above[j] = 0.5 * static_cast<double>(j);
  for (Index i = 0; i < rows; ++i) {
    unsigned char* step = steps.data() + static_cast<std::size_t>(i + 1) * width;
    here[0] = 0.5 * static_cast<double>(i + 1);
    step[0] = skip_row;
    for (std::size_t j = 1; j < width; ++j) {
      here[j] = (std::min)(above[j], here[j - 1]) + 0.5;
      step[j] = above[j] <= here[j - 1] ? skip_row : skip_point;
      const double one = cost(i, static_cast<Index>(j - 1));
      if (one < 1 && above[j - 1] + one < here[j]) {
        here[j] = above[j - 1] + one;
        step[j] = pair;
      }
    }
    std::swap(above, here);
  }
  std::vector<PointPair> out;
  for (Index i = rows, j = points; i > 0 || j > 0;) {
    const unsigned char step = steps[static_cast<std::size_t>(i) * width + static_cast<std::size_t>(j)];
    if (step == pair) out.push_back({i - 1, j - 1});
    if (step != skip_point) --i;
    if (step != skip_row) --j;
  }
  std::reverse(out.begin(), out.end());
  return out;
}

}  // namespace vernier::detail
