#pragma once

/// @file
/// A serial arm as a compile-time chain of Denavit-Hartenberg rows.

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/chain_walk.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/dh.hpp"

namespace vernier {

/// A chain of N joints in a Denavit-Hartenberg convention. Base frame: that of row 1; tool frame: that of row N.
///
/// `constexpr DhChain<2> arm{{{ {.a = 300_mm}, {.a = 200_mm} }}};` A missing or surplus row does not compile.
/// Its 5 N parameters are counted row by row: a1, alpha1, d1, theta1, beta1, a2, ...
template <int N, class Convention = StandardDh>
class DhChain {
  static_assert(N >= 1);

 public:
  /// Number of joints.
  static constexpr int dof = N;
  /// Number of parameters.
  static constexpr int num_parameters = 5 * N;
  /// All parameters [m, rad].
  using Parameters = Eigen::Matrix<double, num_parameters, 1>;

  /// A chain of exactly N rows.
  constexpr DhChain(const DhTable<N>& table) : rows_(table.rows) {}  // NOLINT(google-explicit-constructor)
  /// A chain of exactly N rows.
  template <int M>
    requires(M == N)
  constexpr DhChain(const DhRow (&table)[M]) : DhChain(DhTable<N>(table)) {}  // NOLINT(google-explicit-constructor)

  /// A chain whose rows are only known at run time.
  static constexpr DhChain from_rows(const std::array<DhRow, N>& rows) {
    DhChain chain;
    chain.rows_ = Rows(rows);
    return chain;
  }

  /// Row i, counted from 0.
  constexpr const DhRow& row(int i) const { return rows_.rows[static_cast<std::size_t>(i)]; }
  /// All rows.
  constexpr const std::array<DhRow, N>& rows() const { return rows_.rows; }
  /// Equal in every row.
  bool operator==(const DhChain& other) const { return rows() == other.rows(); }

  /// base_T_tool.
  Isometry3 pose(const JointVector<N>& q) const noexcept {
    Isometry3 out;
    detail::run_same_bits([&]<int W>() VERNIER_INLINED {
      detail::PoseFrame<W> frame;
      frame.set_identity();
      rows_.template walk<W>(q.data(), frame, ignore_motion);
      detail::store_pose<W>(out.data(), frame);
    });
    return out;
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<N>& q) const noexcept {
    double out[4];
    detail::run_same_bits([&]<int W>() VERNIER_INLINED {
      detail::PoseFrame<W> frame;
      frame.set_identity();
      rows_.template walk<W>(q.data(), frame, ignore_motion);
      detail::store_vector<W>(out, frame.p);
    });
    return Vector3(out);
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }

  /// Both in one pass.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept { return with_jacobian(q, {}); }
  /// The same of the chain standing in a base frame, at a point [m] fixed in the tool frame: the pose's origin.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q, const Isometry3& base,
                                       const Vector3& point) const noexcept {
    return with_jacobian(q, {base.data(), point.data()});
  }

 private:
  PoseAndJacobian<N> with_jacobian(const JointVector<N>& q, const detail::Placement& placement) const noexcept {
    PoseAndJacobian<N> out;
    detail::run_same_bits([&]<int W>() VERNIER_INLINED {
      detail::ElementaryMotion joints[N];
      detail::PoseFrame<W> frame;
      placement.begin<W>(frame);
      rows_.template walk<W>(q.data(), frame,
                             [&](int i, DhParameter parameter, const auto& axis, const auto& point) VERNIER_INLINED {
                               if (parameter != DhParameter::theta) return;  // a sliding joint's axis is the same
                               detail::store_vector<W>(joints[i].axis, axis);
                               detail::store_vector<W>(joints[i].point, point);
                             });
      placement.end(frame);
      detail::store_pose<W>(out.pose.data(), frame);
      for (int i = 0; i < N; ++i)
        joints[i].column(row(i).joint == JointType::revolute, out.pose.data() + 12, out.jacobian.data() + 6 * i);
    });
    return out;
  }

 public:
  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n joint combinations; several at a time.
  /// For the tool's origin the same bits as `position` of each (to 1e-14 where the compiler's flags allow FMA).
  PointRows positions(const JointRows<N>& joints, const Vector3& point = Vector3::Zero()) const {
    const Index n = joints.rows();
    PointRows out(n, 3);
    if (n < block) {
      for (Index i = 0; i < n; ++i) out.row(i) = (pose(joints.row(i).transpose()) * point).transpose();
      return out;
    }
    rows_.visit_poses(joints, {nullptr, point.isZero(0) ? nullptr : point.data()},
                      [&](Index first, const auto& frame)
                          VERNIER_INLINED { frame.store_positions(out.data() + first, n); });
    return out;
  }

  /// base_T_tool at n joint combinations, several at a time; the same bits as `pose` of each (as above).
  std::vector<Isometry3> poses(const JointRows<N>& joints) const {
    std::vector<Isometry3> out(static_cast<std::size_t>(joints.rows()));
    if (joints.rows() < block) {
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = pose(joints.row(static_cast<Index>(i)).transpose());
      return out;
    }
    rows_.visit_poses(joints, {}, [&](Index first, const auto& frame) VERNIER_INLINED {
      frame.store_poses(&out[static_cast<std::size_t>(first)]);
    });
    return out;
  }

  /// Poses and Jacobians at n joint combinations, several at a time; the same bits as `pose_and_jacobian` of each (as
  /// above).
  /// @param joints n x N
  /// @param out    storage to be used again
  PosesAndJacobians<N> poses_and_jacobians(const JointRows<N>& joints, PosesAndJacobians<N> out = {}) const {
    if (joints.rows() < block)
      return detail::one_by_one(joints, std::move(out), [&](const auto& q) { return pose_and_jacobian(q); });
    visit_motions(joints, {}, out, [&](const auto& columns, const auto& motions, const auto&) VERNIER_INLINED {
      for (int i = 0; i < N; ++i) columns.write_joint(i, row(i).joint, motions);
    });
    return out;
  }

  /// Poses and parameter Jacobians at n joint combinations, as above.
  PosesAndJacobians<num_parameters> poses_and_parameter_jacobians(const JointRows<N>& joints,
                                                                  PosesAndJacobians<num_parameters> out = {}) const {
    if (joints.rows() < block)
      return detail::one_by_one(joints, std::move(out), [&](const auto& q) { return with_parameter_jacobian(q, {}); });
    visit_motions(joints, {}, out, [](const auto& columns, const auto& motions, const auto&) VERNIER_INLINED {
      columns.write_parameters(0, motions);
    });
    return out;
  }

  /// As many configurations as a vector holds of any instruction set: fewer are taken one by one.
  static constexpr Index block = 4;

  /// For models that stand on this chain: fills `out` at n >= `block` joint combinations, several at a time.
  /// `write(columns, motions, frames)`, an always inlined lambda, has them write their columns of derivatives, by the
  /// elementary motions as parameters are counted; it may move on the frames, which become the poses.
  template <int P, class Write>
  void visit_motions(const JointRows<N>& joints, const detail::Placement& placement, PosesAndJacobians<P>& out,
                     const Write& write) const {
    out.resize(joints.rows());
    rows_.visit_blocks(joints, placement, [&](Index first, auto& frames, const auto& motions) VERNIER_INLINED {
      write(detail::BlockColumns(out.jacobians, first, frames), motions, frames);
      frames.store_poses(&out.poses[static_cast<std::size_t>(first)]);
    });
  }

  /// Where the links are at a configuration, base frame.
  struct Links {
    std::array<Vector3, N> axis;    ///< direction of each joint
    std::array<Vector3, N> point;   ///< a point on each joint's axis
    std::array<Vector3, N> origin;  ///< origin of the frame behind each row
  };

  /// Joint axes and origins of the link frames.
  Links links(const JointVector<N>& q) const noexcept {
    const detail::ElementaryMotions<N> motions = rows_.motions(q.data(), {});
    Links out;
    for (int i = 0; i < N; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const bool revolute = row(i).joint == JointType::revolute;
      const auto& joint = motions.of(i, revolute ? DhParameter::theta : DhParameter::d);
      out.axis[at] = Vector3(joint.axis);
      out.point[at] = Vector3(joint.point);
      if (i > 0) out.origin[at - 1] = Vector3(motions.of(i, Convention::order.front()).point);
    }
    out.origin[N - 1] = motions.tool.translation();
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

  /// The same arm with other values.
  DhChain with_parameters(const Parameters& p) const {
    std::array<DhRow, N> rows;
    for (int i = 0; i < N; ++i)
      rows[static_cast<std::size_t>(i)] = {p(5 * i),     p(5 * i + 1), p(5 * i + 2),
                                           p(5 * i + 3), p(5 * i + 4), row(i).joint};
    return from_rows(rows);
  }

  /// Their names, in the order of `parameters`.
  static std::vector<std::string> parameter_names() {
    std::vector<std::string> names;
    for (int i = 1; i <= N; ++i)
      for (const char* name : {"a", "alpha", "d", "theta", "beta"}) names.push_back(message(name, i));
    return names;
  }

  /// What each of them measures.
  static std::vector<ParameterKind> parameter_kinds() {
    std::vector<ParameterKind> kinds;
    for (int i = 0; i < N; ++i)
      for (int k = 0; k < 5; ++k) kinds.push_back(k == 0 || k == 2 ? ParameterKind::length : ParameterKind::angle);
    return kinds;
  }

 private:
  using Rows = detail::ChainRows<N, Convention>;

  constexpr DhChain() = default;

  static constexpr auto ignore_motion = [](int, DhParameter, const auto&, const auto&) VERNIER_INLINED {};

  PoseAndParameterJacobian<num_parameters> with_parameter_jacobian(const JointVector<N>& q,
                                                                   const detail::Placement& placement) const noexcept {
    const detail::ElementaryMotions<N> motions = rows_.motions(q.data(), placement);
    PoseAndParameterJacobian<num_parameters> out;
    out.pose = motions.tool;
    for (int i = 0; i < N; ++i) {
      VERNIER_UNROLL
      for (int k = 0; k < 5; ++k) {
        const auto parameter = static_cast<DhParameter>(k);
        const bool rotation = parameter != DhParameter::a && parameter != DhParameter::d;
        motions.of(i, parameter).column(rotation, motions.tool.data() + 12, out.jacobian.data() + 6 * (5 * i + k));
      }
    }
    return out;
  }

  Rows rows_;
};

}  // namespace vernier
