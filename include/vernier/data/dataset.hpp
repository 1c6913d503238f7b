#pragma once

/// @file
/// Measured poses: joint values and measured positions, with or without orientations.

#include <span>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

namespace detail {

/// Whether a row has finite values only.
VERNIER_API bool finite_row(const ConstMatrixRef& values, Index row);
VERNIER_API void check_samples(const ConstMatrixRef& joints, const PointRows& positions, const PointRows& orientations);
/// Copies the named rows, in the given order, into a matrix of that many rows.
VERNIER_API void copy_rows(const ConstMatrixRef& from, std::span<const Index> indices, MatrixRef to);

}  // namespace detail

/// n samples of an N-joint arm: joints [rad, m], measured tool positions [m] and, where measured, orientations.
/// All values are finite. Samples keep the order in which they were measured.
template <int N>
class Dataset {
 public:
  Dataset() : joints_(0, N), positions_(0, 3), orientations_(0, 3) {}

  /// @param joints       n x N [rad, m]
  /// @param positions    n x 3 [m]
  /// @param orientations n x 3 rotation vectors [rad], or 0 x 3 where only positions were measured
  /// @throws std::invalid_argument when the numbers of rows differ or a value is not finite, naming the row
  Dataset(JointRows<N> joints, PointRows positions, PointRows orientations = PointRows(0, 3))
      : joints_(std::move(joints)), positions_(std::move(positions)), orientations_(std::move(orientations)) {
    detail::check_samples(joints_, positions_, orientations_);
  }

  /// Number of samples.
  Index size() const { return joints_.rows(); }
  /// Whether orientations were measured.
  bool has_orientations() const { return orientations_.rows() > 0; }

  /// Joint values [rad, m].
  const JointRows<N>& joints() const { return joints_; }
  /// Measured positions [m].
  const PointRows& positions() const { return positions_; }
  /// Measured rotation vectors [rad], 0 x 3 where only positions were measured.
  const PointRows& orientations() const { return orientations_; }

  /// Joint values of sample i [rad, m].
  JointVector<N> joints(Index i) const { return joints_.row(i).transpose(); }
  /// Measured position of sample i [m].
  Vector3 position(Index i) const { return positions_.row(i).transpose(); }
  /// Measured orientation; only where `has_orientations()`.
  Matrix3 orientation(Index i) const { return exp_so3(Vector3(orientations_.row(i).transpose())); }
  /// Measured pose; only where `has_orientations()`.
  Isometry3 pose(Index i) const {
    Isometry3 pose = Isometry3::Identity();
    pose.translation() = position(i);
    pose.linear() = orientation(i);
    return pose;
  }

  /// The named rows, in the given order.
  /// @throws std::invalid_argument on a row outside 0 .. size-1
  Dataset rows(std::span<const Index> indices) const {
    const auto n = static_cast<Index>(indices.size());
    Dataset out;
    out.joints_.resize(n, N);
    out.positions_.resize(n, 3);
    out.orientations_.resize(has_orientations() ? n : 0, 3);
    detail::copy_rows(joints_, indices, out.joints_);
    detail::copy_rows(positions_, indices, out.positions_);
    if (has_orientations()) detail::copy_rows(orientations_, indices, out.orientations_);
    return out;
  }

  /// The same samples with positions only.
  Dataset without_orientations() const {
    Dataset out = *this;
    out.orientations_.resize(0, 3);
    return out;
  }

 private:
  JointRows<N> joints_;
  PointRows positions_, orientations_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/dataset.ipp"
#endif
