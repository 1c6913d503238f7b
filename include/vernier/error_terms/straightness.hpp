// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Errors of guides: how a prismatic joint departs from a straight motion.

#include <vector>

#include "vernier/core/types.hpp"
#include "vernier/kinematics/detail/chain_table.hpp"

namespace vernier {

/// The frame behind a prismatic joint moves by six smooth functions of the joint value q: along its x, y and z axes
/// [m], z along the guide, and about them [rad]. Each is `sum_k c_k cos(k pi u)`, k = 1 .. orders, u from 0 to 1 over
/// the joint's range, and constant beyond it. As for `GravityTilt`, motions of all joints add up to one of the arm's
/// end.
class Straightness {
 public:
  /// @param chain  nominal chain, whose geometry is accurate enough for frames
  /// @param ranges of each joint in which the functions vary [m]; those of revolute joints are not used
  /// @param orders of cosines, at least 1
  /// @throws std::invalid_argument for another number of ranges, a range that is empty, or fewer orders
  VERNIER_API Straightness(const detail::ChainTable& chain, std::vector<JointRange> ranges, int orders = 6);

  /// Number of joints.
  int joints() const { return chain_.joints(); }
  /// Number of cosines of each function.
  int orders() const { return orders_; }
  /// Ranges of the joints [m].
  const std::vector<JointRange>& ranges() const { return ranges_; }
  /// Prismatic joints, from 0.
  const std::vector<int>& guides() const { return guides_; }
  /// Number of coefficients: of each prismatic joint those of x, y, z and of the rotations about them.
  Index size() const { return 6 * orders_ * static_cast<Index>(guides_.size()); }

  /// Translation [m] and rotation vector [rad] of the arm's end by one unit of each coefficient.
  /// @param q   joints() values
  /// @param out 6 x size()
  VERNIER_API void basis(const double* q, MatrixRef out) const noexcept;
  /// The motion of the arm's end by given coefficients, and its derivative, as `GravityTilt::motion`. Does not
  /// allocate.
  VERNIER_API Vector6 motion(const double* q, const double* coefficients, double* rates = nullptr) const noexcept;

 private:
  detail::ChainTable chain_;
  std::vector<JointRange> ranges_;
  int orders_;
  std::vector<int> guides_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/straightness.ipp"
#endif
