// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Tilts of joint frames under gravity: bearings, links and cables that give way about more than the joint's own axis.

#include "vernier/kinematics/detail/chain_table.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// The frame of each joint tilts about its own x and y axes, each tilt linear in the direction of gravity in that
/// frame: `C_j g_j(q)`, C_j 2 x 3, six coefficients a joint [rad]. Frames are those of the nominal chain behind the
/// joint, z along its axis, at commanded joint values. To first order the tilts of all joints add up to one rigid
/// motion of the arm's end, a rotation vector w and a translation t in the base frame of the chain:
/// `pose' = (Exp(w), t) pose`, `w = sum_j w_j`, `t = sum_j o_j x w_j`, o_j the frames' origins.
class GravityTilt {
 public:
  /// @param chain nominal chain, whose geometry is accurate enough for frames
  /// @param down  direction of gravity in the base frame of the chain; a unit vector
  /// @throws std::invalid_argument on a direction whose length is not 1
  template <int N, class Convention>
  explicit GravityTilt(const DhChain<N, Convention>& chain, const Vector3& down = Vector3(0, 0, -1))
      : GravityTilt(detail::ChainTable(chain.view()), down) {}
  /// Tilt columns of an arm whose number of joints is known at run time.
  VERNIER_API GravityTilt(const detail::ChainTable& chain, const Vector3& down);

  /// Direction of gravity in the base frame of the chain.
  const Vector3& down() const { return down_; }
  /// Number of joints.
  int joints() const { return chain_.joints(); }
  /// Number of coefficients: of each joint the tilts about x by the three components of gravity, then those about y.
  Index size() const { return 6 * joints(); }

  /// Translation [m] and rotation vector [rad] of the arm's end by one unit of each coefficient.
  /// @param q   joints() values
  /// @param out 6 x size()
  VERNIER_API void basis(const double* q, MatrixRef out) const noexcept;
  /// The motion of the arm's end by given coefficients. Does not allocate.
  /// @param q            joints() values
  /// @param coefficients size() values [rad]
  /// @param rates        derivative of the motion with respect to the joint values, 6 x joints() by columns; null where
  ///                     not wanted
  /// @return             translation [m] and rotation vector [rad], base frame of the chain
  VERNIER_API Vector6 motion(const double* q, const double* coefficients, double* rates = nullptr) const noexcept;

 private:
  detail::ChainTable chain_;
  Vector3 down_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/gravity_tilt.ipp"
#endif
