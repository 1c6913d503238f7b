#pragma once

// Derivatives of a pose by dual numbers: every joint and parameter carries its own infinitesimal part.

#include <ceres/jet.h>

#include "vernier/kinematics/concepts.hpp"

namespace vernier_test {

template <class Model>
struct DualDerivatives {
  vernier::Isometry3 pose;
  vernier::Jacobian<Model::dof> joints;
  vernier::ParameterJacobian<Model::num_parameters> parameters;
};

/// Pose and derivatives of `pose(q, p)`; the angular rate is read off `dR R'`.
template <class Model>
DualDerivatives<Model> dual_derivatives(const Model& model, const vernier::JointVector<Model::dof>& q) {
  constexpr int N = Model::dof, P = Model::num_parameters;
  using Jet = ceres::Jet<double, N + P>;
  const Eigen::Matrix<double, P, 1> p = model.parameters();
  Eigen::Matrix<Jet, N, 1> joints;
  Eigen::Matrix<Jet, P, 1> parameters;
  for (int i = 0; i < N; ++i) joints(i) = Jet(q(i), i);
  for (int k = 0; k < P; ++k) parameters(k) = Jet(p(k), N + k);
  const vernier::IsometryOf<Jet> dual = model.template pose<Jet>(joints, parameters);

  DualDerivatives<Model> out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out.pose.matrix()(i, j) = dual.matrix()(i, j).a;
  for (int k = 0; k < N + P; ++k) {
    vernier::Matrix3 rate;
    vernier::Vector6 column;
    for (int i = 0; i < 3; ++i) {
      column(i) = dual.matrix()(i, 3).v(k);
      for (int j = 0; j < 3; ++j) rate(i, j) = dual.matrix()(i, j).v(k);
    }
    const vernier::Matrix3 w = rate * out.pose.linear().transpose();
    column.tail<3>() << (w(2, 1) - w(1, 2)) / 2, (w(0, 2) - w(2, 0)) / 2, (w(1, 0) - w(0, 1)) / 2;
    if (k < N) {
      out.joints.col(k) = column;
    } else {
      out.parameters.col(k - N) = column;
    }
  }
  return out;
}

}  // namespace vernier_test
