#pragma once

/// @file
/// Weighted residuals of a model against data, and their Jacobian: the one place where a measurement meets a model.

#include <cmath>
#include <vector>

#include "vernier/core/so3.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/concepts.hpp"

namespace vernier::detail {

/// Rows: three position residuals a sample, then (behind all of them) three orientation residuals a sample; or one
/// residual a distance; each divided by its sensor's sigma. Columns: the free parameters in steps of their sizes.
struct Linearisation {
  VectorX residuals;
  MatrixX jacobian;  // empty when not asked for
  Index group = 3;   // rows that belong together: 3, or 1 for distances

  /// model minus measured: p - p_measured, and Log(R R_measured').
  template <ParametricModel Model>
  void evaluate(const Model& model, const Dataset<Model::dof>& data, bool oriented, double position_sigma,
                double orientation_sigma, const std::vector<Index>& free, const VectorX& sizes, bool with_jacobian) {
    const Index n = data.size(), rows = (oriented ? 6 : 3) * n, columns = static_cast<Index>(free.size());
    group = 3;
    residuals.resize(rows);
    if (with_jacobian) jacobian.resize(rows, columns);
    for (Index i = 0; i < n; ++i) {
      const JointVector<Model::dof> q = data.joints(i);
      PoseAndParameterJacobian<Model::num_parameters> at;
      if (with_jacobian)
        at = pose_and_parameter_jacobian(model, q);
      else
        at.pose = model.pose(q);
      const auto& [pose, all] = at;
      residuals.segment<3>(3 * i) = (pose.translation() - data.position(i)) / position_sigma;
      Vector3 turned = Vector3::Zero();
      if (oriented) {
        turned = log_so3(pose.linear() * data.orientation(i).transpose());
        residuals.segment<3>(3 * (n + i)) = turned / orientation_sigma;
      }
      if (!with_jacobian) continue;
      for (Index k = 0; k < columns; ++k)
        jacobian.block<3, 1>(3 * i, k) =
            all.col(free[static_cast<std::size_t>(k)]).template head<3>() * (sizes(k) / position_sigma);
      if (!oriented) continue;
      const Matrix3 rate = left_jacobian_inverse_so3(turned) / orientation_sigma;
      for (Index k = 0; k < columns; ++k)
        jacobian.block<3, 1>(3 * (n + i), k) =
            rate * (all.col(free[static_cast<std::size_t>(k)]).template tail<3>() * sizes(k));
    }
  }

  /// model minus measured: |p| - distance, the fixed point being the origin of the model's base frame.
  template <ParametricModel Model>
  void evaluate(const Model& model, const Distances<Model::dof>& data, bool, double sigma, double,
                const std::vector<Index>& free, const VectorX& sizes, bool with_jacobian) {
    const Index n = data.size(), columns = static_cast<Index>(free.size());
    group = 1;
    residuals.resize(n);
    if (with_jacobian) jacobian.resize(n, columns);
    for (Index i = 0; i < n; ++i) {
      const JointVector<Model::dof> q = data.joints(i);
      const Vector3 p = model.position(q);
      residuals(i) = (p.norm() - data.length(i)) / sigma;
      if (!with_jacobian) continue;
      const auto all = model.parameter_jacobian(q);
      const Vector3 along = p.normalized() / sigma;
      for (Index k = 0; k < columns; ++k)
        jacobian(i, k) = along.dot(all.col(free[static_cast<std::size_t>(k)]).template head<3>()) * sizes(k);
    }
  }
};

}  // namespace vernier::detail
