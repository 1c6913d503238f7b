// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/object_errors.hpp"

namespace vernier {

namespace detail {

/// By how much the known lengths of an object are off, as a share: one more unknown beside its frame, linearised.
VERNIER_LOCAL double length_share(const StackedRows& rows, const Contact& contact, Index values, double sigma) {
  const Index n = rows.residuals.size(), frame = rows.jacobian.cols();
  if (n <= frame) return std::numeric_limits<double>::quiet_NaN();
  MatrixX columns(n, frame + 1), right(n, 1);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < frame; ++k) columns(i, k) = rows.jacobian(i, k);
    // along the bar, across the face, outwards from the centre of the ball: the last value of a touch
    columns(i, frame) = i % values == values - 1 ? -contact.known()(i / values) / sigma : 0;
    right(i, 0) = -rows.residuals(i);
  }
  const double size = std::sqrt(VERNIER_LATER(columns).col(frame).squaredNorm());
  const QrSolution found = solve_by_qr(columns, right);
  const double apart = std::abs(found.triangle(frame, frame));  // what the frame leaves of that column
  return apart > 1e-6 * size ? found.solution(frame, 0) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace detail

VERNIER_IMPL double ObjectErrors::rms() const {
  return std::sqrt(distances.squaredNorm() / static_cast<double>((std::max)(Index{1}, distances.size())));
}

VERNIER_IMPL ObjectErrors object_errors(const ArmGeometry& arm, const Contact& contact) {
  using namespace detail;
  demand(contact.joints().cols() == arm.joints(), "contact ", contact.name(), ": ", contact.joints().cols(),
         " joints, the arm has ", arm.joints());
  MeasuredSet set = contact_set(contact);
  const ArmGeometry start = placed(arm, set);
  std::vector<GeometricUnknown> frame;
  for (const Index k : frame_unknowns(set)) frame.push_back({k, -1, 1e-3, 0});
  CalibrationProblem problem(ArmParameterisation({start}, std::move(frame)), {set}, Loss::squared);
  problem.joint_columns = false;
  problem.solve();
  const StackedRows rows = problem.stacked(true);
  const Index values = set.values();
  const double sigma = set.sigma().length;
  ObjectErrors out{contact.name(), contact.kind(), VectorX(contact.size()), arm.positions(contact.joints())};
  for (Index i = 0; i < contact.size(); ++i) {
    double square = 0;
    for (Index k = 0; k < values; ++k) square += std::pow(rows.residuals(values * i + k), 2);
    out.distances(i) = sigma * std::sqrt(square);
  }
  if (!contact.has_length()) return out;
  double longest = 0;
  for (const double length : contact.known()) longest = std::abs(length) > std::abs(longest) ? length : longest;
  out.length_error = std::abs(longest) * length_share(rows, contact, values, sigma);
  return out;
}

}  // namespace vernier
