#pragma once

/// @file
/// Weighted residuals of a model against data, and their Jacobian: the one place where a measurement meets a model.

#include <algorithm>
#include <cmath>
#include <utility>
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
    const Index n = data.size();
    group = 3;
    resize((oriented ? 6 : 3) * n, free, with_jacobian);
    visit(model, data.joints(), with_jacobian, [&](Index first, const auto& at) {
      const Index count = static_cast<Index>(at.poses.size());
      for (Index k = 0; with_jacobian && k < jacobian.cols(); ++k) {
        const double* entries = at.jacobians.data() + 6 * free[static_cast<std::size_t>(k)] * count;
        double* out = &jacobian(3 * first, k);
        const double scale = sizes(k) / position_sigma;
        for (Index i = 0; i < count; ++i)
          for (Index r = 0; r < 3; ++r) out[3 * i + r] = entries[r * count + i] * scale;
      }
      for (Index i = 0; i < count; ++i) {
        const Isometry3& pose = at.poses[static_cast<std::size_t>(i)];
        const Index row = first + i;
        residuals.segment<3>(3 * row) = (pose.translation() - data.position(row)) / position_sigma;
        if (!oriented) continue;
        const Vector3 turned = log_so3(pose.linear() * data.orientation(row).transpose());
        residuals.segment<3>(3 * (n + row)) = turned / orientation_sigma;
        if (!with_jacobian) continue;
        const Matrix3 rate = left_jacobian_inverse_so3(turned) / orientation_sigma;
        for (Index k = 0; k < jacobian.cols(); ++k) {
          const Index column = 6 * free[static_cast<std::size_t>(k)];
          jacobian.block<3, 1>(3 * (n + row), k) =
              rate * (at.jacobians.template block<1, 3>(i, column + 3).transpose() * sizes(k));
        }
      }
    });
  }

  /// model minus measured: |p| - distance, the fixed point being the origin of the model's base frame.
  template <ParametricModel Model>
  void evaluate(const Model& model, const Distances<Model::dof>& data, bool, double sigma, double,
                const std::vector<Index>& free, const VectorX& sizes, bool with_jacobian) {
    group = 1;
    resize(data.size(), free, with_jacobian);
    visit(model, data.joints(), with_jacobian, [&](Index first, const auto& at) {
      for (Index i = 0; i < static_cast<Index>(at.poses.size()); ++i) {
        const Vector3 p = at.poses[static_cast<std::size_t>(i)].translation();
        residuals(first + i) = (p.norm() - data.length(first + i)) / sigma;
        const Vector3 along = p.normalized() / sigma;
        for (Index k = 0; with_jacobian && k < jacobian.cols(); ++k)
          jacobian(first + i, k) =
              at.jacobians.template block<1, 3>(i, 6 * free[static_cast<std::size_t>(k)]).dot(along) * sizes(k);
      }
    });
  }

 private:
  void resize(Index rows, const std::vector<Index>& free, bool with_jacobian) {
    residuals.resize(rows);
    if (with_jacobian) jacobian.resize(rows, static_cast<Index>(free.size()));
  }

  /// Poses, with derivatives where they are asked for, of a few configurations at a time: `use(first row, poses)`. So
  /// few, that all their derivatives stay in the cache.
  template <ParametricModel Model, class Use>
  static void visit(const Model& model, const JointRows<Model::dof>& joints, bool with_jacobian, const Use& use) {
    PosesAndJacobians<Model::num_parameters> at;
    constexpr Index few = 24;
    for (Index first = 0; first < joints.rows(); first += few) {
      const JointRows<Model::dof> q = joints.middleRows(first, std::min(few, joints.rows() - first));
      if (with_jacobian)
        at = poses_and_parameter_jacobians(model, q, std::move(at));
      else
        at.poses = poses(model, q);
      use(first, at);
    }
  }
};

}  // namespace vernier::detail
