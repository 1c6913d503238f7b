// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whitened rows of a least-squares problem, in blocks of up to six: a block is a measured pose, position or distance.

#include <algorithm>
#include <array>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Six rows, any number of columns.
using Rows6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;

namespace detail {

/// The j-th column of six rows.
VERNIER_API inline Vector6 column_of(const Rows6& rows, Index j) {
  Vector6 out;
  std::copy_n(rows.data() + 6 * j, 6, out.data());
  return out;
}

}  // namespace detail

/// Residual (model minus measured) of a block and its derivatives with respect to the unknowns, all divided by the
/// standard deviations of the measurement. Rows that were not measured are zero. Three kinds of unknowns:
/// - dense ones, each with a column;
/// - groups of factored ones: the columns of group j are the outer product of one vector and the values of the group's
///   functions, so they enter sums as one row (harmonics of a joint act through one Jacobian column);
/// - local states, which only some blocks depend on (a knot of a session's drift, the readings of one pose): a block
///   depends on at most two.
struct RowBlock {
  /// Columns of a local state.
  struct Local {
    Index state = -1;  ///< which one; negative for none
    Rows6 columns{};   ///< 6 x local_size
  };

  Vector6 residual;              ///< whitened
  Rows6 dense;                   ///< 6 x dense
  Rows6 factor;                  ///< 6 x groups, or empty where no group has a function
  VectorX functions;             ///< of all groups, group by group
  std::array<Local, 2> local{};  ///< the local states
  Matrix6 unwhiten;              ///< takes whitened residuals to multiples of the sensor's standard deviations
  double position_sigma = 1;     ///< standard deviation of the first three rows then [m]

  /// Writes the columns of all dense and factored unknowns, 6 x unknowns.
  VERNIER_API void expand(const std::vector<Index>& group_sizes, Rows6& out) const;
};

/// A least-squares problem at its present values.
struct BlockSystem {
  Index blocks;                    ///< number of blocks
  Index validation_blocks;         ///< the first blocks, on which leave-one-out errors validate
  Index dense;                     ///< number of dense unknowns
  std::vector<Index> group_sizes;  ///< number of functions of each group of factored unknowns
  /// Evaluates blocks first .. first + count - 1; must outlive this.
  FunctionRef<void(Index first, Index count, RowBlock* out)> rows;
  Index local_states = 0;  ///< number of local states
  Index local_size = 0;    ///< unknowns of a local state
  /// Pose of each validation block, from 0: blocks of one pose are left out together. Empty: each is of its own.
  std::vector<Index> poses{};

  /// Number of groups.
  Index groups() const { return static_cast<Index>(group_sizes.size()); }
  /// Number of dense and factored unknowns.
  Index unknowns() const {
    Index sum = dense;
    for (const Index size : group_sizes) sum += size;
    return sum;
  }
  /// Number of local unknowns.
  Index local_unknowns() const { return local_states * local_size; }
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/row_block.ipp"
#endif
