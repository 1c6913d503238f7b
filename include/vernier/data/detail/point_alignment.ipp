#pragma once

#include "vernier/data/detail/point_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::detail {

/// Rotation of the base where the inverse of the base is taken for an affine map A p + b: A m - R t + b = p is linear.
VERNIER_API Matrix3 affine_base_rotation(std::span<const Isometry3> flanges, const PointRows& points,
                                         std::span<const PointPair> pairs) {
  constexpr int unknowns = 15;
  MatrixX normal = MatrixX::Zero(unknowns, unknowns);
  VectorX right = VectorX::Zero(unknowns);
  Vector3 mean = Vector3::Zero();
  for (const PointPair& pair : pairs) mean += points.row(pair.point).transpose();
  mean /= static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) {
    const Isometry3& flange = flanges[static_cast<std::size_t>(pair.row)];
    Eigen::Matrix<double, 3, unknowns> rows = Eigen::Matrix<double, 3, unknowns>::Zero();
    for (int k = 0; k < 3; ++k) rows.block<1, 3>(k, 3 * k) = points.row(pair.point) - mean.transpose();
    rows.middleCols<3>(9) = -flange.linear();
    rows.rightCols<3>().setIdentity();
    normal += rows.transpose().lazyProduct(rows);
    right += rows.transpose().lazyProduct(flange.translation());
  }
  normal.diagonal().array() += 1e-9 * normal.trace();
  if (!cholesky(normal)) return Matrix3::Identity();
  solve_cholesky(normal, right);
  Matrix3 base;  // column k is row k of A
  for (int k = 0; k < 3; ++k) base.col(k) = right.segment<3>(3 * k);
  return nearest_rotation(base);
}

/// Gauss-Newton from a rotation of the base.
VERNIER_API PointFrames refined_frames(std::span<const Isometry3> flanges, const PointRows& points,
                                       std::span<const PointPair> pairs, const Matrix3& start, int max_steps) {
  constexpr double offset_weight = 1e-6;  // a prior of little: an offset of 1 m is worth 1 mm at every point
  const auto n = static_cast<double>(pairs.size());
  PointFrames frames;
  frames.base.linear() = start;
  for (int step_number = 0; step_number < max_steps; ++step_number) {
    MatrixX normal = MatrixX::Zero(9, 9);
    VectorX step = VectorX::Zero(9);
    for (const PointPair& pair : pairs) {
      const Isometry3& flange = flanges[static_cast<std::size_t>(pair.row)];
      const Vector3 turned = frames.base.linear() * (flange * frames.offset);
      const Vector3 left = points.row(pair.point).transpose() - turned - frames.base.translation();
      Eigen::Matrix<double, 3, 9> rows;                      // of the point by rotation, translation and offset
      rows << 0, turned.z(), -turned.y(), 1, 0, 0, 0, 0, 0,  //
          -turned.z(), 0, turned.x(), 0, 1, 0, 0, 0, 0,      //
          turned.y(), -turned.x(), 0, 0, 0, 1, 0, 0, 0;
      rows.rightCols<3>() = frames.base.linear() * flange.linear();
      normal += rows.transpose().lazyProduct(rows);
      step += rows.transpose().lazyProduct(left);
    }
    normal.bottomRightCorner<3, 3>().diagonal().array() += n * offset_weight;
    step.tail<3>() -= n * offset_weight * frames.offset;
    normal.diagonal().array() += 1e-12 * normal.trace();
    if (!cholesky(normal)) break;
    solve_cholesky(normal, step);
    frames.base.linear() = exp_so3(Vector3(step.head<3>())) * frames.base.linear();
    frames.base.translation() += step.segment<3>(3);
    frames.offset += step.tail<3>();
    if (!(step.norm() > 1e-9)) break;
  }
  double sum = 0;
  for (const PointPair& pair : pairs)
    sum +=
        (points.row(pair.point).transpose() - frames.point(flanges[static_cast<std::size_t>(pair.row)])).squaredNorm();
  frames.rms = std::sqrt(sum / (n - 3));
  return frames;
}

VERNIER_IMPL PointFrames fit_point_frames(std::span<const Isometry3> flanges, const PointRows& points,
                                          std::span<const PointPair> pairs, int max_steps) {
  PointRows from(static_cast<Index>(pairs.size()), 3), to(static_cast<Index>(pairs.size()), 3);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    from.row(static_cast<Index>(k)) = flanges[static_cast<std::size_t>(pairs[k].row)].translation().transpose();
    to.row(static_cast<Index>(k)) = points.row(pairs[k].point);
  }
  const PointFrames affine =
      refined_frames(flanges, points, pairs, affine_base_rotation(flanges, points, pairs), max_steps);
  const PointFrames rigid = refined_frames(flanges, points, pairs, register_points(from, to).linear(), max_steps);
  return rigid.rms < affine.rms || !std::isfinite(affine.rms) ? rigid : affine;
}

VERNIER_IMPL std::vector<PointPair> align_with_gaps(Index rows, Index points, FunctionRef<double(Index, Index)> cost) {
  enum Step : unsigned char { pair, skip_row, skip_point };
  const auto width = static_cast<std::size_t>(points + 1);
  std::vector<unsigned char> steps(static_cast<std::size_t>(rows + 1) * width, skip_point);
  std::vector<double> above(width), here(width);  // smallest costs of the first rows and points
  for (std::size_t j = 0; j < width; ++j) above[j] = 0.5 * static_cast<double>(j);
  for (Index i = 0; i < rows; ++i) {
    unsigned char* step = steps.data() + static_cast<std::size_t>(i + 1) * width;
    here[0] = 0.5 * static_cast<double>(i + 1);
    step[0] = skip_row;
    for (std::size_t j = 1; j < width; ++j) {
      here[j] = std::min(above[j], here[j - 1]) + 0.5;
      step[j] = above[j] <= here[j - 1] ? skip_row : skip_point;
      const double one = cost(i, static_cast<Index>(j - 1));
      if (one < 1 && above[j - 1] + one < here[j]) {
        here[j] = above[j - 1] + one;
        step[j] = pair;
      }
    }
    std::swap(above, here);
  }
  std::vector<PointPair> out;
  for (Index i = rows, j = points; i > 0 || j > 0;) {
    const unsigned char step = steps[static_cast<std::size_t>(i) * width + static_cast<std::size_t>(j)];
    if (step == pair) out.push_back({i - 1, j - 1});
    if (step != skip_point) --i;
    if (step != skip_row) --j;
  }
  std::reverse(out.begin(), out.end());
  return out;
}

}  // namespace vernier::detail
