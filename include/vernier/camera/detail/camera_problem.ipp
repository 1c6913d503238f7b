// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/detail/camera_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier::detail {

inline constexpr double frame_step = 1e-3;     // [m, rad]
inline constexpr double scale_step = 1e-3;     // share
inline constexpr double bend_step = 0.5e-3;    // [m]
inline constexpr double nearest_depth = 1e-3;  // [m]

/// The steps in which intrinsics are counted: pixels, and coefficients of distortion.
VERNIER_LOCAL double intrinsic_step(Index k) { return k < 4 ? 10 : k == 6 || k == 7 ? 1e-3 : 0.1; }

VERNIER_IMPL Vector3 BoardShape::corner(const Board& board, Index k, Eigen::Matrix<double, 3, 4>* by_shape) const {
  const Vector3 flat = board.corner(k);
  const Vector3 from_middle = (flat - board.middle()) / board.half_diagonal();
  const double x = from_middle(0), y = from_middle(1);
  const double heights[3] = {x * x, x * y, y * y};
  if (by_shape != nullptr) {
    by_shape->setZero();
    by_shape->col(0) = flat;
    for (Index c = 0; c < 3; ++c) (*by_shape)(2, c + 1) = heights[c];
  }
  return {(1 + scale) * flat(0), (1 + scale) * flat(1),
          bend(0) * heights[0] + bend(1) * heights[1] + bend(2) * heights[2]};
}

VERNIER_IMPL CameraProblem::CameraProblem(bool mounted_on_flange, const Board& nominal_board,
                                          std::vector<PlacedView> placed, const ImageRows& rows_of_images,
                                          CameraState start, CameraPriors prior_values)
    : state(std::move(start)),
      priors(std::move(prior_values)),
      on_flange_(mounted_on_flange),
      board_(nominal_board),
      views_(std::move(placed)),
      rows_(&rows_of_images) {
  reset_weights();
}

VERNIER_IMPL void CameraProblem::reset_weights() {
  weights_.clear();
  for (const PlacedView& view : views_) weights_.emplace_back(view.view->corners.size(), 1.0);
}

VERNIER_IMPL std::vector<Index> CameraProblem::free_intrinsics() const {
  std::vector<Index> out;
  for (Index k = 0; k < Camera::num_parameters; ++k)
    if (free.intrinsics[static_cast<std::size_t>(k)]) out.push_back(k);
  return out;
}

VERNIER_IMPL std::vector<Index> CameraProblem::free_shape() const {
  std::vector<Index> out;
  if (free.scale) out.push_back(0);
  for (Index c = 1; c < 4 && free.bend; ++c) out.push_back(c);
  return out;
}

VERNIER_IMPL Index CameraProblem::unknowns() const {
  const auto sizes = static_cast<Index>(6 * (state.bases.size() + state.tools.size()) +
                                        free_intrinsics().size() * state.cameras.size() + free_shape().size());
  return sizes + (free.arm ? static_cast<Index>(priors.arm.size()) : 0);
}

VERNIER_IMPL std::vector<std::string> CameraProblem::names() const {
  std::vector<std::string> out;
  if (free.arm && state.arm) {
    const std::vector<std::string> of_arm = state.arm->parameter_names();
    for (const Index k : priors.arm) out.push_back(of_arm[static_cast<std::size_t>(k)]);
  }
  const auto numbered = [](std::size_t k) { return k == 0 ? std::string() : message('@', k + 1); };
  for (const auto& [frame, count] : {std::pair{"base", state.bases.size()}, std::pair{"tool", state.tools.size()}})
    for (std::size_t k = 0; k < count; ++k)
      for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) out.push_back(message(frame, '_', axis, numbered(k)));
  for (std::size_t c = 0; c < state.cameras.size(); ++c)
    for (const Index k : free_intrinsics()) out.push_back(Camera::names[static_cast<std::size_t>(k)] + numbered(c));
  for (const Index k : free_shape()) {
    constexpr const char* shape[] = {"scale", "bend_xx", "bend_xy", "bend_yy"};
    out.emplace_back(shape[k]);
  }
  return out;
}

VERNIER_IMPL VectorX CameraProblem::scales() const {
  VectorX out(unknowns());
  Index at = 0;
  if (free.arm)
    for (const Index k : priors.arm) out(at++) = priors.arm_scales(k);
  for (std::size_t k = 0; k < 6 * (state.bases.size() + state.tools.size()); ++k) out(at++) = frame_step;
  for (std::size_t c = 0; c < state.cameras.size(); ++c)
    for (const Index k : free_intrinsics()) out(at++) = intrinsic_step(k);
  for (const Index k : free_shape()) out(at++) = k == 0 ? scale_step : bend_step;
  return out;
}

VERNIER_IMPL Index CameraProblem::values() const {
  Index sum = 0;
  for (const PlacedView& view : views_) sum += 2 * static_cast<Index>(view.view->corners.size());
  return sum;
}

VERNIER_IMPL std::pair<VectorX, VectorX> CameraProblem::prior_terms() const {
  VectorX precisions = VectorX::Zero(unknowns()), steps = VectorX::Zero(unknowns());
  Index at = 0;
  if (free.arm) {
    const VectorX now = state.arm->parameters();
    for (const Index k : priors.arm) {
      precisions(at) = 1;
      steps(at++) = (now(k) - priors.arm_means(k)) / priors.arm_scales(k);
    }
  }
  at += static_cast<Index>(6 * (state.bases.size() + state.tools.size()));
  for (std::size_t c = 0; c < state.cameras.size(); ++c) {
    const VectorX now = state.cameras[c].parameters(), mean = priors.cameras[c].parameters();
    for (const Index k : free_intrinsics()) {
      const double ratio = intrinsic_step(k) / priors.intrinsics(k);
      precisions(at) = ratio * ratio;
      steps(at++) = (now(k) - mean(k)) / intrinsic_step(k);
    }
  }
  for (const Index k : free_shape()) {
    const double ratio = k == 0 ? scale_step / board_.scale_sigma : bend_step / priors.bend;
    precisions(at) = ratio * ratio;
    steps(at++) = k == 0 ? state.shape.scale / scale_step : state.shape.bend(k - 1) / bend_step;
  }
  return {precisions, steps};
}

VERNIER_IMPL void CameraProblem::move(const VectorX& steps) {
  Index at = 0;
  if (free.arm) {
    VectorX values = state.arm->parameters();
    for (const Index k : priors.arm) values(k) += steps(at++) * priors.arm_scales(k);
    state.arm = state.arm->with_parameters(values);
  }
  for (std::vector<Isometry3>* frames : {&state.bases, &state.tools})
    for (Isometry3& frame : *frames) {
      Vector6 by;
      for (Index k = 0; k < 6; ++k) by(k) = steps(at++) * frame_step;
      frame = shifted(frame, by);
    }
  for (Camera& camera : state.cameras) {
    VectorX values = camera.parameters();
    for (const Index k : free_intrinsics()) values(k) += steps(at++) * intrinsic_step(k);
    camera = camera.with_parameters(values);
  }
  for (const Index k : free_shape())
    if (k == 0)
      state.shape.scale += steps(at++) * scale_step;
    else
      state.shape.bend(k - 1) += steps(at++) * bend_step;
}

VERNIER_IMPL void CameraProblem::flanges(std::vector<Isometry3>& out, PosesAndJacobians* derivatives) const {
  if (!state.arm) {
    out = rows_->flanges;
    return;
  }
  if (derivatives != nullptr) {
    state.arm->poses_and_parameter_jacobians(rows_->joints, *derivatives);
    out = derivatives->poses;
    return;
  }
  out = state.arm->poses(rows_->joints);
}

VERNIER_IMPL std::vector<Isometry3> CameraProblem::poses() const {
  std::vector<Isometry3> of_rows, out;
  flanges(of_rows, nullptr);
  for (const PlacedView& view : views_)
    out.push_back(composed(
        composed(state.bases[static_cast<std::size_t>(view.base)], of_rows[static_cast<std::size_t>(view.row)]),
        state.tools[static_cast<std::size_t>(view.tool)]));
  return out;
}

VERNIER_IMPL Isometry3 CameraProblem::pose_of(const PlacedView& view) const {
  Isometry3 flange;
  if (state.arm)
    flange = state.arm->poses(rows_->joints.row(view.row))[0];
  else
    flange = rows_->flanges[static_cast<std::size_t>(view.row)];
  return composed(composed(state.bases[static_cast<std::size_t>(view.base)], flange),
                  state.tools[static_cast<std::size_t>(view.tool)]);
}

VERNIER_IMPL std::vector<MatrixX> CameraProblem::motion_columns(std::vector<Isometry3>& poses) const {
  std::vector<Isometry3> of_rows;
  PosesAndJacobians derivatives;
  flanges(of_rows, free.arm ? &derivatives : nullptr);
  const Index of_arm = free.arm ? static_cast<Index>(priors.arm.size()) : 0;
  const auto bases = static_cast<Index>(state.bases.size()), tools = static_cast<Index>(state.tools.size());
  std::vector<MatrixX> out;
  poses.clear();
  for (const PlacedView& view : views_) {
    const Isometry3& base = state.bases[static_cast<std::size_t>(view.base)];
    const Isometry3 flange = composed(base, of_rows[static_cast<std::size_t>(view.row)]);
    const Isometry3 pose = composed(flange, state.tools[static_cast<std::size_t>(view.tool)]);
    poses.push_back(pose);
    MatrixX columns = MatrixX::Zero(6, of_arm + 6 * (bases + tools));
    const Matrix6 by_flange = effect_of_twist(translation(pose) - translation(flange));
    const Matrix3 turn = rotation(base);
    for (Index j = 0; j < of_arm; ++j) {
      const Index k = priors.arm[static_cast<std::size_t>(j)];
      Vector3 shift, angle;
      for (Index r = 0; r < 3; ++r) {
        shift(r) = derivatives.jacobians(view.row, 6 * k + r);
        angle(r) = derivatives.jacobians(view.row, 6 * k + 3 + r);
      }
      Vector6 twist;
      twist.head<3>() = turn * shift;
      twist.tail<3>() = turn * angle;
      columns.col(j) = by_flange * twist * priors.arm_scales(k);
    }
    columns.middleCols<6>(of_arm + 6 * view.base) = frame_step * effect_of_twist(translation(pose) - translation(base));
    const Index tool = of_arm + 6 * (bases + view.tool);
    columns.block<3, 3>(0, tool) = frame_step * rotation(flange);
    columns.block<3, 3>(3, tool + 3) = frame_step * rotation(flange);
    out.push_back(std::move(columns));
  }
  return out;
}

VERNIER_IMPL MatrixX CameraProblem::view_rows(std::size_t number, const Isometry3& pose) const {
  const PlacedView& placed = views_[number];
  const View& view = *placed.view;
  const Camera& camera = state.cameras[static_cast<std::size_t>(view.camera)];
  const std::vector<Index> intrinsics = free_intrinsics(), shape = free_shape();
  const auto of_camera = static_cast<Index>(intrinsics.size()), of_shape = static_cast<Index>(shape.size());
  MatrixX out(2 * static_cast<Index>(view.corners.size()), 7 + of_camera + of_shape);
  const Matrix3 turn = rotation(pose), back = turn.transpose();
  const Vector3 at = translation(pose);
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    Eigen::Matrix<double, 3, 4> by_shape;
    const Vector3 corner = state.shape.corner(board_, view.corners[i], &by_shape);
    Vector3 seen;
    Eigen::Matrix<double, 3, 6> motion;
    if (on_flange_) {
      const Vector3 lever = corner - at;
      seen = back * lever;
      motion.leftCols<3>() = -back;
      motion.rightCols<3>() = back * skew(lever);
    } else {
      const Vector3 lever = turn * corner;
      seen = lever + at;
      motion.leftCols<3>().setIdentity();
      motion.rightCols<3>() = -skew(lever);
    }
    if (!(seen(2) > nearest_depth)) return MatrixX(0, out.cols());
    const ProjectedPoint p = project(camera, seen);
    const double root = std::sqrt(weights_[number][i]) / pixel_sigma;
    const Eigen::Matrix<double, 2, 3> by_point = root * p.by_point;
    const Eigen::Matrix<double, 2, 3> by_corner = by_point * (on_flange_ ? back : turn);
    const Eigen::Matrix<double, 2, 4> of_corner = by_corner * by_shape;
    const Eigen::Matrix<double, 2, 6> of_pose = by_point * motion;
    const auto row = static_cast<Index>(2 * i);
    for (Index r = 0; r < 2; ++r) {
      for (Index c = 0; c < 6; ++c) out(row + r, c) = of_pose(r, c);
      for (Index c = 0; c < of_camera; ++c) {
        const Index k = intrinsics[static_cast<std::size_t>(c)];
        out(row + r, 6 + c) = root * p.by_camera(r, k) * intrinsic_step(k);
      }
      for (Index c = 0; c < of_shape; ++c) {
        const Index k = shape[static_cast<std::size_t>(c)];
        out(row + r, 6 + of_camera + c) = of_corner(r, k) * (k == 0 ? scale_step : bend_step);
      }
      out(row + r, out.cols() - 1) = root * (p.pixel(r) - view.pixels[i](r));
    }
  }
  return out;
}

/// Inverse of an upper triangle.
VERNIER_LOCAL Matrix6 inverse_of_upper(const Matrix6& triangle) {
  Matrix6 out = Matrix6::Zero();
  for (Index c = 0; c < 6; ++c)
    for (Index r = c; r >= 0; --r) {
      double sum = r == c ? 1 : 0;
      for (Index k = r + 1; k <= c; ++k) sum -= triangle(r, k) * out(k, c);
      out(r, c) = sum / triangle(r, r);
    }
  return out;
}

/// R of the QR decomposition of rows, of which there may be few.
VERNIER_LOCAL MatrixX reduced_rows(const MatrixX& rows) {
  if (rows.rows() >= rows.cols()) return triangular_factor(rows);
  MatrixX padded = MatrixX::Zero(rows.cols(), rows.cols());
  padded.topRows(rows.rows()) = rows;
  return triangular_factor(padded);
}

VERNIER_IMPL std::vector<RowBlock> CameraProblem::reduced_blocks() const {
  std::vector<Isometry3> poses;
  const std::vector<MatrixX> motion = motion_columns(poses);
  const Index of_motion = motion.empty() ? 0 : motion.front().cols();
  const auto of_camera = static_cast<Index>(free_intrinsics().size());
  const auto of_shape = static_cast<Index>(free_shape().size());
  const Index unknown = unknowns(), width = 7 + of_camera + of_shape, blocks = (width + 5) / 6;
  std::vector<RowBlock> all(views_.size() * static_cast<std::size_t>(blocks));
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const MatrixX rows = view_rows(v, poses[v]);
    MatrixX reduced = MatrixX::Zero(6 * blocks, width);
    if (rows.rows() > 0) reduced.topRows(width) = reduced_rows(rows);
    const Index camera = of_motion + of_camera * views_[v].view->camera;
    const Index shape = of_motion + of_camera * static_cast<Index>(state.cameras.size());
    for (Index b = 0; b < blocks; ++b) {
      RowBlock& block = all[v * static_cast<std::size_t>(blocks) + static_cast<std::size_t>(b)];
      const Rows6 six = reduced.middleRows<6>(6 * b);
      block.dense = Rows6::Zero(6, unknown);
      if (b == 0) block.dense.leftCols(of_motion) = matrix_product(six.leftCols<6>(), motion[v]);
      block.dense.middleCols(camera, of_camera) = six.middleCols(6, of_camera);
      block.dense.middleCols(shape, of_shape) = six.middleCols(6 + of_camera, of_shape);
      block.residual = six.col(width - 1);
      block.unwhiten.setIdentity();
    }
  }
  return all;
}

VERNIER_IMPL NormalEquations CameraProblem::normal_equations() const {
  const std::vector<RowBlock> all = reduced_blocks();
  const auto rows = [&](Index first, Index count, RowBlock* out) { std::copy_n(all.begin() + first, count, out); };
  const auto n = static_cast<Index>(all.size());
  return NormalEquations(BlockSystem{n, n, unknowns(), {}, rows});
}

VERNIER_IMPL MatrixX CameraProblem::dense_rows() const {
  std::vector<Isometry3> poses;
  const std::vector<MatrixX> motion = motion_columns(poses);
  const Index of_motion = motion.empty() ? 0 : motion.front().cols();
  const auto of_camera = static_cast<Index>(free_intrinsics().size());
  const auto of_shape = static_cast<Index>(free_shape().size());
  MatrixX out = MatrixX::Zero(values(), unknowns() + 1);
  Index at = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const MatrixX rows = view_rows(v, poses[v]);
    const Index camera = of_motion + of_camera * views_[v].view->camera;
    const Index shape = of_motion + of_camera * static_cast<Index>(state.cameras.size());
    out.block(at, 0, rows.rows(), of_motion) = matrix_product(rows.leftCols<6>(), motion[v]);
    out.block(at, camera, rows.rows(), of_camera) = rows.middleCols(6, of_camera);
    out.block(at, shape, rows.rows(), of_shape) = rows.middleCols(6 + of_camera, of_shape);
    out.block(at, out.cols() - 1, rows.rows(), 1) = rows.rightCols<1>();
    at += rows.rows();
  }
  return out;
}

VERNIER_IMPL std::vector<Vector2> CameraProblem::residuals(const PlacedView& placed, const Isometry3& pose) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const View& view = *placed.view;
  const Camera& camera = state.cameras[static_cast<std::size_t>(view.camera)];
  const Isometry3 to_camera = on_flange_ ? inverse_of(pose) : pose;
  std::vector<Vector2> out;
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const Vector3 seen = transformed(to_camera, state.shape.corner(board_, view.corners[i]));
    if (!(seen(2) > nearest_depth))
      out.emplace_back(infinity, infinity);
    else
      out.push_back(project(camera, seen).pixel - view.pixels[i]);
  }
  return out;
}

VERNIER_IMPL std::optional<std::pair<Isometry3, Matrix6>> CameraProblem::seen_pose(std::size_t view) const {
  Isometry3 pose = pose_of(views_[view]);
  Matrix6 triangle;
  double step = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 30 && step > 1e-11; ++iteration) {
    const MatrixX rows = view_rows(view, pose);
    if (rows.rows() < 8) return std::nullopt;
    const MatrixX reduced = reduced_rows(rows);
    triangle = reduced.topLeftCorner<6, 6>();
    const Vector6 right = reduced.col(reduced.cols() - 1).head<6>();
    const Vector6 diagonal = triangle.diagonal().cwiseAbs();
    if (!(diagonal.minCoeff() > 1e-9 * diagonal.maxCoeff())) return std::nullopt;
    const Vector6 by = -(inverse_of_upper(triangle) * right);
    step = by.norm();
    if (!(step < 1)) return std::nullopt;
    pose = shifted(pose, by);
  }
  if (!(step < 1e-8)) return std::nullopt;
  const Matrix6 inverse = inverse_of_upper(triangle);
  return std::pair{pose, Matrix6(inverse * inverse.transpose())};
}

VERNIER_IMPL MatrixX CameraProblem::effect_of_shared(std::size_t view, const Isometry3& pose) const {
  const auto of_camera = static_cast<Index>(free_intrinsics().size()),
             of_shape = static_cast<Index>(free_shape().size()), cameras = static_cast<Index>(state.cameras.size());
  MatrixX out = MatrixX::Zero(6, of_camera * cameras + of_shape);
  const MatrixX rows = view_rows(view, pose);
  if (rows.rows() < 8) return out;
  const MatrixX reduced = reduced_rows(rows);
  const Matrix6 inverse = inverse_of_upper(reduced.topLeftCorner<6, 6>());
  const MatrixX effect = matrix_product(inverse, reduced.block(0, 6, 6, of_camera + of_shape));
  out.middleCols(of_camera * views_[view].view->camera, of_camera) = -effect.leftCols(of_camera);
  out.rightCols(of_shape) = -effect.rightCols(of_shape);
  return out;
}

VERNIER_IMPL void CameraProblem::add_own(std::size_t view, const Isometry3& pose, MatrixX& information,
                                         VectorX& gradient) const {
  const auto of_camera = static_cast<Index>(free_intrinsics().size()),
             of_shape = static_cast<Index>(free_shape().size());
  const MatrixX reduced = reduced_rows(view_rows(view, pose));
  const Index own = of_camera + of_shape, rows = reduced.rows() - 6;
  if (rows <= 0) return;
  const MatrixX columns = reduced.block(6, 6, rows, own), residual = reduced.block(6, 6 + own, rows, 1);
  const MatrixX squares = transposed_matrix_product(columns, columns),
                slopes = transposed_matrix_product(columns, residual);
  const Index first = of_camera * views_[view].view->camera, shape = gradient.size() - of_shape;
  const auto at = [&](Index k) { return k < of_camera ? first + k : shape + k - of_camera; };
  for (Index c = 0; c < own; ++c) {
    gradient(at(c)) += slopes(c, 0);
    for (Index r = 0; r < own; ++r) information(at(r), at(c)) += squares(r, c);
  }
}

VERNIER_IMPL VectorX CameraProblem::board_errors(const PlacedView& placed, const Isometry3& pose) const {
  const View& view = *placed.view;
  const Camera& camera = state.cameras[static_cast<std::size_t>(view.camera)];
  const Isometry3 to_camera = on_flange_ ? inverse_of(pose) : pose;
  const Matrix3 turn = rotation(to_camera);
  VectorX out = VectorX::Constant(static_cast<Index>(view.corners.size()), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const Vector3 corner = state.shape.corner(board_, view.corners[i]);
    Vector3 at = corner;  // the point at its height that the pixel shows
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Vector3 seen = transformed(to_camera, at);
      if (!(seen(2) > nearest_depth)) break;
      const ProjectedPoint p = project(camera, seen);
      const Vector2 rest = view.pixels[i] - p.pixel;
      const Eigen::Matrix<double, 2, 3> slope = p.by_point * turn;
      const double determinant = slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0);
      const double x = (slope(1, 1) * rest(0) - slope(0, 1) * rest(1)) / determinant;
      const double y = (slope(0, 0) * rest(1) - slope(1, 0) * rest(0)) / determinant;
      if (!std::isfinite(x + y)) break;
      at(0) += x;
      at(1) += y;
      if (std::abs(x) + std::abs(y) > 1e-9) continue;
      out(static_cast<Index>(i)) = (at - corner).norm();
      break;
    }
  }
  return out;
}

VERNIER_IMPL std::array<double, 2> CameraProblem::reweight(const std::vector<Isometry3>& poses) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> norms;
  std::vector<double> sorted;
  bool seen = true;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    norms.emplace_back();
    for (const Vector2& residual : residuals(views_[v], poses[v])) {
      const double norm = residual.norm() / pixel_sigma;
      seen = seen && std::isfinite(norm);
      norms.back().push_back(norm);
      sorted.push_back(norm);
    }
  }
  if (!seen || sorted.empty()) return {infinity, infinity};
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  constexpr double median_of_two = 1.1774, share_95 = 2.4477;  // of the norm of two normal numbers
  const double threshold = share_95 * (std::max)(1.0, *middle / median_of_two);
  std::array<double, 2> sums{};
  for (std::size_t v = 0; v < views_.size(); ++v)
    for (std::size_t i = 0; i < norms[v].size(); ++i) {
      const double square = norms[v][i] * norms[v][i];
      sums[0] += weights_[v][i] * square;
      weights_[v][i] = norms[v][i] > 0 ? robust_weight(loss, norms[v][i], threshold) : 1;
      sums[1] += weights_[v][i] * square;
    }
  return sums;
}

VERNIER_IMPL IterationEnd CameraProblem::solve(int max_iterations) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CameraState accepted = state;
  std::vector<std::vector<double>> accepted_weights = weights_;
  const auto linearise = [&] {
    const std::array<double, 2> sums = reweight(poses());
    const auto [precisions, steps] = prior_terms();
    LinearisedProblem out{normal_equations(), precisions, steps};
    const double of_priors = weighted_square(precisions, steps);
    const bool finite = sums[0] < infinity && std::isfinite(out.normal.cost);
    out.with_old_weights = finite ? of_priors + sums[0] : infinity;
    out.with_new_weights = finite ? of_priors + sums[1] : infinity;
    return out;
  };
  const auto step = [&](const VectorX& dense, const VectorX&) { move(dense); };
  const auto keep = [&] {
    accepted = state;
    accepted_weights = weights_;
  };
  const auto restore = [&] {
    state = accepted;
    weights_ = accepted_weights;
  };
  return minimise({linearise, step, keep, restore}, {max_iterations, 1e-7, 1e-10});
}

VERNIER_IMPL CameraProblem::Scatter CameraProblem::scatter() const {
  const std::vector<Isometry3> modelled = poses();
  double of_poses = 0, all = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const MatrixX rows = view_rows(v, modelled[v]);
    if (rows.rows() == 0) continue;
    all += rows.col(rows.cols() - 1).squaredNorm();
    const MatrixX reduced = reduced_rows(rows);
    for (Index r = 0; r < 6; ++r) of_poses += reduced(r, reduced.cols() - 1) * reduced(r, reduced.cols() - 1);
  }
  const auto n = static_cast<double>(views_.size());
  const auto of_cameras = static_cast<double>(free_intrinsics().size() * state.cameras.size() + free_shape().size());
  const double of_frames = static_cast<double>(unknowns()) - of_cameras;
  const double spare = (std::max)(1.0, static_cast<double>(values()) - 6 * n - of_cameras);
  Scatter out;
  out.pixels = pixel_sigma * std::sqrt((std::max)(0.0, all - of_poses) / spare);
  out.poses = (std::max)(1.0, of_poses / (std::max)(1.5 * n, 6 * n - of_frames));
  return out;
}

VERNIER_IMPL MatrixX CameraProblem::jackknife() const {
  const std::vector<RowBlock> all = reduced_blocks();
  const VectorX precisions = prior_terms().first;
  const Index unknown = unknowns();
  std::vector<MatrixX> squares(views_.size(), MatrixX::Zero(unknown, unknown));
  std::vector<VectorX> gradients(views_.size(), VectorX::Zero(unknown));
  MatrixX sum = MatrixX::Zero(unknown, unknown);
  for (Index k = 0; k < unknown; ++k) sum(k, k) = precisions(k);
  for (std::size_t b = 0; b < all.size(); ++b) {
    const std::size_t v = b / (all.size() / views_.size());
    add_transposed_product(squares[v], all[b].dense, all[b].dense);
    gradients[v] += transposed_product(all[b].dense, all[b].residual);
    add_transposed_product(sum, all[b].dense, all[b].dense);
  }
  MatrixX out = MatrixX::Zero(unknown, unknown);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    MatrixX without = sum - squares[v], step = gradients[v];
    if (!cholesky(without)) return MatrixX();
    solve_cholesky(without, step);
    add_transposed_product(out, MatrixX(step.transpose()), MatrixX(step.transpose()));
  }
  const auto n = static_cast<double>(views_.size());
  return (n - 1) / n * out;
}

VERNIER_IMPL MatrixX CameraProblem::covariance() const {
  const auto [precisions, steps] = prior_terms();
  const NormalEquations normal = normal_equations();
  const FactorisedEquations solved(normal, precisions, steps);
  return solved.usable() ? solved.inverse() : MatrixX();
}

VERNIER_IMPL bool refine_cameras(CameraProblem& problem, std::vector<Isometry3>& poses) {
  const auto views = problem.views().size();
  const auto frame = [&](const Isometry3& camera_T_board) {
    return problem.on_flange() ? inverse_of(camera_T_board) : camera_T_board;
  };
  const CameraFreedom wanted = problem.free;
  problem.free.scale = problem.free.bend = problem.free.arm = false;
  Index of_camera = 0;
  for (const bool one : problem.free.intrinsics) of_camera += one ? 1 : 0;
  const Index unknown = of_camera * static_cast<Index>(problem.state.cameras.size());
  const auto cost_of = [&](const std::vector<Isometry3>& at) {
    double sum = 0;
    for (std::size_t v = 0; v < views; ++v)
      for (const Vector2& r : problem.residuals(problem.views()[v], frame(at[v]))) sum += r.squaredNorm();
    for (std::size_t c = 0; c < problem.state.cameras.size(); ++c) {
      const VectorX off = problem.state.cameras[c].parameters() - problem.priors.cameras[c].parameters();
      for (Index k = 0; k < off.size(); ++k)
        if (problem.free.intrinsics[static_cast<std::size_t>(k)]) {
          const double ratio = problem.pixel_sigma * off(k) / problem.priors.intrinsics(k);
          sum += ratio * ratio;
        }
    }
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
  };
  double cost = cost_of(poses), damping = 1e-3;
  bool settled = false;
  for (int iteration = 0; iteration < 100 && !settled && damping < 1e9; ++iteration) {
    MatrixX normal = MatrixX::Zero(unknown, unknown);
    VectorX gradient = VectorX::Zero(unknown);
    std::vector<MatrixX> reduced;
    for (std::size_t v = 0; v < views; ++v) {
      const MatrixX rows = problem.view_rows(v, frame(poses[v]));
      if (rows.rows() == 0) return false;
      MatrixX damped = MatrixX::Zero(rows.rows() + 6, rows.cols());  // of the pose, too
      damped.topRows(rows.rows()) = rows;
      for (Index c = 0; c < 6; ++c) damped(rows.rows() + c, c) = std::sqrt(damping) * rows.col(c).norm();
      reduced.push_back(reduced_rows(damped));
      const MatrixX rest = reduced.back().block(6, 6, reduced.back().rows() - 6, of_camera);
      const VectorX right = reduced.back().col(reduced.back().cols() - 1).tail(reduced.back().rows() - 6);
      const Index at = of_camera * problem.views()[v].view->camera;
      normal.block(at, at, of_camera, of_camera) += transposed_matrix_product(rest, rest);
      gradient.segment(at, of_camera) += transposed_product(rest, right);
    }
    normal.diagonal() *= 1 + damping;
    std::vector<Camera> cameras = problem.state.cameras;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const VectorX off = cameras[c].parameters() - problem.priors.cameras[c].parameters();
      Index at = of_camera * static_cast<Index>(c);
      for (Index k = 0; k < off.size(); ++k)
        if (problem.free.intrinsics[static_cast<std::size_t>(k)]) {
          const double ratio = intrinsic_step(k) / problem.priors.intrinsics(k);
          normal(at, at) += ratio * ratio;
          gradient(at++) += ratio * ratio * off(k) / intrinsic_step(k);
        }
    }
    VectorX step = VectorX::Zero(unknown);
    if (unknown > 0) {
      step = -gradient;
      if (!cholesky(normal)) return false;
      solve_cholesky(normal, step);
    }
    std::vector<Isometry3> next = poses;
    for (std::size_t v = 0; v < views; ++v) {
      const MatrixX& r = reduced[v];
      VectorX right = r.col(r.cols() - 1).head<6>();
      if (of_camera > 0)
        right +=
            product(r.block(0, 6, 6, of_camera), step.segment(of_camera * problem.views()[v].view->camera, of_camera));
      const Vector6 by = -(inverse_of_upper(r.topLeftCorner<6, 6>()) * Vector6(right));
      next[v] = frame(shifted(frame(poses[v]), by));
    }
    const std::vector<Camera> before = problem.state.cameras;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      VectorX values = cameras[c].parameters();
      Index at = of_camera * static_cast<Index>(c);
      for (Index k = 0; k < values.size(); ++k)
        if (problem.free.intrinsics[static_cast<std::size_t>(k)]) values(k) += step(at++) * intrinsic_step(k);
      problem.state.cameras[c] = cameras[c].with_parameters(values);
    }
    const double reached = cost_of(next);
    if (!(reached <= cost)) {
      problem.state.cameras = before;
      damping *= 10;
      continue;
    }
    settled = cost - reached < 1e-9 * cost;
    poses = std::move(next);
    cost = reached;
    damping = (std::max)(damping / 10, 1e-12);
  }
  problem.free = wanted;
  return settled;
}

}  // namespace vernier::detail
