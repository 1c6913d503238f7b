#pragma once

/// @file
/// Measured poses: what the joints were, and where the tool was seen.

#include <span>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

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
    require(joints_.rows() == positions_.rows(), "Dataset: ", joints_.rows(), " rows of joints, but ",
            positions_.rows(), " rows of positions");
    require(orientations_.rows() == 0 || orientations_.rows() == joints_.rows(), "Dataset: ", joints_.rows(),
            " rows of joints, but ", orientations_.rows(), " rows of orientations");
    for (Index i = 0; i < size(); ++i)
      require(joints_.row(i).allFinite() && positions_.row(i).allFinite() &&
                  (!has_orientations() || orientations_.row(i).allFinite()),
              "Dataset: row ", i, " has a value that is not finite");
  }

  /// Number of samples.
  Index size() const { return joints_.rows(); }
  /// Whether orientations were measured.
  bool has_orientations() const { return orientations_.rows() > 0; }

  /// Joint values [rad, m].
  const JointRows<N>& joints() const { return joints_; }
  /// Measured positions [m].
  const PointRows& positions() const { return positions_; }
  const PointRows& orientations() const {
    return orientations_;
  }  ///< rotation vectors [rad], 0 x 3 where there are none

  /// Joint values [rad, m].
  JointVector<N> joints(Index i) const { return joints_.row(i).transpose(); }
  /// Measured position of sample i [m].
  Vector3 position(Index i) const { return positions_.row(i).transpose(); }
  /// Measured orientation; only where `has_orientations()`.
  Matrix3 orientation(Index i) const { return exp_so3(orientations_.row(i).transpose()); }
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
    for (Index i = 0; i < n; ++i) {
      const Index from = indices[static_cast<std::size_t>(i)];
      require(from >= 0 && from < size(), "Dataset::rows: row ", from, " of ", size());
      out.joints_.row(i) = joints_.row(from);
      out.positions_.row(i) = positions_.row(from);
      if (has_orientations()) out.orientations_.row(i) = orientations_.row(from);
    }
    return out;
  }

 private:
  JointRows<N> joints_;
  PointRows positions_, orientations_;
};

}  // namespace vernier
