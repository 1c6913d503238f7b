#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vernier/error_model/joint_spectrum.hpp"

namespace vernier {

VERNIER_IMPL std::vector<HarmonicEstimate> joint_spectrum(const ErrorModelEstimate& estimate, int joint) {
  using Matrix2 = Eigen::Matrix2d;
  using Vector2 = Eigen::Vector2d;
  std::vector<HarmonicEstimate> out;
  const JointTerms& terms = estimate.arm.terms();
  const Fourier& fourier = terms.transmission[static_cast<std::size_t>(joint)];
  const Index geometric = static_cast<Index>(estimate.arm.geometric().size());
  const VectorX steps = estimate.arm.steps(), precisions = estimate.arm.precisions(), scales = estimate.arm.scales();
  for (Index k = 0; k < fourier.size(); k += 2) {
    const Index at = geometric + terms.transmission_begin(joint) + k;
    // what the measurements say of the two: posterior less prior
    const Matrix2 posterior = (estimate.covariance.block<2, 2>(at, at) / estimate.variance_factor).inverse();
    const Matrix2 information = posterior - Matrix2(precisions.segment<2>(at).asDiagonal());
    const double determinant = information.determinant(), trace = information.trace();
    if (!(trace > 0 && determinant > 1e-9 * trace * trace)) continue;
    const Vector2 value = information.inverse() * (posterior * steps.segment<2>(at));
    const double norm = value.norm(), scale = scales(at);
    if (!(norm > 0)) continue;
    const Vector2 direction = value / norm;
    out.push_back({fourier.order(k), scale * norm,
                   scale * std::sqrt(estimate.residual_variance * direction.dot(information.inverse() * direction)),
                   value.dot(information * value) / estimate.residual_variance});
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
    return a.amplitude > b.amplitude || (a.amplitude == b.amplitude && a.order < b.order);
  });
  for (const HarmonicEstimate& one : sorted) {
    const bool beside = std::any_of(out.begin(), out.end(), [&](const HarmonicEstimate& line) {
      return std::abs(line.order - one.order) <= std::min(4, one.order / 4);
    });
    if (!beside) out.push_back(one);
  }
  return out;
}

}  // namespace vernier
