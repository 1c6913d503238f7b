#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/regression/input_map.hpp"
#include "vernier/regression/trigonometric_predictor.hpp"

namespace vernier::detail {

inline constexpr Index max_trigonometric_inputs = 9;

VERNIER_IMPL void trigonometric_features(const double* x, Index n, double* out) noexcept {
  double sine[max_trigonometric_inputs], cosine[max_trigonometric_inputs];
  sines_and_cosines_of(x, n, sine, cosine);
  out[0] = 1;
  Index size = 1;
  for (Index j = n - 1; j >= 0; --j, size *= 3)
    for (Index f = 0; f < size; ++f) {
      out[size + f] = sine[j] * out[f];
      out[2 * size + f] = cosine[j] * out[f];
    }
}

VERNIER_IMPL TrigonometricSum::TrigonometricSum(int inputs, const ConstMatrixRef& coefficients,
                                                TrigonometricSpread spread)
    : inputs_(inputs),
      coefficients_(coefficients),
      spread_(std::make_shared<const TrigonometricSpread>(std::move(spread))) {
  require(coefficients.rows() == power_of_three(inputs), "TrigonometricPredictor: ", coefficients.rows(),
          " rows of coefficients, expected ", power_of_three(inputs));
}

/// Sums out one input after the other, the first first: `T_0 + sin q T_1 + cos q T_2` of the thirds of what remains,
/// and with `cos q T_1 - sin q T_2` the derivative with respect to it, which is then summed out in the same way.
VERNIER_IMPL void TrigonometricSum::evaluate(const double* x, double* y, double* slope,
                                             double* workspace) const noexcept {
  using Part = Eigen::Map<Eigen::Array<double, Eigen::Dynamic, 1>>;
  using ConstPart = Eigen::Map<const Eigen::Array<double, Eigen::Dynamic, 1>>;
  double sine[max_trigonometric_inputs], cosine[max_trigonometric_inputs];
  sines_and_cosines_of(x, inputs_, sine, cosine);
  const Index outputs = coefficients_.cols();
  double* const even = workspace;
  double* const odd = workspace + 2 * (coefficients_.rows() / 3) * outputs + outputs * (inputs_ + 1);
  const double* from = coefficients_.data();
  Index rest = coefficients_.size();
  for (Index j = 0; j < inputs_; ++j) {
    const Index third = rest / 3;
    double* to = j % 2 == 0 ? even : odd;
    // the value, and derivatives with respect to the inputs before
    const Index parts = slope != nullptr ? j + 1 : 1;
    for (Index p = 0; p < parts; ++p) {
      const ConstPart one(from + p * rest, third), s(one.data() + third, third), c(s.data() + third, third);
      Part(to + p * third, third) = one + sine[j] * s + cosine[j] * c;
    }
    if (slope != nullptr) {
      const ConstPart s(from + third, third), c(s.data() + third, third);
      Part(to + parts * third, third) = cosine[j] * s - sine[j] * c;
    }
    from = to;
    rest = third;
  }
  std::copy(from, from + outputs, y);
  if (slope != nullptr) std::copy(from + outputs, from + outputs * (inputs_ + 1), slope);
}

VERNIER_IMPL void TrigonometricSum::standard_deviation(const double* x, double* out, double* workspace) const noexcept {
  const TrigonometricSpread& s = *spread_;
  trigonometric_features(x, inputs_, workspace);
  Eigen::Map<VectorX> z(workspace, s.scale.size());
  for (Index f = 0; f < z.size(); ++f)  // in place: a feature's number is never below its place
    z(f) = workspace[s.features[static_cast<std::size_t>(f)]] * s.scale(f) - s.mean(f);
  double variance = s.mean_share, left = z.squaredNorm();
  for (Index k = 0; k < s.gain.size(); ++k) {
    const double along = s.directions.col(k).dot(z);
    variance += s.gain(k) * along * along;
    left -= along * along;
  }
  const double factor = std::sqrt(variance + s.rest * std::max(left, 0.0));
  for (Index o = 0; o < s.noise.size(); ++o) out[o] = s.noise(o) * factor;
}

}  // namespace vernier::detail
