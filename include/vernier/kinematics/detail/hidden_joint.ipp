#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/hidden_joint.hpp"
#include "vernier/kinematics/detail/reflections.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 turn_about(const AxisLine& axis, double angle) noexcept {
  Isometry3 out = Isometry3::Identity();
  out.linear() = exp_so3(Vector3(axis.direction * angle));
  out.translation() = axis.point - out.linear() * axis.point;
  return out;
}

VERNIER_IMPL Isometry3 to_z_axis(const AxisLine& line) noexcept {
  const Vector3 x = line.direction.unitOrthogonal();
  Isometry3 out = Isometry3::Identity();
  out.linear() << x.transpose(), line.direction.cross(x).transpose(), line.direction.transpose();
  out.translation() = -(out.linear() * line.point);
  return out;
}

VERNIER_IMPL LineCoordinates coordinates_of(const AxisLine& line) noexcept {
  const Vector3 &p = line.point, &l = line.direction;
  const double pp = p.dot(p), pl = p.dot(l);
  const Vector3 m = p.cross(l), f = pp * l - 2 * pl * p;
  LineCoordinates out;
  out << p.x(), l.x(), m.x(), f.x(), p.y(), l.y(), m.y(), f.y(), p.z(), l.z(), m.z(), f.z(), pp, pl;
  return out;
}

/// The coordinates of a line turned about `inner` and then about `outer`, as coefficients of the products of
/// (1, cos, sin) of the outer and of the inner angle. They follow from three angles each, a third of a turn apart.
VERNIER_API Eigen::Matrix<double, 14, 9> turned_twice(const AxisLine& outer, const AxisLine& inner,
                                                      const AxisLine& line) noexcept {
  constexpr double angles[3] = {0, 2 * std::numbers::pi / 3, -2 * std::numbers::pi / 3};
  Eigen::Matrix<double, 14, 9> out = Eigen::Matrix<double, 14, 9>::Zero();
  Isometry3 outer_turns[3];
  for (int j = 0; j < 3; ++j) outer_turns[j] = turn_about(outer, angles[j]);
  for (const double b : angles) {
    const AxisLine once = turn_about(inner, b) * line;
    for (int j = 0; j < 3; ++j) {
      const LineCoordinates sample = coordinates_of(outer_turns[j] * once);
      const double outer_weights[3] = {1. / 3, 2. / 3 * std::cos(angles[j]), 2. / 3 * std::sin(angles[j])};
      const double inner_weights[3] = {1. / 3, 2. / 3 * std::cos(b), 2. / 3 * std::sin(b)};
      for (int column = 0; column < 9; ++column)
        out.col(column) += outer_weights[column / 3] * inner_weights[column % 3] * sample;
    }
  }
  return out;
}

/// Rows over the products of (1, cos 2h, sin 2h) with anything, times cos h and, below, times sin h: rows over those of
/// (cos 3h, sin 3h, cos h, sin h).
template <int Rows>
Eigen::Matrix<double, 2 * Rows, 12> times_half_angle(const Eigen::Matrix<double, Rows, 9>& a) {
  const auto one = a.template leftCols<3>(), c = a.template middleCols<3>(3), s = a.template rightCols<3>();
  Eigen::Matrix<double, 2 * Rows, 12> out;
  out << c / 2, s / 2, one + c / 2, s / 2,  //
      -s / 2, c / 2, s / 2, one - c / 2;
  return out;
}

VERNIER_IMPL LoopPencil eliminate(const ClosedLoop& loop) noexcept {
  // E_3 E_4 E_5 (line 6) = E_2^-1 E_1^-1 closure (line 6), as E_6 does not move its own axis. Combinations of the 14
  // equations without the eight terms in joints 1 and 2 are the left null space of those terms.
  const auto& axes = loop.axes;
  const auto reversed = [](const AxisLine& line) { return AxisLine{line.point, -line.direction}; };
  const Eigen::Matrix<double, 14, 9> left = turned_twice(axes[3], axes[4], axes[5]);
  const Eigen::Matrix<double, 14, 9> right = turned_twice(reversed(axes[1]), reversed(axes[0]), loop.closure * axes[5]);
  Eigen::Matrix<double, 14, 8> eliminated = right.rightCols<8>();
  Eigen::Matrix<double, 14, 6> complement;
  orthogonal_complement(eliminated.data(), 14, 8, 8, complement.data());
  const Eigen::Matrix<double, 6, 14> combinations = complement.transpose();

  Eigen::Matrix<double, 6, 9> constant = combinations.rightCols<6>() * left.bottomRows<6>();
  constant.col(0) -= combinations * right.col(0);
  LoopPencil out;
  out.constant = times_half_angle<6>(constant);
  out.equation.setZero();
  out.equation.topLeftCorner<6, 8>() = combinations.leftCols<8>();
  out.equation.bottomRightCorner<6, 8>() = combinations.leftCols<8>();
  out.turning = times_half_angle<8>(left.topRows<8>());
  return out;
}

/// What turns with joint 3, turned [rad].
VERNIER_API Eigen::Matrix<double, 16, 12> turned_by(const LoopPencil& pencil, double q3) noexcept {
  const double c = std::cos(q3), s = std::sin(q3);
  Eigen::Matrix<double, 16, 12> out;
  for (int k = 0; k < 16; k += 8) {
    const auto x = pencil.turning.middleRows<4>(k), y = pencil.turning.middleRows<4>(k + 4);
    out.middleRows<4>(k) = c * x - s * y;
    out.middleRows<4>(k + 4) = s * x + c * y;
  }
  return out;
}

VERNIER_IMPL LoopPencil::Matrix equations_at(const LoopPencil& pencil, double q3) noexcept {
  return pencil.constant + pencil.equation * turned_by(pencil, q3);
}

VERNIER_IMPL HiddenJointValues hidden_joint_values(const LoopPencil& pencil) noexcept {
  // With B, W, Y the parts of the pencil, R the turn by q3 / 2 and u = R Y x, (B + W R^2 Y) x = 0 becomes
  //     t u = -J (1 + 2 Y M^-1 W) u,    M = B - W Y the pencil at half a turn, J a quarter turn, t = tan(q3 / 2).
  // Another origin of q3 only turns Y.
  constexpr double pi = std::numbers::pi;
  constexpr int origins = 5;
  HiddenJointValues out;
  Eigen::PartialPivLU<LoopPencil::Matrix> best;
  double best_inverse_condition = 0, origin = 0;
  for (int k = 0; k < origins; ++k) {
    const double candidate = 0.3 + 2 * pi / origins * k;  // 0.3: zeros of catalogue arms are special
    const Eigen::PartialPivLU<LoopPencil::Matrix> lu(equations_at(pencil, candidate + pi));
    const double inverse_condition = lu.rcond();
    if (inverse_condition > best_inverse_condition) {  // false for NaN too
      best_inverse_condition = inverse_condition;
      best = lu;
      origin = candidate;
    }
  }
  out.condition = best_inverse_condition > 0 ? 1 / best_inverse_condition : std::numeric_limits<double>::infinity();
  if (!(best_inverse_condition > 0)) return out;

  using Matrix16 = Eigen::Matrix<double, 16, 16>;
  const Eigen::Matrix<double, 12, 16> solved = best.solve(pencil.equation);
  Matrix16 doubled = 2 * turned_by(pencil, origin) * solved;
  doubled.diagonal().array() += 1;
  Matrix16 a;
  for (int k = 0; k < 16; k += 8) {
    a.middleRows<4>(k) = doubled.middleRows<4>(k + 4);
    a.middleRows<4>(k + 4) = -doubled.middleRows<4>(k);
  }
  if (!a.allFinite()) return out;
  double work[16];
  to_hessenberg(a.data(), 16, work);
  Eigen::RealSchur<Matrix16> schur;
  schur.computeFromHessenberg(a, a, false);
  if (schur.info() != Eigen::Success) return out;
  const auto insert = [&](std::complex<double> t) {
    out.angles[static_cast<std::size_t>(out.count++)] = origin + 2. * std::atan(t);
  };
  const Matrix16& triangular = schur.matrixT();  // but for blocks of two, which have conjugate eigenvalues
  for (int i = 0; i < 16; ++i) {
    if (i == 15 || triangular(i + 1, i) == 0) {
      insert(triangular(i, i));
      continue;
    }
    const double middle = (triangular(i, i) + triangular(i + 1, i + 1)) / 2, half = triangular(i, i) - middle;
    const std::complex<double> root =
        std::sqrt(std::complex<double>(half * half + triangular(i, i + 1) * triangular(i + 1, i)));
    insert(middle + root);
    insert(middle - root);
    ++i;
  }
  return out;
}

}  // namespace vernier::detail
