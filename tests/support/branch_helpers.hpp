#pragma once

// Arms that differ a little from a nominal one, and joint values compared without whole turns.

#include <cmath>
#include <numbers>

#include "larger.hpp"
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
