// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Elastic deflection of joints under a payload.

#include <limits>

#include "vernier/core/types.hpp"
#include "vernier/kinematics/detail/chain_table.hpp"

namespace vernier {

namespace detail {
inline constexpr double standard_gravity = 9.80665;  // [m/s^2]
}

/// What an arm carries at its flange.
struct Payload {
  double mass = 0;  ///< [kg]
  /// Centre of mass [m], in the frame of the flange, the last one of the chain; not finite: at the tool point.
  Vector3 centre = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());

  /// A row of `Dataset::payloads`.
  VERNIER_API static Payload of(const ConstMatrixRef& payloads, Index row);
  /// This payload, at another place where the centre is not known.
  VERNIER_API Payload at(const Vector3& tool_point) const;
};

/// Weight of a payload and its first moment, beyond those of another payload. A torque is linear in both.
struct PayloadLoad {
  double weight = 0;                 ///< [N]
  Vector3 moment = Vector3::Zero();  ///< weight times centre, in the frame of the flange [N m]
};

namespace detail {

/// The moment of a load at the end of a chain about the origin of its base frame [N m], before gravity turns it into a
/// torque: weight times lever.
VERNIER_API Vector3 moment_about_base(const ChainTable& chain, const double* q, const PayloadLoad& load) noexcept;

}  // namespace detail

/// Deflection of joints by a payload: a spring of compliance c_i at joint i [rad/(N m), m/N] deflects by
/// `c_i torque_i`. Torques are those beyond a reference payload, whose deflection the products of `GravityCompliance`
/// contain. So measurements under one payload leave the compliances at their priors.
class PayloadCompliance {
 public:
  /// @param chain     nominal chain, whose geometry is accurate enough for torques
  /// @param down      direction of gravity in the base frame of the chain; a unit vector
  /// @param reference payload without effect; its centre is finite
  /// @throws std::invalid_argument on a direction whose length is not 1, or a reference that is not finite
  VERNIER_API PayloadCompliance(const detail::ChainTable& chain, const Vector3& down, const Payload& reference);

  /// Direction of gravity in the base frame of the chain.
  const Vector3& down() const { return down_; }
  /// The payload without effect.
  const Payload& reference() const { return reference_; }
  /// The nominal chain.
  const detail::ChainTable& chain() const { return chain_; }
  /// Number of joints, each with a compliance.
  int joints() const { return chain_.joints(); }
  /// What a payload is beyond the reference; nothing for one that is not finite.
  VERNIER_API PayloadLoad load(const Payload& payload) const noexcept;

  /// Torques about the joints [N m], forces along prismatic ones [N].
  /// @param q    joint values
  /// @param load weight and moment beyond the reference
  /// @param out  one value a joint
  VERNIER_API void torques(const double* q, const PayloadLoad& load, double* out) const noexcept;
  /// Adds the joint errors under a load to `joints`, and their derivative with respect to the joint values to
  /// `derivative`, N x N by columns. Does not allocate.
  VERNIER_API void add(const double* q, const PayloadLoad& load, const double* compliances, double* joints,
                       double* derivative) const noexcept;

 private:
  detail::ChainTable chain_;
  Vector3 down_;
  Payload reference_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/payload_compliance.ipp"
#endif
