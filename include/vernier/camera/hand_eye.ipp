// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/hand_eye.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vernier {

namespace detail {

/// The rotation that nine numbers, by columns, are up to a factor of either sign.
VERNIER_LOCAL Matrix3 rotation_of(const VectorX& columns) {
  Matrix3 out;
  for (Index c = 0; c < 3; ++c)
    for (Index r = 0; r < 3; ++r) out(r, c) = columns(3 * c + r);
  if (out.determinant() < 0) out = -out;
  return nearest_rotation(out);
}

/// The shortest solution of least squares, also where the rows do not determine one.
VERNIER_LOCAL VectorX shortest_solution(const MatrixX& rows, const VectorX& right) {
  const ThinSvd svd = thin_svd(rows);
  VectorX along = transposed_product(svd.u, right);
  for (Index k = 0; k < along.size(); ++k) along(k) = svd.s(k) > 1e-12 * svd.s(0) ? along(k) / svd.s(k) : 0;
  return product(svd.v, along);
}

/// Angle and distance by which a pose is not where frames say it is.
VERNIER_LOCAL std::array<double, 2> missed_by(const HandEye& frames, const Isometry3& flange, const Isometry3& seen) {
  const Isometry3 model = composed(composed(frames.base, flange), frames.tool);
  const Matrix3 turn = rotation(model) * rotation(seen).transpose();
  return {log_so3(turn).norm(), (translation(model) - translation(seen)).norm()};
}

}  // namespace detail

VERNIER_IMPL HandEye hand_eye(std::span<const Isometry3> flanges, std::span<const Isometry3> seen,
                              std::span<const double> weights) {
  const std::size_t n = flanges.size();
  demand(n == seen.size() && n >= 3 && (weights.empty() || weights.size() == n), "hand_eye: ", n,
         " poses of the flange, ", seen.size(), " seen and ", weights.size(), " weights; at least 3 poses are needed");
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  // seen_i Z = X flange_i for the rotations X of the base and Z, the inverse of that of the tool
  MatrixX sum = MatrixX::Zero(9, 9);
  double total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix3 f = rotation(flanges[i]), p = rotation(seen[i]);
    total += weight(i);
    for (Index a = 0; a < 3; ++a)
      for (Index b = 0; b < 3; ++b)
        for (Index r = 0; r < 3; ++r)
          for (Index c = 0; c < 3; ++c) sum(3 * a + r, 3 * b + c) += weight(i) * f(b, a) * p(c, r);
  }
  const detail::ThinSvd svd = detail::thin_svd(sum);
  VectorX first = svd.u.col(0), second = svd.v.col(0);
  Matrix3 columns;
  for (Index k = 0; k < 9; ++k) columns(k % 3, k / 3) = first(k);
  if (columns.determinant() < 0) {
    first = -first;
    second = -second;
  }
  HandEye out;
  const Matrix3 tool = detail::rotation_of(first).transpose(), base = detail::rotation_of(second);
  out.spread = total > 0 ? 1 - svd.s(1) / total : 0;

  MatrixX rows(static_cast<Index>(3 * n), 6);  // seen = X f + b + X F t
  VectorX right(rows.rows());
  for (std::size_t i = 0; i < n; ++i) {
    const double root = std::sqrt(weight(i));
    const Matrix3 turned = base * rotation(flanges[i]);
    const Vector3 rest = translation(seen[i]) - base * translation(flanges[i]);
    for (Index r = 0; r < 3; ++r) {
      const Index row = static_cast<Index>(3 * i) + r;
      for (Index c = 0; c < 3; ++c) {
        rows(row, c) = r == c ? root : 0;
        rows(row, 3 + c) = root * turned(r, c);
      }
      right(row) = root * rest(r);
    }
  }
  const VectorX shifts = detail::shortest_solution(rows, right);
  out.base = rigid_motion(base, Vector3(shifts(0), shifts(1), shifts(2)));
  out.tool = rigid_motion(tool, Vector3(shifts(3), shifts(4), shifts(5)));
  double squared_turn = 0, squared_shift = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [turn, shift] = detail::missed_by(out, flanges[i], seen[i]);
    squared_turn += weight(i) * turn * turn;
    squared_shift += weight(i) * shift * shift;
  }
  if (total > 0) out.rotation_rms = std::sqrt(squared_turn / total);
  if (total > 0) out.translation_rms = std::sqrt(squared_shift / total);
  return out;
}

VERNIER_IMPL HandEye consistent_hand_eye(std::span<const Isometry3> flanges,
                                         std::span<const std::array<Isometry3, 2>> candidates) {
  const std::size_t n = flanges.size();
  demand(n == candidates.size() && n >= 3, "consistent_hand_eye: ", n, " poses of the flange and ", candidates.size(),
         " pairs; at least 3 are needed");
  std::vector<Isometry3> seen(n);
  std::vector<std::size_t> chosen(n, 0);
  std::vector<double> angles(n);
  // chooses the nearer candidate of every pose; the median of what remains
  const auto choose = [&](const HandEye& frames) {
    for (std::size_t i = 0; i < n; ++i) {
      std::array<double, 2> missed{};
      for (std::size_t k = 0; k < 2; ++k) missed[k] = detail::missed_by(frames, flanges[i], candidates[i][k])[0];
      chosen[i] = missed[1] < missed[0] ? 1 : 0;
      angles[i] = missed[chosen[i]];
      seen[i] = candidates[i][chosen[i]];
    }
    std::vector<double> sorted = angles;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
    return sorted[n / 2];
  };
  for (std::size_t i = 0; i < n; ++i) seen[i] = candidates[i][0];
  HandEye best = hand_eye(flanges, seen);
  double least = choose(best);
  Rng rng(1);
  constexpr std::size_t some = 4;  // poses of a draw
  const std::size_t drawn = (std::min)(n, some);
  for (int draw = 0; draw < 300 && n > 3; ++draw) {
    const std::vector<Index> order = rng.permutation(static_cast<Index>(n));
    std::vector<Isometry3> from, to;
    for (std::size_t k = 0; k < drawn; ++k) {
      const auto i = static_cast<std::size_t>(order[k]);
      from.push_back(flanges[i]);
      to.push_back(candidates[i][rng.uniform() < 0.7 ? 0 : 1]);
    }
    const HandEye frames = hand_eye(from, to);
    if (!(frames.spread > 1e-4) || frames.rotation_rms > 0.2) continue;
    const double median = choose(frames);
    if (median < least) {
      least = median;
      best = frames;
    }
  }
  std::vector<double> weights(n, 1);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double median = choose(best);
    const double limit = (std::max)(3 * median, 1e-6);
    for (std::size_t i = 0; i < n; ++i) weights[i] = angles[i] < limit ? 1 : 0;
    const std::vector<std::size_t> before = chosen;
    best = hand_eye(flanges, seen, weights);
    choose(best);
    if (chosen == before && iteration > 3) break;
  }
  best.chosen = chosen;
  return best;
}

}  // namespace vernier
