// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Arms that differ a little from a nominal one, and joint values compared without whole turns.

#include <cmath>
#include <numbers>

#include "larger.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier_test {

/// An arm as made: a, d off by 0.5 mm, alpha by 1 mrad, theta by 2 mrad, beta by 0.5 mrad (standard deviations), times
/// a factor.
template <int N, class Convention>
vernier::DhChain<N, Convention> as_made(const vernier::DhChain<N, Convention>& nominal, vernier::Rng& rng,
                                        double factor = 1) {
  auto p = nominal.parameters();
  const double deviation[5] = {0.5e-3, 1e-3, 0.5e-3, 2e-3, 0.5e-3};
  for (int k = 0; k < 5 * N; ++k) p(k) += factor * deviation[k % 5] * rng.normal();
  return nominal.with_parameters(p);
}

/// A chain whose joints turn unevenly, as gears make them: no `DhChain` any more.
template <int N>
struct UnevenJoints {
  static constexpr int dof = N;
  vernier::DhChain<N> chain;
  double amplitude = 1e-3;  // rad

  vernier::JointVector<N> effective(const vernier::JointVector<N>& q) const noexcept {
    vernier::JointVector<N> out;
    for (int i = 0; i < N; ++i) out(i) = q(i) + amplitude * std::sin(2 * q(i) + i);
    return out;
  }
  vernier::Isometry3 pose(const vernier::JointVector<N>& q) const noexcept { return chain.pose(effective(q)); }
  vernier::Vector3 position(const vernier::JointVector<N>& q) const noexcept { return vernier::translation(pose(q)); }
  vernier::Jacobian<N> jacobian(const vernier::JointVector<N>& q) const noexcept {
    return pose_and_jacobian(q).jacobian;
  }
  vernier::PoseAndJacobian<N> pose_and_jacobian(const vernier::JointVector<N>& q) const noexcept {
    vernier::PoseAndJacobian<N> out = chain.pose_and_jacobian(effective(q));
    for (int i = 0; i < N; ++i) {
      const double slope = 1 + 2 * amplitude * std::cos(2 * q(i) + i);
      for (int row = 0; row < 6; ++row) out.jacobian(row, i) *= slope;
    }
    return out;
  }
};

/// Difference of two angles without whole turns, in [-pi, pi].
inline double without_turns(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

/// Largest difference of joint values, whole turns aside.
template <int N>
double joint_difference(const vernier::JointVector<N>& a, const vernier::JointVector<N>& b) {
  double largest = 0;
  for (int i = 0; i < N; ++i) largest = vernier_test::larger(largest, std::abs(without_turns(a(i) - b(i))));
  return largest;
}

/// Euclidean difference of joint values, whole turns aside.
template <int N>
double joint_distance(const vernier::JointVector<N>& a, const vernier::JointVector<N>& b) {
  double square = 0;
  for (int i = 0; i < N; ++i) square += std::pow(without_turns(a(i) - b(i)), 2);
  return std::sqrt(square);
}

}  // namespace vernier_test
