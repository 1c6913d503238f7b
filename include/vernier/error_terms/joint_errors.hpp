// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Errors of the joints of a real arm: one sum, linear in its coefficients.

#include <utility>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_terms/detail/harmonic_table.hpp"
#include "vernier/error_terms/joint_terms.hpp"

namespace vernier {

namespace detail {

/// Chain rule: the product of a Jacobian, 6 x n, and the derivative of its joint values, n x n, by columns.
VERNIER_API void compose_jacobian(const double* jacobian, const double* derivative, int n, double* out) noexcept;

}  // namespace detail

/// Joint errors with their coefficients: the map from commanded to effective joint values, and the tilts of the joints'
/// frames.
class JointErrors {
 public:
  /// None.
  JointErrors() = default;
  /// @throws std::invalid_argument when the number of coefficients is not that of the terms, a coefficient is not
  ///         finite, or the terms are not consistent
  VERNIER_API JointErrors(JointTerms terms, VectorX coefficients);

  /// Which errors there are.
  const JointTerms& terms() const { return terms_; }
  /// The coefficients: rad, or m at prismatic joints; gravity's rad/m.
  const VectorX& coefficients() const { return coefficients_; }
  /// These errors under a payload, in place of the reference payload.
  VERNIER_API JointErrors carrying(const Payload& payload) const;
  /// What the arm carries beyond the reference payload.
  const PayloadLoad& load() const { return load_; }
  /// These errors under a load beyond the reference payload.
  JointErrors under(const PayloadLoad& load) const {
    JointErrors out = *this;
    out.load_ = load;
    return out;
  }
  /// Whether there is none.
  bool empty() const { return coefficients_.size() == 0; }

  /// Effective joint values `q + dq(q)`, and their derivative `I + d dq/dq` with respect to the commanded ones. Does
  /// not allocate.
  /// @param q          commanded joint values
  /// @param n          number of joints
  /// @param effective  n values
  /// @param derivative n x n, by columns
  /// @param previous   joint values from which q was approached; null, or not finite, where unknown
  /// @param load       what the arm carries; null: `load()`
  VERNIER_API void evaluate(const double* q, int n, double* effective, double* derivative,
                            const double* previous = nullptr, const PayloadLoad* load = nullptr) const noexcept;

  /// Effective joint values of N joints, and their derivative.
  template <int N>
  struct Effective {
    JointVector<N> joints;                   ///< q + dq(q)
    Eigen::Matrix<double, N, N> derivative;  ///< I + d dq/dq
  };
  /// Evaluates joint errors at q. Does not allocate.
  template <int N>
  Effective<N> effective(const JointVector<N>& q, const double* previous = nullptr) const noexcept {
    Effective<N> out;
    evaluate(q.data(), N, out.joints.data(), out.derivative.data(), previous);
    return out;
  }
  /// Effective values of n configurations, n x joints.
  /// @param joints   commanded values, n x joints [rad, m]
  /// @param previous joint values from which they were approached, likewise; no rows where unknown
  /// @param loads    what the arm carries at each; none: `load()`
  VERNIER_API MatrixX effective_rows(const ConstMatrixRef& joints, const ConstMatrixRef& previous = MatrixX(),
                                     std::span<const PayloadLoad> loads = {}) const;
  /// Half the width of the hysteresis loop of joint i (from 0), or motor i [rad, m]: that of motions much longer than
  /// its widths.
  VERNIER_API double half_loop(int i) const noexcept;

  /// Whether the arm's end moves beyond its joints: frames of joints tilt or bend, or a guide is not straight.
  bool tilts() const { return terms_.tilt || terms_.bend || terms_.straightness; }
  /// Moves a pose of the arm's end by these motions, and extends its derivative by theirs. Does not
  /// allocate.
  /// @param q        commanded joint values
  /// @param pose     in the base frame of the chain
  /// @param jacobian of that pose with respect to commanded joint values, 6 x joints by columns; null for none
  VERNIER_API void tilt(const double* q, Isometry3& pose, double* jacobian = nullptr) const noexcept;

  /// What the transmission of joint i (from 0), or motor i, adds at an angle [rad].
  VERNIER_API double transmission(int i, double q) const noexcept;

 private:
  JointTerms terms_{};
  VectorX coefficients_{};
  detail::HarmonicTable harmonics_{};
  PayloadLoad load_{};
};

/// A chain with joint errors: `pose(q) = chain.pose(q + dq(q))`, moved by tilts of the joints' frames where there are
/// any; the approach unknown.
template <class C>
class WithJointErrors : public ChecksJoints<WithJointErrors<C>> {
  using Checks = ChecksJoints<WithJointErrors>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::poses;
  using Checks::position;
  using Checks::positions;

  /// Number of joints.
  static constexpr int dof = C::dof;
  /// The chain inside.
  using Chain = C;

  /// A chain alone, or with joint errors.
  /// @throws std::invalid_argument for joint errors of another number of joints
  WithJointErrors(const Chain& chain, JointErrors errors = {})  // NOLINT(google-explicit-constructor)
      : chain_(chain), errors_(std::move(errors)) {
    demand(errors_.empty() || errors_.terms().joints == dof, "WithJointErrors: errors of ", errors_.terms().joints,
           " joints for a chain of ", dof);
  }

  /// The chain.
  const Chain& chain() const { return chain_; }
  /// The joint errors.
  const JointErrors& joint_errors() const { return errors_; }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return pose_from(nullptr, q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return pose(q).translation(); }
  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n configurations.
  PointRows positions(const JointRows<dof>& joints, const Vector3& point = Vector3::Zero()) const {
    if (!errors_.tilts()) return chain_.positions(errors_.effective_rows(joints), point);
    const std::vector<Isometry3> ends = poses(joints);
    PointRows out(joints.rows(), 3);
    for (Index i = 0; i < out.rows(); ++i) set_point(out, i, ends[static_cast<std::size_t>(i)] * point);
    return out;
  }
  /// base_T_tool at n configurations.
  std::vector<Isometry3> poses(const JointRows<dof>& joints) const {
    std::vector<Isometry3> out = chain_.poses(errors_.effective_rows(joints));
    for (std::size_t i = 0; errors_.tilts() && i < out.size(); ++i) {
      const JointVector<dof> q = configuration(joints, static_cast<Index>(i));
      errors_.tilt(q.data(), out[i]);
    }
    return out;
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return pose_and_jacobian_from(nullptr, q);
  }

  /// base_T_tool, approached from given joint values.
  /// @param previous dof values; null, or not finite, where unknown
  /// @param q        joint values [rad, m]
  Isometry3 pose_from(const double* previous, const JointVector<dof>& q) const noexcept {
    Isometry3 out = chain_.pose(errors_.effective<dof>(q, previous).joints);
    if (errors_.tilts()) errors_.tilt(q.data(), out);
    return out;
  }
  /// Pose and geometric Jacobian, approached from given joint values (see `pose_from`).
  PoseAndJacobian<dof> pose_and_jacobian_from(const double* previous, const JointVector<dof>& q) const noexcept {
    const auto effective = errors_.effective<dof>(q, previous);
    const PoseAndJacobian<dof> inner = chain_.pose_and_jacobian(effective.joints);
    PoseAndJacobian<dof> out;
    out.pose = inner.pose;
    detail::compose_jacobian(inner.jacobian.data(), effective.derivative.data(), dof, out.jacobian.data());
    if (errors_.tilts()) errors_.tilt(q.data(), out.pose, out.jacobian.data());
    return out;
  }

 private:
  Chain chain_;
  JointErrors errors_;
};

/// An arm with joint errors that came from known joint values: a view of a `WithJointErrors`, which must outlive it.
template <class C>
class ApproachedArm : public ChecksJoints<ApproachedArm<C>> {
  using Checks = ChecksJoints<ApproachedArm>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints.
  static constexpr int dof = C::dof;
  /// The chain inside.
  using Chain = C;

  /// @param arm      seen through this; must outlive it
  /// @param previous joint values from which it moves to the next configuration [rad, m]
  ApproachedArm(const WithJointErrors<Chain>& arm, const JointVector<dof>& previous) noexcept
      : arm_(&arm), previous_(previous) {}

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return arm_->pose_from(previous_.data(), q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return pose(q).translation(); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return arm_->pose_and_jacobian_from(previous_.data(), q);
  }

 private:
  const WithJointErrors<Chain>* arm_;
  JointVector<dof> previous_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/joint_errors.ipp"
#endif
