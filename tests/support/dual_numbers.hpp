// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Derivatives of a pose by dual numbers: every joint and parameter carries its own infinitesimal part.

#include <ceres/jet.h>

#include "real_matrix.hpp"
#include "vernier/kinematics/concepts.hpp"

namespace vernier_test {

struct DualDerivatives {
  vernier::Isometry3 pose;
  RealMatrix joints, parameters;  ///< linear and angular rates of each, one a column
};

/// Pose and derivatives of `pose(q, p)`, by one joint or parameter after the other: dual numbers with one infinitesimal
/// part are the same type for all models. The angular rate is read off `dR R'`.
template <class Model>
DualDerivatives dual_derivatives(const Model& model, const vernier::JointVector<Model::dof>& q) {
  constexpr int N = Model::dof, P = Model::num_parameters;
  using Dual = ceres::Jet<double, 1>;
  const Eigen::Matrix<double, P, 1> p = model.parameters();
  Eigen::Matrix<Dual, N, 1> joints;
  Eigen::Matrix<Dual, P, 1> parameters;
  for (int i = 0; i < N; ++i) joints(i) = Dual(q(i));
  for (int k = 0; k < P; ++k) parameters(k) = Dual(p(k));

  DualDerivatives out{{}, RealMatrix(6, N), RealMatrix(6, P)};
  for (int k = 0; k < N + P; ++k) {
    Dual& moved = k < N ? joints(k) : parameters(k - N);
    moved.v(0) = 1;
    const vernier::IsometryOf<Dual> pose = model.template pose<Dual>(joints, parameters);
    moved.v(0) = 0;
    RealMatrix rotation(3, 3), rate(3, 3), column(6, 1);
    for (int i = 0; i < 3; ++i) {
      column(i) = pose(i, 3).v(0);
      for (int j = 0; j < 3; ++j) {
        rotation(i, j) = pose(i, j).a;
        rate(i, j) = pose(i, j).v(0);
      }
    }
    const RealMatrix w = rate * rotation.transpose();
    column(3) = (w(2, 1) - w(1, 2)) / 2;
    column(4) = (w(0, 2) - w(2, 0)) / 2;
    column(5) = (w(1, 0) - w(0, 1)) / 2;
    if (k < N) {
      out.joints.set_block(0, k, column);
    } else {
      out.parameters.set_block(0, k - N, column);
    }
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) out.pose(i, j) = pose(i, j).a;
  }
  return out;
}

}  // namespace vernier_test
