// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Joint values in matrices whose size is known at run time only. Eigen converts them to `JointVector<N>` and
/// `JointRows<N>` and asserts that they fit; with NDEBUG it reads beyond the end of those that do not. Here they are
/// checked in every build.

#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A vector of which the compiler does not know how many values it has.
template <class Q>
concept SizedAtRunTime = requires {
  requires Q::SizeAtCompileTime == Eigen::Dynamic;
};

/// A matrix of which the compiler does not know how many columns it has.
template <class Rows>
concept ColumnsAtRunTime = requires {
  requires Rows::ColsAtCompileTime == Eigen::Dynamic;
};

namespace detail {

VERNIER_API [[noreturn]] void refuse_joint_values(Index values, int joints);

/// One configuration of an arm of N joints.
/// @throws std::invalid_argument on another number of values
template <int N, SizedAtRunTime Q>
JointVector<N> joint_vector(const Q& q) {
  if (q.rows() != N || q.cols() != 1) [[unlikely]]
    refuse_joint_values(q.size(), N);
  return JointVector<N>(q);
}
/// One configuration, in a vector of either kind.
/// @throws std::invalid_argument on another number of values
template <int N, class Q>
JointVector<N> fixed_vector(const Q& q) {
  if constexpr (SizedAtRunTime<Q>) {
    return joint_vector<N>(q);
  } else {
    return q;
  }
}

/// Configurations of an arm of N joints, one a row.
/// @throws std::invalid_argument on another number of columns
template <int N, ColumnsAtRunTime Rows>
JointRows<N> joint_rows(const Rows& rows) {
  if (rows.cols() != N) [[unlikely]]
    refuse_joint_values(rows.cols(), N);
  return JointRows<N>(rows);
}
/// Configurations, in a matrix of either kind.
/// @throws std::invalid_argument on another number of columns
template <int N, class Rows>
JointRows<N> fixed_rows(const Rows& rows) {
  if constexpr (ColumnsAtRunTime<Rows>) {
    return joint_rows<N>(rows);
  } else {
    return rows;
  }
}

}  // namespace detail

/// Overloads of a kinematic model, a compensator or a solver of branches `Self` for such matrices. A class derives from
/// this and names those that it has in using-declarations.
template <class Self>
class ChecksJoints {
 public:
  /// base_T_tool.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto pose(const Q& q) const {
    return self().pose(detail::joint_vector<Self::dof>(q));
  }
  /// Tool position [m], base frame.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto position(const Q& q) const {
    return self().position(detail::joint_vector<Self::dof>(q));
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto jacobian(const Q& q) const {
    return self().jacobian(detail::joint_vector<Self::dof>(q));
  }
  /// Pose and geometric Jacobian in one pass.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto pose_and_jacobian(const Q& q) const {
    return self().pose_and_jacobian(detail::joint_vector<Self::dof>(q));
  }
  /// Derivative of the pose with respect to the parameters, 6 x P.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto parameter_jacobian(const Q& q) const {
    return self().parameter_jacobian(detail::joint_vector<Self::dof>(q));
  }
  /// Positions [m], base frame, at n configurations.
  /// @throws std::invalid_argument on another number of columns
  template <ColumnsAtRunTime Rows, class... More>
  auto positions(const Rows& joints, const More&... more) const {
    return self().positions(detail::joint_rows<Self::dof>(joints), more...);
  }
  /// base_T_tool at n configurations.
  /// @throws std::invalid_argument on another number of columns
  template <ColumnsAtRunTime Rows>
  auto poses(const Rows& joints) const {
    return self().poses(detail::joint_rows<Self::dof>(joints));
  }
  /// Poses and Jacobians at n configurations.
  /// @throws std::invalid_argument on another number of columns
  template <ColumnsAtRunTime Rows, class... Storage>
  auto poses_and_jacobians(const Rows& joints, Storage&&... out) const {
    return self().poses_and_jacobians(detail::joint_rows<Self::dof>(joints), std::forward<Storage>(out)...);
  }
  /// Poses and parameter Jacobians at n configurations.
  /// @throws std::invalid_argument on another number of columns
  template <ColumnsAtRunTime Rows, class... Storage>
  auto poses_and_parameter_jacobians(const Rows& joints, Storage&&... out) const {
    return self().poses_and_parameter_jacobians(detail::joint_rows<Self::dof>(joints), std::forward<Storage>(out)...);
  }
  /// The pose the arm takes when commanded q.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto predict(const Q& q) const {
    return self().predict(detail::joint_vector<Self::dof>(q));
  }
  /// The command that brings the arm to the pose of the nominal one at q.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  [[nodiscard]] auto correct(const Q& q) const {
    return self().correct(detail::joint_vector<Self::dof>(q));
  }
  /// The command that brings the arm to a pose.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  [[nodiscard]] auto correct(const Isometry3& target, const Q& seed) const {
    return self().correct(target, detail::joint_vector<Self::dof>(seed));
  }
  /// The command for the approach from known joint values, where a number of them is known at run time.
  /// @throws std::invalid_argument on another number of joint values
  template <class Q, class P>
    requires(SizedAtRunTime<Q> || SizedAtRunTime<P>)
  [[nodiscard]] auto correct(const Q& q, const P& previous) const {
    return self().correct(detail::fixed_vector<Self::dof>(q), detail::fixed_vector<Self::dof>(previous));
  }
  /// The command that brings the arm to a pose from known joint values, where a number of them is known at run time.
  /// @throws std::invalid_argument on another number of joint values
  template <class Q, class P>
    requires(SizedAtRunTime<Q> || SizedAtRunTime<P>)
  [[nodiscard]] auto correct(const Isometry3& target, const Q& seed, const P& previous) const {
    return self().correct(target, detail::fixed_vector<Self::dof>(seed), detail::fixed_vector<Self::dof>(previous));
  }
  /// Share of what is known only where the joints were measured.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  double gate(const Q& q) const {
    return self().gate(detail::joint_vector<Self::dof>(q));
  }
  /// The arm as it moves to the next configuration from known joint values: a view.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto approached_from(const Q& previous) const {
    return self().approached_from(detail::joint_vector<Self::dof>(previous));
  }

  /// All joint values with which a nominal arm is at a pose; `more` follows `close_to` there.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q, class... More>
  auto roots(const Isometry3& target, const Q& close_to, More... more) const {
    return self().roots(target, detail::joint_vector<Self::dof>(close_to), more...);
  }
  /// How far joint values are from singularities.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  auto distances(const Q& q) const {
    return self().distances(detail::joint_vector<Self::dof>(q));
  }

 protected:
  ChecksJoints() = default;

 private:
  const Self& self() const noexcept { return static_cast<const Self&>(*this); }
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/checked_joints.ipp"
#endif
