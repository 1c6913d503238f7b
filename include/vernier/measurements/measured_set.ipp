// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier {

VERNIER_IMPL void MeasuredSet::validate() const {
  demand(size_ == joints.rows(), name, ": ", joints.rows(), " rows of joints, but ", size_, " measurements");
  demand(values_ == 1 || values_ == 3 || values_ == 6, name, ": a sensor has 1, 3 or 6 values, not ", values_);
  demand(sigma_.length > 0 && std::isfinite(sigma_.length) && sigma_.angle > 0 && std::isfinite(sigma_.angle), name,
         ": standard deviations of ", sigma_.length, " m and ", sigma_.angle, " rad must be positive");
  demand(!correlated() || static_cast<Index>(covariances_->size()) == size_, name, ": ",
         covariances_ == nullptr ? 0 : covariances_->size(), " covariances of ", size_, " measurements");
  for (Index i = 0; i < joints.rows(); ++i)
    demand(detail::finite_row(joints, i), name, ", ", origin.where(i), ": a joint value is not finite");
}

VERNIER_IMPL Matrix6 MeasuredSet::relative_covariance(Index i) const {
  Matrix6 out = (*covariances_)[static_cast<std::size_t>(i % size_)];
  for (Index c = 0; c < 6; ++c)
    for (Index r = 0; r < 6; ++r) {
      const bool measured = (std::max)(r, c) < values_;
      const double scale = (r < 3 ? sigma_.length : sigma_.angle) * (c < 3 ? sigma_.length : sigma_.angle);
      out(r, c) = measured ? out(r, c) / scale : r == c ? 1 : 0;
    }
  return out;
}

VERNIER_IMPL bool MeasuredSet::locates() const {
  return seen_from.rows() == 0 && values_ >= 3 &&
         std::all_of(unknown_frame_.begin(), unknown_frame_.end(), [](bool unknown) { return unknown; });
}

VERNIER_IMPL std::vector<Isometry3> MeasuredSet::seen_poses(
    FunctionRef<std::vector<Isometry3>(const MatrixX& joints)> poses_of) const {
  std::vector<Isometry3> out = poses_of(joints);
  if (seen_from.rows() == 0) return out;
  const std::vector<Isometry3> from = poses_of(seen_from);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = composed(inverse_of(from[i]), out[i]);
  return out;
}

VERNIER_IMPL void MeasuredSet::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  const Index reading = i % size_;
  if (turned_.isIdentity(0)) return functions_->sense(sensor_.get(), reading, pose, rows);
  const Matrix3 turn = turned_ * rotation(pose);
  const Vector3 point = turned_ * translation(pose);
  functions_->sense(sensor_.get(), reading, rigid_motion(turn, point), rows);
  for (Index block = 0; block < 6; block += 3)
    for (Index r = 0; r < 6; ++r) {
      const Vector3 row(rows.motion(r, block), rows.motion(r, block + 1), rows.motion(r, block + 2));
      const Vector3 turned = turned_ * row;  // half a turn is its own transpose
      for (Index c = 0; c < 3; ++c) rows.motion(r, block + c) = turned(c);
    }
}

VERNIER_IMPL Isometry3 MeasuredSet::register_base(std::span<const Isometry3> poses) {
  turned_.setIdentity();
  const Isometry3 base = functions_->base_from(sensor_.get(), poses);
  const bool some = unknown_frame_[3] || unknown_frame_[4] || unknown_frame_[5];
  const bool all = unknown_frame_[3] && unknown_frame_[4] && unknown_frame_[5];
  const Vector3 turn = log_so3(rotation(base));
  const double angle = turn.norm();
  if (!some || all || angle <= std::numbers::pi / 2 || std::abs(turn.z()) > 1e-9 * angle) return base;
  turned_ = exp_so3(Vector3(turn * (std::numbers::pi / angle)));
  return composed(rigid_motion(turned_, Vector3::Zero()), base);
}

VERNIER_IMPL MeasuredSet MeasuredSet::with(const SensorModel& sensors) const {
  sensors.validate();
  return functions_->with(*this, sensors);
}

VERNIER_IMPL MeasuredSet MeasuredSet::at_joints(MatrixX other) const {
  MeasuredSet out = *this;
  out.joints = std::move(other);
  out.previous.resize(0, 0);
  if (seen_from.rows() > 0) {  // the same configurations, in another order
    out.seen_from = out.joints;
    for (Index i = 0; i < out.size(); ++i)
      for (Index j = 0; j < out.joints.cols(); ++j) out.seen_from(i, j) = out.joints(out.size() - 1 - i, j);
  }
  out.times.resize(0);
  out.temperatures.resize(0);
  out.payloads.resize(0, 0);
  out.origin = {};
  return out;
}

namespace detail {

VERNIER_IMPL std::size_t first_of_place(std::span<const MeasuredSet> sets, std::size_t set) {
  for (std::size_t s = 0; s < set && !sets[set].place.empty() && sets[set].locates(); ++s)
    if (sets[s].place == sets[set].place && sets[s].locates()) return s;
  return set;
}

VERNIER_IMPL std::size_t first_of_point(std::span<const MeasuredSet> sets, std::size_t set, bool own_tools) {
  for (std::size_t s = 0; s < set && !own_tools; ++s)
    if (sets[s].reflector == sets[set].reflector) return s;
  return set;
}

}  // namespace detail

}  // namespace vernier
