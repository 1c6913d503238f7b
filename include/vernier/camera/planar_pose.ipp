// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/planar_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"

namespace vernier {

namespace detail {

/// Takes points to a mean of zero and a mean distance of sqrt(2).
VERNIER_LOCAL Matrix3 normalising(std::span<const Vector2> points) {
  Vector2 mean(0, 0);
  for (const Vector2& p : points) mean += p / static_cast<double>(points.size());
  double size = 0;
  for (const Vector2& p : points) size += (p - mean).norm() / static_cast<double>(points.size());
  const double scale = size > 0 ? std::sqrt(2.0) / size : 1;
  Matrix3 out = Matrix3::Identity();
  out(0, 0) = out(1, 1) = scale;
  out(0, 2) = -scale * mean(0);
  out(1, 2) = -scale * mean(1);
  return out;
}

/// The right singular vector of the smallest singular value.
VERNIER_LOCAL VectorX null_vector(const MatrixX& matrix) {
  MatrixX square = MatrixX::Zero((std::max)(matrix.rows(), matrix.cols()), matrix.cols());
  square.topRows(matrix.rows()) = matrix;
  const RightSingular svd = right_singular(square);
  return svd.vectors.col(matrix.cols() - 1);
}

/// Improves a pose by least squares on pixels, as long as every corner stays in front of the camera.
VERNIER_LOCAL BoardPose refined(const Camera& camera, const Board& board, std::span<const Index> corners,
                                std::span<const Vector2> pixels, Isometry3 pose) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto linearise = [&](const Isometry3& at, Matrix6& normal, Vector6& gradient) {
    normal.setZero();
    gradient.setZero();
    double cost = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3 seen = transformed(at, board.corner(corners[i]));
      if (!(seen(2) > 1e-6)) return infinity;
      const ProjectedPoint p = project(camera, seen);
      const Vector2 residual = p.pixel - pixels[i];
      const Matrix6 motion = effect_of_twist(seen - translation(at));
      const Eigen::Matrix<double, 2, 6> jacobian = p.by_point * motion.topRows<3>();
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * residual;
      cost += residual.squaredNorm();
    }
    return std::isfinite(cost) ? cost : infinity;
  };
  Matrix6 normal;
  Vector6 gradient;
  double cost = linearise(pose, normal, gradient), damping = 1e-9;
  for (int iteration = 0; iteration < 50 && cost < infinity; ++iteration) {
    MatrixX damped = normal;
    for (Index k = 0; k < 6; ++k) damped(k, k) *= 1 + damping;
    VectorX solution = -gradient;
    if (!cholesky(damped)) break;
    solve_cholesky(damped, solution);
    const Vector6 step = solution;
    const Isometry3 next = shifted(pose, step);
    Matrix6 next_normal;
    Vector6 next_gradient;
    const double reached = linearise(next, next_normal, next_gradient);
    if (!(reached <= cost)) {
      damping = (std::max)(10 * damping, 1e-6);
      if (damping > 1e6) break;
      continue;
    }
    const bool settled = step.norm() < 1e-10;
    pose = next;
    cost = reached;
    normal = next_normal;
    gradient = next_gradient;
    damping /= 10;
    if (settled) break;
  }
  return {pose, std::sqrt(cost / static_cast<double>((std::max<std::size_t>)(1, corners.size())))};
}

}  // namespace detail

VERNIER_IMPL Matrix3 homography(std::span<const Vector2> plane, std::span<const Vector2> seen) {
  demand(plane.size() == seen.size() && plane.size() >= 4, "homography: ", plane.size(), " points and ", seen.size(),
         " seen, at least 4 of each are needed");
  const Matrix3 from = detail::normalising(plane), to = detail::normalising(seen);
  MatrixX rows(static_cast<Index>(2 * plane.size()), 9);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const Vector3 p = from * Vector3(plane[i](0), plane[i](1), 1), q = to * Vector3(seen[i](0), seen[i](1), 1);
    const auto row = static_cast<Index>(2 * i);
    for (Index c = 0; c < 3; ++c) {
      rows(row, c) = rows(row + 1, 3 + c) = p(c);
      rows(row, 3 + c) = rows(row + 1, c) = 0;
      rows(row, 6 + c) = -q(0) * p(c);
      rows(row + 1, 6 + c) = -q(1) * p(c);
    }
  }
  const VectorX h = detail::null_vector(rows);
  Matrix3 inner;
  for (Index r = 0; r < 3; ++r)
    for (Index c = 0; c < 3; ++c) inner(r, c) = h(3 * r + c);
  const Matrix3 out = to.inverse() * inner * from;
  return out / out(2, 2);
}

VERNIER_IMPL std::array<BoardPose, 2> board_poses(const Camera& camera, const Board& board,
                                                  std::span<const Index> corners, std::span<const Vector2> pixels) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<BoardPose, 2> out;
  out[0].rms = out[1].rms = infinity;
  std::vector<Vector2> plane, rays;
  Vector3 middle(0, 0, 0);
  for (const Index corner : corners) middle += board.corner(corner) / static_cast<double>(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 place = board.corner(corners[i]) - middle;
    plane.emplace_back(place(0), place(1));
    Vector2 ray = normalised(camera, pixels[i]);
    if (!std::isfinite(ray(0) + ray(1)))
      ray = Vector2((pixels[i](0) - camera.cx) / camera.fx, (pixels[i](1) - camera.cy) / camera.fy);
    rays.push_back(ray);
  }
  const Matrix3 h = homography(plane, rays);
  if (!detail::all_finite(h)) return out;
  // infinitesimal plane-based pose: the derivative of the homography at the middle has two decompositions
  const double p = h(0, 2), q = h(1, 2);
  const double aside = std::hypot(p, q), angle = std::atan2(aside, 1);
  const Matrix3 to_ray = exp_so3(aside > 0 ? Vector3(-q * angle / aside, p * angle / aside, 0) : Vector3(0, 0, 0));
  Eigen::Matrix2d jacobian, across;
  for (Index c = 0; c < 2; ++c) {
    jacobian(0, c) = h(0, c) - h(2, c) * p;
    jacobian(1, c) = h(1, c) - h(2, c) * q;
    across(0, c) = to_ray(0, c) - p * to_ray(2, c);
    across(1, c) = to_ray(1, c) - q * to_ray(2, c);
  }
  const double determinant = across(0, 0) * across(1, 1) - across(0, 1) * across(1, 0);
  const auto solved_for = [&](Index r, Index c) {  // across^-1 jacobian
    return (across(1 - r, 1 - r) * jacobian(r, c) - across(r, 1 - r) * jacobian(1 - r, c)) / determinant;
  };
  const double a00 = solved_for(0, 0), a01 = solved_for(0, 1), a10 = solved_for(1, 0), a11 = solved_for(1, 1);
  const double row0 = a00 * a00 + a01 * a01, row1 = a10 * a10 + a11 * a11, product = a00 * a10 + a01 * a11;
  const double scale = std::sqrt((row0 + row1 + std::hypot(row0 - row1, 2 * product)) / 2);
  if (!(scale > 0)) return out;
  const double u00 = a00 / scale, u01 = a01 / scale, u10 = a10 / scale, u11 = a11 / scale;
  double c0 = std::sqrt((std::max)(0.0, 1 - u00 * u00 - u10 * u10)),
         c1 = std::sqrt((std::max)(0.0, 1 - u01 * u01 - u11 * u11));
  if (u00 * u01 + u10 * u11 > 0) c1 = -c1;
  for (const double sign : {1.0, -1.0}) {
    const Vector3 x(u00, u10, sign * c0), y(u01, u11, sign * c1);
    Matrix3 inner;
    inner.col(0) = x;
    inner.col(1) = y;
    inner.col(2) = x.cross(y);
    const Matrix3 rotation = nearest_rotation(to_ray * inner);
    // translation of the middle by linear least squares: x (row 2) = row 0, y (row 2) = row 1
    MatrixX rows(static_cast<Index>(2 * plane.size()), 3);
    VectorX right(rows.rows());
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const Vector3 turned = rotation * Vector3(plane[i](0), plane[i](1), 0);
      const auto row = static_cast<Index>(2 * i);
      for (Index axis = 0; axis < 2; ++axis) {
        rows.row(row + axis) << (axis == 0 ? 1.0 : 0.0), (axis == 1 ? 1.0 : 0.0), -rays[i](axis);
        right(row + axis) = rays[i](axis) * turned(2) - turned(axis);
      }
    }
    const MatrixX solved = detail::solve_by_qr(rows, right).solution;
    const Vector3 at(solved(0, 0), solved(1, 0), solved(2, 0));
    const BoardPose pose =
        detail::refined(camera, board, corners, pixels, rigid_motion(rotation, at - rotation * middle));
    out[sign > 0 ? 0 : 1] = pose;
  }
  if (out[1].rms < out[0].rms) std::swap(out[0], out[1]);
  return out;
}

VERNIER_IMPL Camera camera_from_homographies(std::span<const Matrix3> homographies) {
  Camera out;
  if (homographies.size() < 3) return out;
  // unknown: B = K^-T K^-1 without skew, (B11, B22, B13, B23, B33); pixels are divided by a size so that columns are
  // alike
  double size = 0;
  for (const Matrix3& h : homographies) size += (std::abs(h(0, 2)) + std::abs(h(1, 2))) / 2;
  size /= static_cast<double>(homographies.size());
  if (!(size > 0) || !std::isfinite(size)) return out;
  MatrixX rows(static_cast<Index>(2 * homographies.size()), 5);
  for (std::size_t k = 0; k < homographies.size(); ++k) {
    Matrix3 h = homographies[k];
    h.topRows<2>() /= size;
    h /= std::sqrt(h.col(0).norm() * h.col(1).norm());
    const auto form = [&](Index i, Index j) {
      VectorX v(5);
      v << h(0, i) * h(0, j), h(1, i) * h(1, j), h(0, i) * h(2, j) + h(2, i) * h(0, j),
          h(1, i) * h(2, j) + h(2, i) * h(1, j), h(2, i) * h(2, j);
      return v;
    };
    rows.row(static_cast<Index>(2 * k)) = form(0, 1).transpose();
    rows.row(static_cast<Index>(2 * k + 1)) = (form(0, 0) - form(1, 1)).transpose();
  }
  VectorX b = detail::null_vector(rows);
  if (b(0) < 0) b = -b;
  const double cx = -b(2) / b(0), cy = -b(3) / b(1);
  const double scale = b(4) - b(2) * b(2) / b(0) - b(3) * b(3) / b(1);
  if (!(b(0) > 0 && b(1) > 0 && scale > 0)) return out;
  out.fx = size * std::sqrt(scale / b(0));
  out.fy = size * std::sqrt(scale / b(1));
  out.cx = size * cx;
  out.cy = size * cy;
  return out;
}

}  // namespace vernier
