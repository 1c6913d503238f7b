#pragma once

/// @file
/// A serial arm as a compile-time chain of Denavit-Hartenberg rows.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/constexpr_trig.hpp"
#include "vernier/kinematics/dh.hpp"

namespace vernier {

namespace detail {

/// A frame carried along the chain: axes and origin, in base coordinates.
template <class S>
struct MovingFrame {
  using Vector = Eigen::Matrix<S, 3, 1>;
  Vector x = Vector::UnitX(), y = Vector::UnitY(), z = Vector::UnitZ(), p = Vector::Zero();

  static void turn(Vector& from, Vector& towards, const S& c, const S& s) {
    const Vector turned = c * from + s * towards;
    towards = c * towards - s * from;
    from = turned;
  }
  void rotate_x(const S& c, const S& s) { turn(y, z, c, s); }
  void rotate_y(const S& c, const S& s) { turn(z, x, c, s); }
  void rotate_z(const S& c, const S& s) { turn(x, y, c, s); }

  IsometryOf<S> isometry() const {
    IsometryOf<S> t = IsometryOf<S>::Identity();  // its last row is set too
    t.matrix().template block<3, 1>(0, 0) = x;
    t.matrix().template block<3, 1>(0, 1) = y;
    t.matrix().template block<3, 1>(0, 2) = z;
    t.matrix().template block<3, 1>(0, 3) = p;
    return t;
  }
};

/// A screw along the chain: what one elementary motion does to everything behind it.
struct ElementaryMotion {
  Vector3 axis, point;
  bool rotation;

  /// Column of a Jacobian at the tool point.
  Vector6 column(const Vector3& tool) const {
    Vector6 c;
    if (rotation) {
      c << axis.cross(tool - point), axis;
    } else {
      c << axis, Vector3::Zero();
    }
    return c;
  }
};

}  // namespace detail

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
  constexpr DhChain(const DhTable<N>& table) : rows_(table.rows) { prepare(); }  // NOLINT(google-explicit-constructor)
  /// A chain of exactly N rows.
  template <int M>
    requires(M == N)
  constexpr DhChain(const DhRow (&table)[M]) : DhChain(DhTable<N>(table)) {}  // NOLINT(google-explicit-constructor)

  /// A chain whose rows are only known at run time.
  static constexpr DhChain from_rows(const std::array<DhRow, N>& rows) {
    DhChain chain;
    chain.rows_ = rows;
    chain.prepare();
    return chain;
  }

  /// Row i, counted from 0.
  constexpr const DhRow& row(int i) const { return rows_[static_cast<std::size_t>(i)]; }
  /// All rows.
  constexpr const std::array<DhRow, N>& rows() const { return rows_; }
  /// Equal in every row.
  bool operator==(const DhChain& other) const { return rows_ == other.rows_; }

  // The walks are not inlined: a call costs nothing beside them, and every user's compile time would grow.

  /// base_T_tool.
  [[gnu::noinline]] Isometry3 pose(const JointVector<N>& q) const noexcept { return walk(q, ignore_motion).isometry(); }
  /// Tool position [m], base frame.
  [[gnu::noinline]] Vector3 position(const JointVector<N>& q) const noexcept { return walk(q, ignore_motion).p; }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }

  /// Both in one pass.
  [[gnu::noinline]] PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
    std::array<detail::ElementaryMotion, N> joints;
    const auto end = walk(q, [&](int i, DhParameter parameter, const Vector3& axis, const Vector3& point) {
      if (parameter == joint_parameter(i))
        joints[static_cast<std::size_t>(i)] = {axis, point, parameter == DhParameter::theta};
    });
    PoseAndJacobian<N> out{end.isometry(), {}};
    for (int i = 0; i < N; ++i) out.jacobian.col(i) = joints[static_cast<std::size_t>(i)].column(end.p);
    return out;
  }

  /// Where the links are at a configuration, base frame.
  struct Links {
    std::array<Vector3, N> axis;    ///< direction of each joint
    std::array<Vector3, N> point;   ///< a point on each joint's axis
    std::array<Vector3, N> origin;  ///< origin of the frame behind each row
  };

  /// Joint axes and origins of the link frames.
  [[gnu::noinline]] Links links(const JointVector<N>& q) const noexcept {
    Links out;
    const auto end = walk(q, [&](int i, DhParameter parameter, const Vector3& axis, const Vector3& point) {
      if (parameter == Convention::order.front() && i > 0) out.origin[static_cast<std::size_t>(i - 1)] = point;
      if (parameter != joint_parameter(i)) return;
      out.axis[static_cast<std::size_t>(i)] = axis;
      out.point[static_cast<std::size_t>(i)] = point;
    });
    out.origin[N - 1] = end.p;
    return out;
  }

  /// 6 x 5N, analytic.
  [[gnu::noinline]] ParameterJacobian<num_parameters> parameter_jacobian(const JointVector<N>& q) const noexcept {
    std::array<detail::ElementaryMotion, num_parameters> motions;
    const auto end = walk(q, [&](int i, DhParameter parameter, const Vector3& axis, const Vector3& point) {
      const bool rotation = parameter != DhParameter::a && parameter != DhParameter::d;
      motions[static_cast<std::size_t>(5 * i + static_cast<int>(parameter))] = {axis, point, rotation};
    });
    ParameterJacobian<num_parameters> out;
    for (int k = 0; k < num_parameters; ++k) out.col(k) = motions[static_cast<std::size_t>(k)].column(end.p);
    return out;
  }

  /// The pose as a function of joints and parameters, in any scalar.
  template <class S>
  IsometryOf<S> pose(const Eigen::Matrix<S, N, 1>& q, const Eigen::Matrix<S, num_parameters, 1>& p) const {
    using std::cos;
    using std::sin;
    detail::MovingFrame<S> frame;
    for (int i = 0; i < N; ++i) {
      const bool revolute = row(i).joint == JointType::revolute;
      for (const DhParameter parameter : Convention::order) {
        S value = p(5 * i + static_cast<int>(parameter));
        switch (parameter) {
          case DhParameter::a: frame.p += value * frame.x; break;
          case DhParameter::alpha: frame.rotate_x(cos(value), sin(value)); break;
          case DhParameter::beta: frame.rotate_y(cos(value), sin(value)); break;
          case DhParameter::d:
            if (!revolute) value += q(i);
            frame.p += value * frame.z;
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
    DhChain other = *this;
    for (int i = 0; i < N; ++i) {
      DhRow& r = other.rows_[static_cast<std::size_t>(i)];
      r = {p(5 * i), p(5 * i + 1), p(5 * i + 2), p(5 * i + 3), p(5 * i + 4), r.joint};
    }
    other.prepare();
    return other;
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
  constexpr DhChain() = default;

  static constexpr auto ignore_motion = [](int, DhParameter, const Vector3&, const Vector3&) {};

  constexpr void prepare() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      twist_[i] = detail::constexpr_sincos(rows_[i].alpha);
      hayati_[i] = detail::constexpr_sincos(rows_[i].beta);
    }
  }

  constexpr DhParameter joint_parameter(int i) const {
    return row(i).joint == JointType::revolute ? DhParameter::theta : DhParameter::d;
  }

  /// Carries a frame from base to tool; `record(row, parameter, axis, point)` sees each elementary motion before it is
  /// made.
  template <class Record>
  detail::MovingFrame<double> walk(const JointVector<N>& q, Record&& record) const noexcept {
    detail::MovingFrame<double> frame;
    for (int i = 0; i < N; ++i) {
      const DhRow& r = row(i);
      const bool revolute = r.joint == JointType::revolute;
      const auto& [sin_alpha, cos_alpha] = twist_[static_cast<std::size_t>(i)];
      const auto& [sin_beta, cos_beta] = hayati_[static_cast<std::size_t>(i)];
      for (const DhParameter parameter : Convention::order) {
        switch (parameter) {
          case DhParameter::a:
            record(i, parameter, frame.x, frame.p);
            frame.p += r.a * frame.x;
            break;
          case DhParameter::alpha:
            record(i, parameter, frame.x, frame.p);
            frame.rotate_x(cos_alpha, sin_alpha);
            break;
          case DhParameter::beta:
            record(i, parameter, frame.y, frame.p);
            if (sin_beta != 0) frame.rotate_y(cos_beta, sin_beta);
            break;
          case DhParameter::d:
            record(i, parameter, frame.z, frame.p);
            frame.p += (revolute ? r.d : r.d + q(i)) * frame.z;
            break;
          case DhParameter::theta: {
            record(i, parameter, frame.z, frame.p);
            const double angle = revolute ? r.theta + q(i) : r.theta;
            frame.rotate_z(std::cos(angle), std::sin(angle));
            break;
          }
        }
      }
    }
    return frame;
  }

  std::array<DhRow, N> rows_{};
  std::array<detail::SinCos, N> twist_{};   // of alpha
  std::array<detail::SinCos, N> hayati_{};  // of beta
};

}  // namespace vernier
