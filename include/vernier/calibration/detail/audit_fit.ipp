// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/calibration/detail/audit_fit.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/measurements/pose_sensor.hpp"

namespace vernier::detail {

VERNIER_IMPL MeasuredSet AuditRows::measured() const {
  return MeasuredSet("poses", joints, PoseSensor(positions, orientations));
}

VERNIER_IMPL AuditRows AuditRows::rows(std::span<const Index> indices, Index shift) const {
  const auto n = static_cast<Index>(indices.size());
  AuditRows out{MatrixX(n, joints.cols()), PointRows(n, 3)};
  out.rotation_vectors.resize(oriented() ? n : 0, 3);
  for (Index i = 0; i < n; ++i) {
    const Index row = indices[static_cast<std::size_t>(i)];
    for (Index j = 0; j < joints.cols(); ++j) out.joints(i, j) = joints(row, j);
    set_point(out.positions, i, point(positions, row + shift));
    if (!oriented()) continue;
    out.orientations.push_back(orientations[static_cast<std::size_t>(row + shift)]);
    set_point(out.rotation_vectors, i, point(rotation_vectors, row + shift));
  }
  return out;
}

VERNIER_LOCAL double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

VERNIER_IMPL double robust_scale(const PointRows& residuals) {
  const VectorX norms = distances_from(residuals, Vector3::Zero());
  return (std::max)(median_of({norms.begin(), norms.end()}) / median_norm, 1e-9);
}

VERNIER_IMPL double AuditResiduals::score() const { return std::hypot(position_scale, 0.25 * rotation_scale); }

VERNIER_LOCAL AuditResiduals residuals_of_poses(const std::vector<Isometry3>& poses, const AuditRows& rows) {
  const Index n = rows.size();
  AuditResiduals out{PointRows(n, 3), PointRows(rows.oriented() ? n : 0, 3)};
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    set_point(out.position, i, point(rows.positions, i) - translation(poses[k]));
    if (rows.oriented()) set_point(out.rotation, i, rotation_difference(rows.orientations[k], rotation(poses[k])));
  }
  out.position_scale = robust_scale(out.position);
  if (rows.oriented()) out.rotation_scale = robust_scale(out.rotation);
  return out;
}

VERNIER_IMPL AuditResiduals audit_residuals(const ArmGeometry& arm, const AuditRows& rows) {
  return residuals_of_poses(arm.poses(rows.joints), rows);
}

VERNIER_IMPL VectorX audit_frames_std(const ArmGeometry& arm, bool oriented) {
  constexpr double free = std::numeric_limits<double>::infinity();
  VectorX out = VectorX::Zero(arm.num_parameters());
  const Index tool = out.size() - 6;
  for (Index k = 0; k < 6; ++k) {
    out(k) = free;
    if (k < 3 || oriented) out(tool + k) = free;
  }
  return out;
}

VERNIER_IMPL VectorX audit_geometry_std(const ArmGeometry& arm, bool oriented, double length_std, double angle_std) {
  VectorX out = audit_frames_std(arm, oriented);
  for (int j = 0; j < arm.joints(); ++j)
    for (Index k = 0; k < 5; ++k)
      out(ArmParameters::of_row(j, DhParameter::a) + k) = k == 0 || k == 2 ? length_std : angle_std;
  return out;
}

VERNIER_IMPL Index zero_parameter(const ArmGeometry& arm, int joint) { return arm.joint_parameter(joint); }

/// Free columns, and the precisions of their priors.
struct AuditColumns {
  std::vector<Index> free;
  VectorX precision;

  VERNIER_LOCAL explicit AuditColumns(const ConstVectorRef& stds) {
    for (Index k = 0; k < stds.size(); ++k)
      if (stds(k) > 0) free.push_back(k);
    precision.resize(static_cast<Index>(free.size()));
    for (Index k = 0; k < precision.size(); ++k) {
      const double s = stds(free[static_cast<std::size_t>(k)]);
      precision(k) = std::isfinite(s) ? 1 / (s * s) : 1e-4;  // 100 m or rad: keeps degenerate directions where they are
    }
  }
  Index size() const { return precision.size(); }
};

/// J' W J, and precisions of the unknowns.
VERNIER_LOCAL MatrixX normal_matrix(const MatrixX& jacobian, const VectorX& weights, const VectorX& precision) {
  MatrixX out = transposed_matrix_product(jacobian, rows_scaled(weights, jacobian));
  for (Index k = 0; k < precision.size(); ++k) out(k, k) += precision(k);
  return out;
}

/// Whitened Jacobian of the free columns, six (or three) rows a pose, unweighted.
VERNIER_LOCAL MatrixX audit_jacobian(const PosesAndJacobians& at, const AuditColumns& columns, bool oriented,
                                     const AuditResiduals& residuals) {
  const Index n = at.jacobians.rows(), values = oriented ? 6 : 3;
  MatrixX out(values * n, columns.size());
  for (Index c = 0; c < columns.size(); ++c)
    for (Index v = 0; v < values; ++v) {
      const double scale = v < 3 ? residuals.position_scale : residuals.rotation_scale;
      const Index from = 6 * columns.free[static_cast<std::size_t>(c)] + v;
      for (Index i = 0; i < n; ++i) out(values * i + v, c) = at.jacobians(i, from) / scale;
    }
  return out;
}

VERNIER_LOCAL VectorX audit_whitened(const AuditResiduals& residuals) {
  const Index n = residuals.position.rows(), values = residuals.rotation.rows() > 0 ? 6 : 3;
  VectorX out(values * n);
  for (Index i = 0; i < n; ++i) {
    for (Index c = 0; c < 3; ++c) {
      out(values * i + c) = residuals.position(i, c) / residuals.position_scale;
      if (values == 6) out(values * i + 3 + c) = residuals.rotation(i, c) / residuals.rotation_scale;
    }
  }
  return out;
}

/// Three values from the k-th on.
VERNIER_LOCAL inline Vector3 three(const VectorX& values, Index k) { return {values(k), values(k + 1), values(k + 2)}; }

/// Weights of Cauchy's loss, positions and orientations apart.
VERNIER_LOCAL VectorX audit_weights(const VectorX& whitened) {
  constexpr double tuning = 4;
  VectorX out(whitened.size());
  for (Index k = 0; k + 3 <= whitened.size(); k += 3)
    out(k) = out(k + 1) = out(k + 2) = 1 / (1 + three(whitened, k).squaredNorm() / (tuning * tuning));
  return out;
}

VERNIER_IMPL AuditFit audit_fit(const ArmGeometry& start, const ConstVectorRef& centre, const ConstVectorRef& stds,
                                const AuditRows& rows, int iterations) {
  const AuditColumns columns(stds);
  const VectorX values = start.parameters();
  VectorX means = centre;  // of the priors
  std::vector<GeometricUnknown> unknowns;
  VectorX steps(columns.size());
  for (Index k = 0; k < columns.size(); ++k) {
    const Index p = columns.free[static_cast<std::size_t>(k)];
    const bool known = std::isfinite(stds(p));
    if (!known) means(p) = values(p);
    const double scale = known ? stds(p) : 1;
    unknowns.push_back({p, -1, scale, columns.precision(k) * scale * scale});
    steps(k) = (values(p) - means(p)) / scale;
  }
  ArmParameterisation arm({start.with_parameters(means)}, std::move(unknowns));
  arm.move(steps);
  AuditFit out{start, audit_residuals(start, rows)};
  constexpr int steps_at_a_time = 3;  // then the scales of the residuals are estimated again
  for (int done = 0; done < iterations; done += steps_at_a_time) {
    const AuditResiduals before = out.residuals;
    const double angle = rows.oriented() ? before.rotation_scale : 1;
    CalibrationProblem problem(
        arm,
        {MeasuredSet("poses", rows.joints,
                     PoseSensor(rows.positions, rows.orientations, {before.position_scale, angle}))},
        Loss::cauchy);
    problem.joint_columns = false;
    problem.loss_scale = 4 / 2.8;  // that of `audit_weights`, in place of the usual one
    if (!problem.solve(steps_at_a_time, 1e-4).usable) break;
    arm = problem.arm;
    out = {arm.geometry(0), audit_residuals(arm.geometry(0), rows)};
    if (std::abs(out.residuals.score() - before.score()) < 1e-3 * before.score()) break;
  }
  return out;
}

VERNIER_IMPL std::vector<LeftOut> leave_out_rows(const AuditFit& fit, const ConstVectorRef& stds,
                                                 const AuditRows& rows) {
  const AuditColumns columns(stds);
  PosesAndJacobians at;
  fit.arm.poses_and_parameter_jacobians(rows.joints, at);
  const bool oriented = rows.oriented();
  const MatrixX jacobian = audit_jacobian(at, columns, oriented, fit.residuals);
  const VectorX whitened = audit_whitened(fit.residuals), weights = audit_weights(whitened);
  MatrixX factor = normal_matrix(jacobian, weights, columns.precision), whitening = VERNIER_LATER(jacobian).transpose();
  cholesky(factor);
  solve_lower(factor, whitening);
  std::vector<LeftOut> out(static_cast<std::size_t>(rows.size()));
  const Index values = oriented ? 6 : 3;
  std::vector<double> factors[2];
  for (Index i = 0; i < rows.size(); ++i) {
    LeftOut& row = out[static_cast<std::size_t>(i)];
    for (Index part = 0; part < values; part += 3) {
      const Index k = values * i + part;
      Matrix3 h;
      for (Index a = 0; a < 3; ++a)
        for (Index b = 0; b < 3; ++b)
          h(a, b) = VERNIER_LATER(whitening).col(k + a).dot(VERNIER_LATER(whitening).col(k + b));
      const VERNIER_LATER_TYPE(Matrix3) identity = Matrix3::Identity(), rest = (1 + 1e-9) * identity - weights(k) * h;
      const VERNIER_LATER_TYPE(Matrix3) kept = VERNIER_LATER(rest).inverse();
      const VERNIER_LATER_TYPE(Vector3) r = kept * three(whitened, k);
      const VERNIER_LATER_TYPE(Matrix3) covariance = identity + kept * h, weight = VERNIER_LATER(covariance).inverse();
      const double t = std::sqrt((std::max)(0.0, r.dot(weight * r)));
      factors[part / 3].push_back(t);
      if (part == 0) {
        row.position = r.norm() * fit.residuals.position_scale;
        row.position_factor = t;
        row.position_weight = weight / (fit.residuals.position_scale * fit.residuals.position_scale);
      } else {
        row.rotation = r.norm() * fit.residuals.rotation_scale;
        row.rotation_factor = t;
      }
    }
  }
  const double position = median_norm / (std::max)(median_of(factors[0]), 1e-9);
  const double rotation = oriented ? median_norm / (std::max)(median_of(factors[1]), 1e-9) : 1;
  for (LeftOut& row : out) {
    row.position_factor *= position;
    row.rotation_factor *= rotation;
    row.position_weight *= position * position;
  }
  return out;
}

VERNIER_IMPL BaseTrend base_trend(const AuditFit& fit, const ConstVectorRef& stds, const AuditRows& rows,
                                  const ConstVectorRef& times) {
  BaseTrend out;
  const Index n = rows.size(), values = rows.oriented() ? 6 : 3;
  const int joints = fit.arm.joints();
  const double first = VERNIER_LATER(times).minCoeff(), span = VERNIER_LATER(times).maxCoeff() - first;
  const AuditColumns columns(stds);
  const Index geometry = columns.size();
  const Index orders =
      std::clamp<Index>((values * n / 2 - 6 - geometry) / (2 * joints), 0, std::clamp<Index>(n / 40, 1, 8));
  const Index per_joint = 2 * orders, harmonics = per_joint * joints, all = 6 + geometry + harmonics;
  if (!(span > 0) || values * n < 2 * all) return out;
  PosesAndJacobians at;
  fit.arm.poses_and_parameter_jacobians(rows.joints, at);
  MatrixX design(values * n, all);
  VERNIER_LATER(design).middleCols(6, geometry) = audit_jacobian(at, columns, rows.oriented(), fit.residuals);
  const Vector3 mean = centroid(rows.positions);
  std::vector<Matrix6> motions(static_cast<std::size_t>(n));
  const auto sigma = [&](Index v) { return v < 3 ? fit.residuals.position_scale : fit.residuals.rotation_scale; };
  for (Index i = 0; i < n; ++i) {
    Matrix6& motion = motions[static_cast<std::size_t>(i)];
    motion.setIdentity();
    const Matrix3 lever = skew(Vector3(point(rows.positions, i) - mean));
    for (Index c = 0; c < 3; ++c)
      for (Index v = 0; v < 3; ++v) motion(v, c + 3) = -lever(v, c);
    const double t = (times(i) - first) / span - 0.5;
    for (Index v = 0; v < values; ++v)
      for (Index c = 0; c < 6; ++c) design(values * i + v, c) = t / sigma(v) * motion(v, c);
    for (int j = 0; j < joints; ++j)
      for (Index v = 0; v < values; ++v) {
        const double column = at.jacobians(i, 6 * zero_parameter(fit.arm, j) + v) / sigma(v), q = rows.joints(i, j);
        for (Index k = 0; k < orders; ++k) {
          const double angle = static_cast<double>(k + 1) * q;
          const Index at_order = 6 + geometry + per_joint * j + 2 * k;
          design(values * i + v, at_order) = column * std::cos(angle);
          design(values * i + v, at_order + 1) = column * std::sin(angle);
        }
      }
  }
  VectorX precision(all);
  for (Index k = 0; k < all; ++k)
    precision(k) = k < 6 ? 1e-9 : k < 6 + geometry ? columns.precision(k - 6) : 1 / (3e-3 * 3e-3);
  VectorX whitened = audit_whitened(fit.residuals), weights = audit_weights(whitened), solution;
  MatrixX covariance;
  double scale = 1;
  for (int round = 0; round < 3; ++round) {
    MatrixX normal = normal_matrix(design, weights, precision / (scale * scale));
    MatrixX columns_of_motion = MatrixX::Identity(all, 6);
    solution = transposed_product(design, VERNIER_LATER(weights).cwiseProduct(whitened));
    if (!cholesky(normal)) return out;
    solve_cholesky(normal, solution);
    solve_cholesky(normal, columns_of_motion);
    covariance = VERNIER_LATER(columns_of_motion).topRows(6);
    const VectorX left = whitened - product(design, solution);
    std::vector<double> norms, of_positions;
    for (Index k = 0; k + 3 <= left.size(); k += 3) {
      norms.push_back(three(left, k).norm());
      if (k % values == 0) of_positions.push_back(norms.back());
    }
    scale = median_of(norms) / median_norm;
    out.scale = median_of(of_positions) / median_norm * fit.residuals.position_scale;
    weights = audit_weights(left / scale);
  }
  const double dof = static_cast<double>(values * n) / (std::max)(1.0, static_cast<double>(values * n - all));
  for (Index k = 0; k < 6; ++k) out.motion(k) = solution(k);
  VectorX whitened_motion = out.motion;
  if (!cholesky(covariance)) return {};
  solve_lower(covariance, whitened_motion);
  out.chi_square = whitened_motion.squaredNorm() / (scale * scale * dof);
  out.centre = mean;
  double sum = 0;
  for (const Matrix6& motion : motions)
    sum += VERNIER_LATER(Vector6(motion * out.motion)).template head<3>().squaredNorm();
  out.displacement = std::sqrt(sum / static_cast<double>(n));
  return out;
}

VERNIER_IMPL AuditRows without_trend(const AuditRows& rows, const BaseTrend& trend, const ConstVectorRef& times) {
  AuditRows out = rows;
  const double first = VERNIER_LATER(times).minCoeff(), span = VERNIER_LATER(times).maxCoeff() - first;
  for (Index i = 0; i < rows.size(); ++i) {
    const Vector6 motion = ((times(i) - first) / span - 0.5) * trend.motion;
    const Vector3 shift = VERNIER_LATER(motion).template head<3>(), turn = VERNIER_LATER(motion).template tail<3>();
    const Matrix3 back = exp_so3(Vector3(-turn));
    const Vector3 arm = point(rows.positions, i) - trend.centre, position = trend.centre + back * arm;
    set_point(out.positions, i, position - shift);
    if (rows.oriented()) {
      Matrix3& turned = out.orientations[static_cast<std::size_t>(i)];
      turned = back * turned;
    }
  }
  return out;
}

}  // namespace vernier::detail
