// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Elastic tilts of the joints' frames under a payload: links and bearings that bend across the joints' axes.

#include "vernier/error_terms/payload_compliance.hpp"

namespace vernier {

/// The frame of each joint tilts about its own x and y axes in proportion to the torques of a payload about them: two
/// compliances a joint [rad/(N m)], beside the one about its axis (`PayloadCompliance`). Frames are those of the
/// nominal chain behind the joint, z along its axis. As for `GravityTilt`, the tilts of all joints add up to one motion
/// of the arm's end: `w_j = sum_a c_ja (a . torque_j) a`, a one of the axes x and y, and `t = sum_j o_j x w_j`.
class PayloadBend {
 public:
  /// @param chain     nominal chain, whose geometry is accurate enough for torques
  /// @param down      direction of gravity in the base frame of the chain; a unit vector
  /// @param reference payload without effect; its centre is finite
  /// @throws std::invalid_argument on a direction whose length is not 1, or a reference that is not finite
  VERNIER_API PayloadBend(const detail::ChainTable& chain, const Vector3& down, const Payload& reference)
      : springs_(chain, down, reference) {}

  /// Direction of gravity in the base frame of the chain.
  const Vector3& down() const { return springs_.down(); }
  /// The payload without effect.
  const Payload& reference() const { return springs_.reference(); }
  /// What a payload is beyond the reference; nothing for one that is not finite.
  VERNIER_API PayloadLoad load(const Payload& payload) const noexcept { return springs_.load(payload); }
  /// Number of joints.
  int joints() const { return springs_.joints(); }
  /// Number of compliances: of each joint those about x and y.
  Index size() const { return 2 * joints(); }

  /// Translation [m] and rotation vector [rad] of the arm's end by one unit of each compliance.
  /// @param q    joints() values
  /// @param load weight and moment beyond the reference
  /// @param out  6 x size()
  VERNIER_API void basis(const double* q, const PayloadLoad& load, MatrixRef out) const noexcept;
  /// The motion of the arm's end by given compliances, and its derivative, as `GravityTilt::motion`. Does not allocate.
  VERNIER_API Vector6 motion(const double* q, const PayloadLoad& load, const double* compliances,
                             double* rates = nullptr) const noexcept;

 private:
  PayloadCompliance springs_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/payload_bend.ipp"
#endif
