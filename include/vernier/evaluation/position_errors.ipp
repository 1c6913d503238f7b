// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/position_errors.hpp"

#include <algorithm>
#include <cmath>

#include "vernier/core/so3.hpp"

namespace vernier {

VERNIER_IMPL ErrorStatistics ErrorStatistics::of(const ConstVectorRef& errors) {
  demand(errors.size() >= 1, "ErrorStatistics: no errors");
  VectorX sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  return {errors.mean(),
          std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size())),
          sorted(sorted.size() - 1),
          sorted(0),
          detail::quantile_of_sorted(sorted, 0.5),
          detail::quantile_of_sorted(sorted, 0.95),
          errors.size()};
}

namespace detail {

VERNIER_IMPL VectorX position_errors_of(std::span<const Isometry3> predicted, const PointRows& positions) {
  VectorX errors(positions.rows());
  for (Index i = 0; i < errors.size(); ++i)
    errors(i) = (VERNIER_LATER(point(positions, i)) - translation(predicted[static_cast<std::size_t>(i)])).norm();
  return errors;
}

VERNIER_IMPL VectorX rotation_errors_of(std::span<const Isometry3> predicted, const PointRows& orientations) {
  VectorX errors(orientations.rows());
  for (Index i = 0; i < errors.size(); ++i) {
    const Matrix3 measured = exp_so3(point(orientations, i));
    errors(i) = rotation_difference(measured, rotation(predicted[static_cast<std::size_t>(i)])).norm();
  }
  return errors;
}

VERNIER_IMPL PositioningErrors pose_errors(std::span<const Isometry3> desired, std::span<const Isometry3> reached) {
  const auto n = static_cast<Index>(desired.size());
  PositioningErrors errors{VectorX(n), VectorX(n)};
  for (std::size_t i = 0; i < desired.size(); ++i) {
    errors.position(static_cast<Index>(i)) = (translation(desired[i]) - translation(reached[i])).norm();
    errors.rotation(static_cast<Index>(i)) = rotation_difference(rotation(desired[i]), rotation(reached[i])).norm();
  }
  return errors;
}

}  // namespace detail

}  // namespace vernier
