// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured poses: joint values and measured positions, with or without orientations; their approach and times.

#include <limits>
#include <span>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/core/types.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier {

namespace detail {

/// Whether a row has finite values only.
VERNIER_API bool finite_row(const ConstMatrixRef& values, Index row);
VERNIER_API void check_measured_samples(const ConstMatrixRef& joints, const PointRows& positions,
                                        const PointRows& orientations);
VERNIER_API [[noreturn]] void refuse_coordinates(Index columns);
VERNIER_API void check_covariances(const std::vector<Matrix6>& covariances, Index samples, bool oriented);
/// Whether the first rows and columns of a symmetric matrix, as many as are measured, are positive definite.
VERNIER_API bool positive_definite(const Matrix6& covariance, Index measured);
VERNIER_API void check_payloads(const MatrixX& payloads, Index rows);

/// Points, one a row, in a matrix of either kind.
/// @throws std::invalid_argument on another number of coordinates than three
template <class Rows>
PointRows fixed_points(const Rows& rows) {
  if constexpr (ColumnsAtRunTime<Rows>) {
    if (rows.cols() != 3) [[unlikely]]
      refuse_coordinates(rows.cols());
    return PointRows(rows);
  } else {
    return rows;
  }
}

/// Copies the named rows, in the given order, into a matrix of that many rows.
VERNIER_API void copy_rows(const ConstMatrixRef& from, std::span<const Index> indices, MatrixRef to);

}  // namespace detail

/// n samples of an N-joint arm: joints [rad, m], measured tool positions [m] and, where measured, orientations.
/// All values are finite. Samples are taken to be in the order of measuring; each keeps the joint values from which it
/// was approached and the time of its measurement, also in a subset.
template <int N>
class Dataset {
 public:
  Dataset() : joints_(0, N), positions_(0, 3), orientations_(0, 3), previous_(0, N) {}

  /// @param joints       n x N [rad, m]
  /// @param positions    n x 3 [m]
  /// @param orientations n x 3 rotation vectors [rad], or 0 x 3 where only positions were measured
  /// @throws std::invalid_argument when the numbers of rows differ or a value is not finite, naming the row
  Dataset(JointRows<N> joints, PointRows positions, PointRows orientations = PointRows(0, 3))
      : joints_(std::move(joints)), positions_(std::move(positions)), orientations_(std::move(orientations)) {
    detail::check_measured_samples(joints_, positions_, orientations_);
    previous_ = JointRows<N>::Constant(size(), N, std::numeric_limits<double>::quiet_NaN());
    if (size() > 1) previous_.bottomRows(size() - 1) = joints_.topRows(size() - 1);
    times_ = VectorX::LinSpaced(size(), 0, static_cast<double>(size() - 1));
  }
  /// Samples in matrices of which some have a number of columns that is known at run time only.
  /// @throws std::invalid_argument when that number is another, beside what the other constructor refuses
  template <class Joints, class Positions, class Orientations = PointRows>
    requires(ColumnsAtRunTime<Joints> || ColumnsAtRunTime<Positions> || ColumnsAtRunTime<Orientations>)
  Dataset(const Joints& joints, const Positions& positions, const Orientations& orientations = PointRows(0, 3))
      : Dataset(detail::fixed_rows<N>(joints), detail::fixed_points(positions), detail::fixed_points(orientations)) {}

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

  /// Joint values from which each sample was approached [rad, m]: those of the sample before, unless stated otherwise;
  /// NaN where they are unknown.
  const JointRows<N>& previous() const { return previous_; }
  /// Time of each sample's measurement: its number in the order of measuring, unless stated otherwise.
  const VectorX& times() const { return times_; }
  /// Temperatures of the arm [deg C], one a sample; none where they were not measured.
  const VectorX& temperatures() const { return temperatures_; }

  /// What the arm carried at each sample, n x 4: mass [kg], and its centre in the frame of the flange [m], NaN for the
  /// tool point; no rows where that is unknown.
  const MatrixX& payloads() const { return payloads_; }

  /// These samples approached from other joint values; rows that are not finite are unknown.
  /// @throws std::invalid_argument for another number of rows
  Dataset approached_from(JointRows<N> previous) const {
    demand(previous.rows() == size(), "Dataset: ", previous.rows(), " previous configurations of ", size(), " rows");
    Dataset out = *this;
    out.previous_ = std::move(previous);
    return out;
  }
  /// These samples approached from other joint values, whose number is known at run time.
  /// @throws std::invalid_argument for another number of rows or columns
  template <ColumnsAtRunTime Rows>
  Dataset approached_from(const Rows& previous) const {
    return approached_from(detail::joint_rows<N>(previous));
  }
  /// These samples, their approach unknown.
  Dataset without_approach() const {
    return approached_from(JointRows<N>::Constant(size(), N, std::numeric_limits<double>::quiet_NaN()));
  }
  /// These samples measured at other times, in any unit.
  /// @throws std::invalid_argument for another number of times, or one that is not finite
  Dataset measured_at(VectorX times) const {
    demand(times.size() == size() && times.allFinite(), "Dataset: ", times.size(), " times of ", size(),
           " rows, all must be finite");
    Dataset out = *this;
    out.times_ = std::move(times);
    return out;
  }

  /// These samples measured at some temperatures [deg C]; none for unknown.
  /// @throws std::invalid_argument for another number of temperatures, or one that is not finite
  Dataset at_temperatures(VectorX temperatures) const {
    demand((temperatures.size() == 0 || temperatures.size() == size()) && temperatures.allFinite(),
           "Dataset: ", temperatures.size(), " temperatures of ", size(), " rows, all must be finite");
    Dataset out = *this;
    out.temperatures_ = std::move(temperatures);
    return out;
  }

  /// Covariances of position and rotation vector of each sample, in the sensor's frame: shifts are added, rotations
  /// multiplied from the left [m, rad]; none where all samples have the sensor's standard deviations.
  const std::vector<Matrix6>& covariances() const { return covariances_; }
  /// These samples with covariances; of positions alone the first three rows and columns count.
  /// @throws std::invalid_argument for another number, or a matrix that is not positive definite, naming the row
  Dataset with_covariances(std::vector<Matrix6> covariances) const {
    detail::check_covariances(covariances, size(), has_orientations());
    Dataset out = *this;
    out.covariances_ = std::move(covariances);
    return out;
  }

  /// These samples measured under some payloads, as `payloads()` has them; no rows for unknown.
  /// @throws std::invalid_argument for another number of rows, or a mass that is negative or not finite
  Dataset carrying(MatrixX payloads) const {
    detail::check_payloads(payloads, size());
    Dataset out = *this;
    out.payloads_ = std::move(payloads);
    return out;
  }

  /// Where the samples stand in files; empty where they are from none.
  const RowOrigin& origin() const { return origin_; }
  /// These samples, said to be from some rows of files.
  /// @throws std::invalid_argument for another number of rows
  Dataset from(RowOrigin origin) const {
    demand(origin.empty() || static_cast<Index>(origin.line.size()) == size(), "Dataset: ", origin.line.size(),
           " lines of ", size(), " rows");
    Dataset out = *this;
    out.origin_ = std::move(origin);
    return out;
  }

  /// Joint values of sample i [rad, m].
  JointVector<N> joints(Index i) const { return configuration(joints_, i); }
  /// Measured position of sample i [m].
  Vector3 position(Index i) const { return point(positions_, i); }
  /// Measured orientation; only where `has_orientations()`.
  Matrix3 orientation(Index i) const { return exp_so3(point(orientations_, i)); }
  /// Measured pose; only where `has_orientations()`.
  Isometry3 pose(Index i) const { return rigid_motion(orientation(i), position(i)); }

  /// The named rows, in the given order.
  /// @throws std::invalid_argument on a row outside 0 .. size-1
  Dataset rows(std::span<const Index> indices) const {
    const auto n = static_cast<Index>(indices.size());
    Dataset out;
    out.joints_.resize(n, N);
    out.positions_.resize(n, 3);
    out.orientations_.resize(has_orientations() ? n : 0, 3);
    out.previous_.resize(n, N);
    out.times_.resize(n);
    detail::copy_rows(joints_, indices, out.joints_);
    detail::copy_rows(previous_, indices, out.previous_);
    detail::copy_rows(times_, indices, out.times_);
    if (temperatures_.size() > 0) {
      out.temperatures_.resize(n);
      detail::copy_rows(temperatures_, indices, out.temperatures_);
    }
    if (payloads_.rows() > 0) {
      out.payloads_.resize(n, 4);
      detail::copy_rows(payloads_, indices, out.payloads_);
    }
    detail::copy_rows(positions_, indices, out.positions_);
    if (has_orientations()) detail::copy_rows(orientations_, indices, out.orientations_);
    for (const Index row : indices)
      if (!covariances_.empty()) out.covariances_.push_back(covariances_[static_cast<std::size_t>(row)]);
    out.origin_ = origin_.rows(indices);
    return out;
  }

  /// These samples with positions only.
  Dataset without_orientations() const {
    Dataset out = *this;
    out.orientations_.resize(0, 3);
    return out;
  }

 private:
  JointRows<N> joints_;
  PointRows positions_, orientations_;
  JointRows<N> previous_;
  VectorX times_{}, temperatures_{};
  MatrixX payloads_{};
  std::vector<Matrix6> covariances_{};
  RowOrigin origin_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/dataset.ipp"
#endif
