// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured distances of the tool point from a fixed point.

#include <span>
#include <utility>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/types.hpp"
#include "vernier/data/dataset.hpp"

namespace vernier {

namespace detail {

VERNIER_API void check_distances(const ConstMatrixRef& joints, const VectorX& lengths);

}  // namespace detail

/// n distances of the tool point of an N-joint arm from one fixed point, whose position need not be known: measured by
/// a draw-wire encoder, a ball-bar or a laser distance meter. All values are finite, distances positive.
template <int N>
class Distances {
 public:
  Distances() : joints_(0, N) {}

  /// @param joints  n x N [rad, m]
  /// @param lengths n distances from the fixed point to the tool point [m]
  /// @throws std::invalid_argument when the numbers of rows differ or a value is not finite or a distance not positive,
  /// naming the row
  Distances(JointRows<N> joints, VectorX lengths) : joints_(std::move(joints)), lengths_(std::move(lengths)) {
    detail::check_distances(joints_, lengths_);
  }
  /// Distances at joint values whose number is known at run time.
  /// @throws std::invalid_argument for another number of columns, beside what the other constructor refuses
  template <ColumnsAtRunTime Rows>
  Distances(const Rows& joints, VectorX lengths) : Distances(detail::joint_rows<N>(joints), std::move(lengths)) {}

  /// Number of samples.
  Index size() const { return joints_.rows(); }
  /// Joint values [rad, m].
  const JointRows<N>& joints() const { return joints_; }
  /// Joint values of sample i [rad, m].
  JointVector<N> joints(Index i) const { return configuration(joints_, i); }
  /// Measured distances [m].
  const VectorX& lengths() const { return lengths_; }
  /// Measured distance of sample i [m].
  double length(Index i) const { return lengths_(i); }

  /// Where the samples stand in files; empty where they are from none.
  const RowOrigin& origin() const { return origin_; }
  /// These samples, said to be from some rows of files.
  Distances from(RowOrigin origin) const {
    Distances out = *this;
    out.origin_ = std::move(origin);
    return out;
  }

  /// The named rows, in the given order.
  /// @throws std::invalid_argument on a row outside 0 .. size-1
  Distances rows(std::span<const Index> indices) const {
    Distances out;
    out.joints_.resize(static_cast<Index>(indices.size()), N);
    out.lengths_.resize(out.joints_.rows());
    detail::copy_rows(joints_, indices, out.joints_);
    detail::copy_rows(lengths_, indices, out.lengths_);
    out.origin_ = origin_.rows(indices);
    return out;
  }

 private:
  JointRows<N> joints_;
  VectorX lengths_;
  RowOrigin origin_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/distances.ipp"
#endif
