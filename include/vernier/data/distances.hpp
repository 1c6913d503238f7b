#pragma once

/// @file
/// Measured distances: what the joints were, and how far the tool point was from a fixed point.

#include <cmath>
#include <span>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// n distances of the tool point of an N-joint arm from one fixed point, whose place need not be known: what a
/// draw-wire encoder, a ball-bar or a laser distance meter gives. All values are finite, distances positive.
template <int N>
class Distances {
 public:
  Distances() : joints_(0, N) {}

  /// @param joints  n x N [rad, m]
  /// @param lengths n distances from the fixed point to the tool point [m]
  /// @throws std::invalid_argument when the numbers of rows differ or a value is unusable, naming the row
  Distances(JointRows<N> joints, VectorX lengths) : joints_(std::move(joints)), lengths_(std::move(lengths)) {
    require(joints_.rows() == lengths_.size(), "Distances: ", joints_.rows(), " rows of joints, but ", lengths_.size(),
            " distances");
    for (Index i = 0; i < size(); ++i) {
      require(joints_.row(i).allFinite() && std::isfinite(lengths_(i)), "Distances: row ", i,
              " has a value that is not finite");
      require(lengths_(i) > 0, "Distances: row ", i, " has a distance of ", lengths_(i), " m, must be positive");
    }
  }

  /// Number of samples.
  Index size() const { return joints_.rows(); }
  /// Joint values [rad, m].
  const JointRows<N>& joints() const { return joints_; }
  /// Joint values [rad, m].
  JointVector<N> joints(Index i) const { return joints_.row(i).transpose(); }
  /// Measured distances [m].
  const VectorX& lengths() const { return lengths_; }
  /// Measured distance of sample i [m].
  double length(Index i) const { return lengths_(i); }

  /// The named rows, in the given order.
  /// @throws std::invalid_argument on a row outside 0 .. size-1
  Distances rows(std::span<const Index> indices) const {
    Distances out;
    out.joints_.resize(static_cast<Index>(indices.size()), N);
    out.lengths_.resize(out.joints_.rows());
    for (Index i = 0; i < out.size(); ++i) {
      const Index from = indices[static_cast<std::size_t>(i)];
      require(from >= 0 && from < size(), "Distances::rows: row ", from, " of ", size());
      out.joints_.row(i) = joints_.row(from);
      out.lengths_(i) = lengths_(from);
    }
    return out;
  }

 private:
  JointRows<N> joints_;
  VectorX lengths_;
};

}  // namespace vernier
