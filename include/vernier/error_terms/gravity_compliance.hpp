// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Elastic deflection of joints under the weight of the arm and its payload.

#include "vernier/kinematics/detail/chain_table.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// Joint torques by gravity of unit weights at the ends of the links. With a spring of compliance c_i at joint i
/// [rad/(N m)] and weights W_j [N] the joint deflects by `sum_j c_i W_j torque(i, j)`: only the products c_i W_j
/// [rad/m] are identifiable, so they are the parameters, N (N + 1) / 2 of them; a payload adds to those of the last
/// link.
class GravityCompliance {
 public:
  /// @param chain nominal chain, whose geometry is accurate enough for torques
  /// @param down  direction of gravity in the base frame of the chain; a unit vector
  /// @throws std::invalid_argument on a direction whose length is not 1
  template <int N, class Convention>
  explicit GravityCompliance(const DhChain<N, Convention>& chain, const Vector3& down = Vector3(0, 0, -1))
      : GravityCompliance(detail::ChainTable(chain.view()), down) {}
  /// Compliance columns of an arm whose number of joints is known at run time.
  VERNIER_API GravityCompliance(const detail::ChainTable& chain, const Vector3& down);

  /// Direction of gravity in the base frame of the chain.
  const Vector3& down() const { return down_; }
  /// Number of joints.
  int joints() const { return chain_.joints(); }
  /// Number of products: joint i carries the links j >= i.
  Index size() const { return size(joints()); }
  /// Number of products of an arm of n joints.
  static constexpr Index size(int n) { return n * (n + 1) / 2; }
  /// Position of the product of joint i and link j >= i, both from 0, of an arm of n joints.
  static constexpr Index index(int i, int j, int n) { return i * n - i * (i - 1) / 2 + (j - i); }
  /// Position of the product of joint i and link j >= i, both from 0, of this arm.
  Index index(int i, int j) const { return index(i, j, joints()); }

  /// Joint errors by one unit of each product: [N m] for a weight of 1 N (or [N] at a prismatic joint).
  /// @param q   joints() values
  /// @param out joints x size
  VERNIER_API void basis(const double* q, MatrixRef out) const noexcept;
  /// Adds the joint errors of given products to `joints`, and their derivative with respect to the joint values to
  /// `derivative`, N x N by columns. Does not allocate.
  VERNIER_API void add(const double* q, const double* products, double* joints, double* derivative) const noexcept;

 private:
  detail::ChainTable chain_;
  Vector3 down_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/gravity_compliance.ipp"
#endif
