// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "vernier/core/same_value.hpp"

#include "vernier/error_model/joint_spectrum.hpp"

namespace vernier {

namespace detail {

/// A symmetric matrix of the cosine and sine of a harmonic.
struct HarmonicMatrix {
  double cc, cs, ss;

  double determinant() const { return cc * ss - cs * cs; }
  HarmonicMatrix inverse() const { return {ss / determinant(), -cs / determinant(), cc / determinant()}; }
  std::array<double, 2> operator*(const std::array<double, 2>& x) const {
    return {cc * x[0] + cs * x[1], cs * x[0] + ss * x[1]};
  }
  /// x' M x
  double square(const std::array<double, 2>& x) const {
    const auto product = *this * x;
    return x[0] * product[0] + x[1] * product[1];
  }
};

}  // namespace detail

VERNIER_IMPL std::vector<HarmonicEstimate> joint_spectrum(const ErrorModelEstimate& estimate, int joint) {
  std::vector<HarmonicEstimate> out;
  const JointTerms& terms = estimate.arm.terms();
  const Fourier& fourier = terms.transmission[static_cast<std::size_t>(joint)];
  const Index geometric = static_cast<Index>(estimate.arm.geometric().size());
  const VectorX steps = estimate.arm.steps(), precisions = estimate.arm.precisions(), scales = estimate.arm.scales();
  for (Index k = 0; k < fourier.size(); k += 2) {
    const Index at = geometric + terms.transmission_begin(joint) + k;
    // what the measurements say of the two: posterior less prior
    const auto covariance = [&](Index r, Index c) {
      return estimate.covariance(at + r, at + c) / estimate.variance_factor;
    };
    const auto posterior = detail::HarmonicMatrix{covariance(0, 0), covariance(0, 1), covariance(1, 1)}.inverse();
    const detail::HarmonicMatrix information{posterior.cc - precisions(at), posterior.cs,
                                             posterior.ss - precisions(at + 1)};
    const double determinant = information.determinant(), trace = information.cc + information.ss;
    if (!(trace > 0 && determinant > 1e-9 * trace * trace)) continue;
    const auto value = VERNIER_LATER(information).inverse() * (posterior * std::array{steps(at), steps(at + 1)});
    const double norm = std::hypot(value[0], value[1]), scale = scales(at);
    if (!(norm > 0)) continue;
    const std::array direction{value[0] / norm, value[1] / norm};
    out.push_back(
        {fourier.order(k), scale * norm,
         scale * std::sqrt(estimate.residual_variance * VERNIER_LATER(information).inverse().square(direction)),
         information.square(value) / estimate.residual_variance});
  }
  return out;
}

VERNIER_IMPL double line_threshold(Index trials) {
  return 2 * std::log(100 * static_cast<double>(std::max<Index>(trials, 1)));
}

VERNIER_IMPL std::vector<HarmonicEstimate> lines_in(const std::vector<HarmonicEstimate>& spectrum, double threshold) {
  std::vector<HarmonicEstimate> sorted, out;
  for (const HarmonicEstimate& one : spectrum)
    if (one.chi_square > threshold) sorted.push_back(one);
  std::sort(sorted.begin(), sorted.end(), [](const HarmonicEstimate& a, const HarmonicEstimate& b) {
    return a.amplitude > b.amplitude || (same_value(a.amplitude, b.amplitude) && a.order < b.order);
  });
  for (const HarmonicEstimate& one : sorted) {
    const bool beside = std::any_of(out.begin(), out.end(), [&](const HarmonicEstimate& line) {
      return std::abs(line.order - one.order) <= (std::min)(4, one.order / 4);
    });
    if (!beside) out.push_back(one);
  }
  return out;
}

}  // namespace vernier
