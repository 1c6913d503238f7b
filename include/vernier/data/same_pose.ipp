// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <map>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/same_pose.hpp"

namespace vernier {

namespace detail {

/// Largest difference of each joint within a pose.
VERNIER_LOCAL VectorX pose_tolerances(Index joints, const SamePose& same) {
  demand(same.joint_types.empty() || static_cast<Index>(same.joint_types.size()) == joints,
         "SamePose: ", same.joint_types.size(), " types of joints for ", joints, " joints");
  VectorX out = VectorX::Constant(joints, same.angle);
  for (std::size_t j = 0; j < same.joint_types.size(); ++j)
    if (same.joint_types[j] == JointType::prismatic) out(static_cast<Index>(j)) = same.length;
  return out;
}

/// Whether two rows are one pose; false where a value is not finite.
VERNIER_LOCAL bool agree(const ConstMatrixRef& a, Index row, const ConstMatrixRef& b, Index other,
                         const VectorX& tolerances) {
  for (Index j = 0; j < tolerances.size(); ++j)
    if (!(std::abs(a(row, j) - b(other, j)) <= tolerances(j))) return false;
  return true;
}

}  // namespace detail

VERNIER_IMPL std::vector<Index> pose_numbers(const ConstMatrixRef& joints, const SamePose& same) {
  const Index n = joints.rows(), columns = joints.cols();
  const VectorX tolerances = detail::pose_tolerances(columns, same);
  // a sum by which rows are found again: those of one pose differ in it by no more than `width`
  const auto weighted = [&](const auto& value) {
    double sum = 0;
    for (Index j = 0; j < columns; ++j) sum += (1 + 0.37 * static_cast<double>(j)) * value(j);
    return sum;
  };
  const double width = weighted([&](Index j) { return tolerances(j); });
  std::multimap<double, Index> firsts;  // first rows of poses
  std::vector<Index> out(static_cast<std::size_t>(n));
  Index poses = 0;
  for (Index i = 0; i < n; ++i) {
    const double sum = weighted([&](Index j) { return joints(i, j); });
    Index first = n;
    for (auto it = firsts.lower_bound(sum - width); it != firsts.end() && it->first <= sum + width; ++it)
      if (it->second < first && detail::agree(joints, i, joints, it->second, tolerances)) first = it->second;
    const bool known = first < n;
    if (!known) firsts.emplace(sum, i);
    out[static_cast<std::size_t>(i)] = known ? out[static_cast<std::size_t>(first)] : poses++;
  }
  return out;
}

namespace detail {

VERNIER_IMPL std::vector<std::vector<Index>> readings_of_visits(const ConstMatrixRef& joints,
                                                                const ConstMatrixRef& previous, const SamePose& same,
                                                                const ConstMatrixRef& payloads) {
  const VectorX tolerances = pose_tolerances(joints.cols(), same);
  std::vector<std::vector<Index>> out;
  for (Index i = 0; i < joints.rows(); ++i) {
    bool again = i > 0 && agree(joints, i, joints, out.back().front(), tolerances);
    if (again &&
        VERNIER_LATER(previous).row(i).allFinite())  // moved in between, unless it stood there or came as before
      again = agree(previous, i, joints, i, tolerances) || agree(previous, i, previous, i - 1, tolerances);
    for (Index k = 0; again && k < payloads.cols(); ++k)  // where centres are not known they are all the same
      again = !(std::abs(payloads(i, k) - payloads(i - 1, k)) > 1e-6);
    if (!again) out.emplace_back();
    out.back().push_back(i);
  }
  return out;
}

VERNIER_IMPL std::vector<Index> first_rows(const std::vector<Index>& poses) {
  std::vector<Index> out;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (poses[i] == static_cast<Index>(out.size())) out.push_back(static_cast<Index>(i));
  return out;
}

VERNIER_IMPL PointRows means_of_rows(const PointRows& values, const std::vector<Index>& poses) {
  const auto n = static_cast<Index>(first_rows(poses).size());
  if (n == values.rows()) return values;
  PointRows out = PointRows::Zero(n, 3);
  std::vector<double> count(static_cast<std::size_t>(n), 0);
  for (const Index pose : poses) count[static_cast<std::size_t>(pose)] += 1;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (Index c = 0; c < 3; ++c)
      out(poses[i], c) += values(static_cast<Index>(i), c) / count[static_cast<std::size_t>(poses[i])];
  return out;
}

VERNIER_IMPL Vector3 mean_rotation(const PointRows& orientations, const std::vector<Index>& rows) {
  const Matrix3 first = exp_so3(point(orientations, rows.front()));
  Vector3 sum = Vector3::Zero();
  for (const Index i : rows) sum += rotation_difference(exp_so3(point(orientations, i)), first);
  const Matrix3 mean = exp_so3(Vector3(sum / static_cast<double>(rows.size()))) * first;
  return log_so3(mean);
}

}  // namespace detail

}  // namespace vernier
