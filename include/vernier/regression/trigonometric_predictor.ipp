// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/input_map.hpp"
#include "vernier/regression/trigonometric_predictor.hpp"

namespace vernier::detail {

VERNIER_IMPL void trigonometric_features(const double* x, Index n, double* out) noexcept {
  double sine[max_arm_joints], cosine[max_arm_joints];
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
  demand(coefficients.rows() == power_of_three(inputs), "TrigonometricPredictor: ", coefficients.rows(),
         " rows of coefficients, expected ", power_of_three(inputs));
}

/// `T_0 + sine T_1 + cosine T_2` of the thirds T of an array.
template <int W>
VERNIER_INLINE void sum_out(const double* thirds, double sine, double cosine, Index third, double* to) {
  typename Simd<W>::Double one, s, c;
  Index i = 0;
  for (; i + W <= third; i += W) {
    load<W>(one, thirds + i);
    load<W>(s, thirds + third + i);
    load<W>(c, thirds + 2 * third + i);
    one += sine * s;
    one += cosine * c;
    store<W>(to + i, one);
  }
  for (; i < third; ++i) to[i] = thirds[i] + sine * thirds[third + i] + cosine * thirds[2 * third + i];
}

/// `cosine T_1 - sine T_2`, its derivative with respect to the angle.
template <int W>
VERNIER_INLINE void differentiate(const double* thirds, double sine, double cosine, Index third, double* to) {
  typename Simd<W>::Double s, c;
  Index i = 0;
  for (; i + W <= third; i += W) {
    load<W>(s, thirds + third + i);
    load<W>(c, thirds + 2 * third + i);
    s *= cosine;
    s -= sine * c;
    store<W>(to + i, s);
  }
  for (; i < third; ++i) to[i] = cosine * thirds[third + i] - sine * thirds[2 * third + i];
}

/// Sums out one input after the other, the first first: `T_0 + sin q T_1 + cos q T_2` of the thirds of what remains,
/// and with `cos q T_1 - sin q T_2` the derivative with respect to it, which is then summed out in the same way.
VERNIER_IMPL void TrigonometricSum::evaluate(const double* x, double* y, double* slope,
                                             double* workspace) const noexcept {
  double sine[max_arm_joints], cosine[max_arm_joints];
  sines_and_cosines_of(x, inputs_, sine, cosine);
  const Index outputs = coefficients_.cols();
  double* const even = workspace;
  double* const odd = workspace + 2 * (coefficients_.rows() / 3) * outputs + outputs * (inputs_ + 1);
  const double* from = coefficients_.data();
  Index rest = coefficients_.size();
  run_same_bits([&]<int W>() VERNIER_INLINED {
    for (Index j = 0; j < inputs_; ++j) {
      const Index third = rest / 3;
      double* to = j % 2 == 0 ? even : odd;
      // the value, and derivatives with respect to the inputs before
      const Index parts = slope != nullptr ? j + 1 : 1;
      for (Index p = 0; p < parts; ++p) sum_out<W>(from + p * rest, sine[j], cosine[j], third, to + p * third);
      if (slope != nullptr) differentiate<W>(from, sine[j], cosine[j], third, to + parts * third);
      from = to;
      rest = third;
    }
  });
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
    const double along = VERNIER_LATER(s.directions).col(k).dot(z);
    variance += s.gain(k) * along * along;
    left -= along * along;
  }
  const double factor = std::sqrt(variance + s.rest * (std::max)(left, 0.0));
  for (Index o = 0; o < s.noise.size(); ++o) out[o] = s.noise(o) * factor;
}

}  // namespace vernier::detail
