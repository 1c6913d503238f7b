// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A serial arm as a compile-time chain of Denavit-Hartenberg rows.

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"
#include "vernier/kinematics/dh.hpp"

namespace vernier {

namespace detail {

VERNIER_API std::vector<std::string> chain_parameter_names(int joints);
VERNIER_API std::vector<ParameterKind> chain_parameter_kinds(int joints);

}  // namespace detail

/// A chain of N joints in a Denavit-Hartenberg convention. Base frame: that of row 1; tool frame: that of row N.
///
/// `constexpr DhChain<2> arm{{{ {.a = 300_mm}, {.a = 200_mm} }}};` A missing or surplus row does not compile.
/// Its 5 N parameters are counted row by row: a1, alpha1, d1, theta1, beta1, a2, ...
template <int N, class Convention = StandardDh>
class DhChain : public ChecksJoints<DhChain<N, Convention>> {
  static_assert(N >= 1 && N <= max_joints);
  using Checks = ChecksJoints<DhChain>;

 public:
  using Checks::jacobian;
  using Checks::parameter_jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::poses;
  using Checks::poses_and_jacobians;
  using Checks::poses_and_parameter_jacobians;
  using Checks::position;
  using Checks::positions;

  /// Number of joints.
  static constexpr int dof = N;
  /// Number of parameters.
  static constexpr int num_parameters = 5 * N;
  /// All parameters [m, rad].
  using Parameters = Eigen::Matrix<double, num_parameters, 1>;

  /// A chain of exactly N rows, whose lengths are below 100 m (see `DhTable`).
  constexpr DhChain(const DhTable<N>& table) : rows_(table.rows) {}  // NOLINT(google-explicit-constructor)
  /// A chain of exactly N rows.
  template <int M>
    requires(M == N)
  constexpr DhChain(const DhRow (&table)[M]) : DhChain(DhTable<N>(table)) {}  // NOLINT(google-explicit-constructor)

  /// A chain whose rows are only known at run time. Their values may be of any size: in a row converted from nearly
  /// parallel axes, d may exceed the arm by far.
  static constexpr DhChain from_rows(const std::array<DhRow, N>& rows) {
    DhChain chain;
    chain.rows_ = Rows(rows);
    return chain;
  }

  /// Row i, counted from 0.
  constexpr const DhRow& row(int i) const { return rows_.rows[static_cast<std::size_t>(i)]; }
  /// All rows.
  constexpr const std::array<DhRow, N>& rows() const { return rows_.rows; }
  /// Types of all joints.
  constexpr std::array<JointType, N> joint_types() const {
    std::array<JointType, N> types{};
    for (int i = 0; i < N; ++i) types[static_cast<std::size_t>(i)] = row(i).joint;
    return types;
  }
  /// Equal in every row.
  bool operator==(const DhChain& other) const { return rows() == other.rows(); }
  /// The chain for code that works on any number of joints; valid as long as this chain.
  detail::ChainView view() const { return rows_.view(); }

  /// base_T_tool.
  Isometry3 pose(const JointVector<N>& q) const noexcept {
    Isometry3 out;
    detail::chain_pose<Convention, N>(view(), q.data(), out.data());
    return out;
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<N>& q) const noexcept { return pose(q).translation(); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }

  /// Both in one pass.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept { return with_jacobian(q, {}); }
  /// Pose and Jacobian of the chain in a base frame, at a point [m] fixed in the tool frame: the pose's origin.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q, const Isometry3& base,
                                       const Vector3& point) const noexcept {
    return with_jacobian(q, {base.data(), point.data()});
  }

  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n configurations. For the tool's origin the
  /// same bits as `position` of each (to 1e-14 where the compiler's flags allow FMA).
  PointRows positions(const JointRows<N>& joints, const Vector3& point = Vector3::Zero()) const {
    PointRows out(joints.rows(), 3);
    evaluate(joints, {.point = point.isZero(0) ? nullptr : point.data()}, {.positions = out.data()});
    return out;
  }
  /// base_T_tool at n configurations; the same bits as `pose` of each (as above).
  std::vector<Isometry3> poses(const JointRows<N>& joints) const {
    std::vector<Isometry3> out(static_cast<std::size_t>(joints.rows()));
    evaluate(joints, {}, {.poses = out.data()});
    return out;
  }
  /// Poses and Jacobians at n configurations; the same bits as `pose_and_jacobian` of each (as above).
  /// @param joints n x N
  /// @param out    storage to be reused
  PosesAndJacobians poses_and_jacobians(const JointRows<N>& joints, PosesAndJacobians out = {}) const {
    out.resize(joints.rows(), N);
    evaluate(joints, {}, {.poses = out.poses.data(), .joints = out.jacobians.data()});
    return out;
  }
  /// Poses and parameter Jacobians at n configurations, as above.
  PosesAndJacobians poses_and_parameter_jacobians(const JointRows<N>& joints, PosesAndJacobians out = {}) const {
    out.resize(joints.rows(), num_parameters);
    evaluate(joints, {}, {.poses = out.poses.data(), .parameters = out.jacobians.data()});
    return out;
  }

  /// Where the links are at a configuration, base frame; a column a joint.
  struct Links {
    Eigen::Matrix<double, 3, N> axis;    ///< direction of each joint
    Eigen::Matrix<double, 3, N> point;   ///< a point on each joint's axis [m]
    Eigen::Matrix<double, 3, N> origin;  ///< origin of each link's frame [m]
  };

  /// Joint axes and origins of the link frames.
  Links links(const JointVector<N>& q) const noexcept {
    Links out;
    detail::chain_links(view(), q.data(), out.axis.data(), out.point.data(), out.origin.data());
    return out;
  }

  /// 6 x 5N, analytic.
  ParameterJacobian<num_parameters> parameter_jacobian(const JointVector<N>& q) const noexcept {
    return with_parameter_jacobian(q, {}).jacobian;
  }
  /// Pose and parameter Jacobian of the chain standing in a base frame, at a point [m] fixed in the tool frame.
  PoseAndParameterJacobian<num_parameters> pose_and_parameter_jacobian(const JointVector<N>& q, const Isometry3& base,
                                                                       const Vector3& point) const noexcept {
    return with_parameter_jacobian(q, {base.data(), point.data()});
  }

  /// The pose as a function of joints and parameters, in any scalar.
  template <class S>
  IsometryOf<S> pose(const Eigen::Matrix<S, N, 1>& q, const Eigen::Matrix<S, num_parameters, 1>& p) const {
    using std::cos;
    using std::sin;
    detail::MovingFrame<S, 3> frame;
    frame.set_identity();
    for (int i = 0; i < N; ++i) {
      const bool revolute = row(i).joint == JointType::revolute;
      for (const DhParameter parameter : Convention::order) {
        S value = p(5 * i + static_cast<int>(parameter));
        switch (parameter) {
          case DhParameter::a: frame.move(frame.x, value); break;
          case DhParameter::alpha: frame.rotate_x(cos(value), sin(value)); break;
          case DhParameter::beta: frame.rotate_y(cos(value), sin(value)); break;
          case DhParameter::d:
            if (!revolute) value += q(i);
            frame.move(frame.z, value);
            break;
          case DhParameter::theta:
            if (revolute) value += q(i);
            frame.rotate_z(cos(value), sin(value));
            break;
        }
      }
    }
    return frame.isometry();
  }

  /// Their values [m, rad].
  Parameters parameters() const {
    Parameters p;
    for (int i = 0; i < N; ++i)
      p.template segment<5>(5 * i) << row(i).a, row(i).alpha, row(i).d, row(i).theta, row(i).beta;
    return p;
  }

  /// A chain of this structure with other parameter values.
  DhChain with_parameters(const Parameters& p) const {
    std::array<DhRow, N> rows;
    for (int i = 0; i < N; ++i)
      rows[static_cast<std::size_t>(i)] = {p(5 * i),     p(5 * i + 1), p(5 * i + 2),
                                           p(5 * i + 3), p(5 * i + 4), row(i).joint};
    return from_rows(rows);
  }

  /// Their names, in the order of `parameters`.
  static std::vector<std::string> parameter_names() { return detail::chain_parameter_names(N); }
  /// What each of them measures.
  static std::vector<ParameterKind> parameter_kinds() { return detail::chain_parameter_kinds(N); }

 private:
  using Rows = detail::ChainRows<N, Convention>;

  constexpr DhChain() = default;

  void evaluate(const JointRows<N>& joints, const detail::ChainFrames& frames,
                const detail::BlockResults& results) const {
    detail::evaluate_chain(view(), frames, joints.data(), joints.rows(), joints.rows(), results);
  }

  PoseAndJacobian<N> with_jacobian(const JointVector<N>& q, const detail::Placement& placement) const noexcept {
    PoseAndJacobian<N> out;
    detail::chain_pose_and_jacobian<Convention, N>(view(), placement, q.data(), out.pose.data(), out.jacobian.data());
    return out;
  }

  PoseAndParameterJacobian<num_parameters> with_parameter_jacobian(const JointVector<N>& q,
                                                                   const detail::Placement& placement) const noexcept {
    PoseAndParameterJacobian<num_parameters> out;
    detail::chain_parameter_jacobian(view(), placement, q.data(), out.pose.data(), out.jacobian.data());
    return out;
  }

  Rows rows_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/dh_chain.ipp"
#endif
