// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which rows visit the same pose. A pose that was measured ten times is one piece of evidence on the arm, not ten:
/// what is known of nine of its rows says little about the arm and everything about the tenth. So the unit of all
/// splits, folds and left-out errors is the pose.

#include <span>
#include <vector>

#include "vernier/core/types.hpp"
#include "vernier/data/dataset.hpp"

namespace vernier {

/// Joint values that count as one pose.
struct SamePose {
  double angle = 1e-4;                          ///< largest difference of a revolute joint [rad]
  double length = 5e-5;                         ///< of a prismatic one [m]
  std::span<const JointType> joint_types = {};  ///< of each joint; none: all revolute
};

/// The pose of each row, numbered from 0 in the order of their first rows. A row visits the first pose whose first row
/// it agrees with, so chains of small differences make no pose.
/// @param joints n x joints [rad, m]
/// @param same   within which values rows are one pose
/// @throws std::invalid_argument for another number of joint types
/// @complexity O(n log n) where poses are spread over the joint ranges
VERNIER_API std::vector<Index> pose_numbers(const ConstMatrixRef& joints, const SamePose& same = {});

namespace detail {

/// Rows of each visit: those that follow one another at one pose, without a stated motion between them.
/// @param joints   n x joints
/// @param previous from where each was approached, n x joints; not finite where unknown
/// @param payloads n x 4, see `Dataset::payloads`: readings are under one payload; no rows where that is unknown
VERNIER_API std::vector<std::vector<Index>> readings_of_visits(const ConstMatrixRef& joints,
                                                               const ConstMatrixRef& previous, const SamePose& same,
                                                               const ConstMatrixRef& payloads = MatrixX());

/// The first row of each pose.
VERNIER_API std::vector<Index> first_rows(const std::vector<Index>& poses);

/// Mean of the rows of each pose.
VERNIER_API PointRows means_of_rows(const PointRows& values, const std::vector<Index>& poses);

/// Mean of some rows of rotation vectors.
VERNIER_API Vector3 mean_rotation(const PointRows& orientations, const std::vector<Index>& rows);

}  // namespace detail

/// Measurements with the readings of each visit as one row, their mean. Readings are rows that follow one another at
/// one pose, without a stated motion or change of payload between them. Joint values, payload, approach and line are
/// those of the first; times and temperatures are means.
template <int N>
Dataset<N> readings_joined(const Dataset<N>& data, const SamePose& same = {}) {
  const auto visits = detail::readings_of_visits(data.joints(), data.previous(), same, data.payloads());
  if (static_cast<Index>(visits.size()) == data.size()) return data;
  std::vector<Index> first;
  for (const auto& rows : visits) first.push_back(rows.front());
  const Dataset<N> kept = data.rows(first);
  PointRows positions = kept.positions(), orientations = kept.orientations();
  VectorX times = kept.times(), temperatures = kept.temperatures();
  std::vector<Matrix6> covariances = kept.covariances();
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const auto at = static_cast<Index>(v);
    const double n = static_cast<double>(visits[v].size());
    if (visits[v].size() == 1) continue;
    if (!covariances.empty()) {  // of the mean of independent readings
      Matrix6& sum = covariances[v];
      sum.setZero();
      for (const Index i : visits[v]) sum += data.covariances()[static_cast<std::size_t>(i)];
      sum /= n * n;
    }
    Vector3 position = Vector3::Zero();
    double time = 0, temperature = 0;
    for (const Index i : visits[v]) {
      position += data.position(i) / n;
      time += data.times()(i) / n;
      if (temperatures.size() > 0) temperature += data.temperatures()(i) / n;
    }
    set_point(positions, at, position);
    if (data.has_orientations()) set_point(orientations, at, detail::mean_rotation(data.orientations(), visits[v]));
    times(at) = time;
    if (temperatures.size() > 0) temperatures(at) = temperature;
  }
  return Dataset<N>(kept.joints(), positions, orientations)
      .approached_from(kept.previous())
      .measured_at(times)
      .at_temperatures(temperatures)
      .carrying(kept.payloads())
      .with_covariances(std::move(covariances))
      .from(kept.origin());
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/same_pose.ipp"
#endif
