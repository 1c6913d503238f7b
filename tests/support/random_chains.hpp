// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Random arms and joint values for tests.

#include <numbers>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier_test {

struct ChainOptions {
  double prismatic = 0.25;  ///< probability of a prismatic joint
  bool hayati = true;       ///< whether beta differs from zero
};

/// A random arm: lengths within 0.5 m, angles anywhere, beta within 0.2 rad.
template <int N, class Convention = vernier::StandardDh>
vernier::DhChain<N, Convention> random_chain(vernier::Rng& rng, const ChainOptions& options = {}) {
  constexpr double pi = std::numbers::pi;
  std::array<vernier::DhRow, N> rows;
  for (vernier::DhRow& row : rows) {
    row.a = rng.uniform(-0.5, 0.5);
    row.alpha = rng.uniform(-pi, pi);
    row.d = rng.uniform(-0.5, 0.5);
    row.theta = rng.uniform(-pi, pi);
    if (options.hayati) row.beta = rng.uniform(-0.2, 0.2);
    if (rng.uniform() < options.prismatic) row.joint = vernier::JointType::prismatic;
  }
  return vernier::DhChain<N, Convention>::from_rows(rows);
}

/// Joint values in [-range, range].
template <int N>
vernier::JointVector<N> random_joints(vernier::Rng& rng, double range = std::numbers::pi) {
  vernier::JointVector<N> q;
  for (int i = 0; i < N; ++i) q(i) = rng.uniform(-range, range);
  return q;
}

/// Joint values within limits.
template <int N>
vernier::JointVector<N> random_joints(vernier::Rng& rng, const vernier::JointLimits<N>& limits) {
  vernier::JointVector<N> q;
  for (int i = 0; i < N; ++i) q(i) = rng.uniform(limits.lower(i), limits.upper(i));
  return q;
}

/// n joint values in [-pi, pi], of a number that is no constant.
inline vernier::VectorX random_joint_values(vernier::Rng& rng, vernier::Index n) {
  vernier::VectorX q(n);
  for (double& x : q) x = rng.uniform(-std::numbers::pi, std::numbers::pi);
  return q;
}

/// Normal numbers with a standard deviation.
inline vernier::VectorX normals(vernier::Rng& rng, vernier::Index n, double size = 1) {
  vernier::VectorX out(n);
  for (double& x : out) x = size * rng.normal();
  return out;
}

/// Joint values with one of them moved.
template <int N>
vernier::JointVector<N> stepped(vernier::JointVector<N> q, int joint, double step) {
  q(joint) += step;
  return q;
}

/// n rows of joint values in [-range, range].
template <int N>
vernier::JointRows<N> random_joint_rows(vernier::Rng& rng, vernier::Index n, double range = std::numbers::pi) {
  vernier::JointRows<N> rows(n, N);
  for (vernier::Index i = 0; i < n; ++i) vernier::set_configuration<N>(rows, i, random_joints<N>(rng, range));
  return rows;
}

/// A direction, evenly distributed.
inline vernier::Vector3 random_direction(vernier::Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return vernier::Vector3(x, y, z).normalized();
}

}  // namespace vernier_test
