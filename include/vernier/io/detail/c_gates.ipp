#pragma once

#include "vernier/io/detail/c_gates.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string_view c_gate_code() {
  return R"C(@if gates

/* The gate of one joint, and its slope. */
static inline double $_gate_of_joint_(const double *ranges, int count, double margin, int periodic, double q,
                                      double *slope) {
  const double turn = 6.2831853071795864769;
  double above = HUGE_VAL, below = HUGE_VAL, outside; /* distances to the nearest range on either side */
  int k;
  *slope = 0;
  if (count == 0) return 1;
  for (k = 0; k < count; ++k) {
    const double length = ranges[2 * k + 1] - ranges[2 * k], from_lower = q - ranges[2 * k];
    const double turned = periodic ? from_lower - turn * floor(from_lower / turn) : from_lower;
    const double up = periodic ? turn - turned : -turned;
    if (turned >= 0 && turned <= length) return 1;
    if (turned > length && turned - length < below) below = turned - length;
    if ((periodic || turned < 0) && up < above) above = up;
  }
  if (above + below <= 2 * margin) return 1;
  outside = (below < above ? below : above) / margin;
  if (!(outside < 1)) return 0;
  *slope = 6 * outside * (1 - outside) * (above < below ? 1 : -1) / margin;
  return 1 - outside * outside * (3 - 2 * outside);
}

/* The product of all, and where wanted its gradient. */
static inline double $_gate_at_(const $_coverage_ *coverage, const double *q, double *gradient) {
  double value[$$_JOINTS], slope[$$_JOINTS], product = 1;
  const double *ranges = coverage->ranges;
  int i, k;
  for (i = 0; i < $$_JOINTS; ++i) {
    value[i] =
        $_gate_of_joint_(ranges, coverage->count[i], coverage->margin[i], coverage->periodic[i], q[i], slope + i);
    ranges += 2 * coverage->count[i];
    product *= value[i];
  }
  for (k = 0; gradient && k < $$_JOINTS; ++k) {
    gradient[k] = slope[k];
    for (i = 0; i < $$_JOINTS; ++i)
      if (i != k) gradient[k] *= value[i];
  }
  return product;
}
@end
@if fallback

/* From `far` to `near` by the gate, the rotation along the geodesic; `far` and its Jacobian are overwritten. */
static inline void $_blend_(double gate, const double *slope, const double *near_frame, const double *near_J,
                            double *far_frame, double *far_J) {
  double between[9], phi[3], part[3], turn[9], inverse[9], left[9], apart[3], v[3], rotated[9];
  int j, k;
  $_between_(near_frame, far_frame, between);
  $_log_(between, phi);
  for (j = 0; j < 3; ++j) {
    part[j] = gate * phi[j];
    apart[j] = near_frame[9 + j] - far_frame[9 + j];
  }
  $_exp_(part, turn);
  if (near_J && far_J) {
    $_left_inverse_(phi, inverse);
    $_left_(part, left);
    for (k = 0; k < $$_JOINTS; ++k) {
      double *linear = far_J + 6 * k, *angular = linear + 3;
      for (j = 0; j < 3; ++j) linear[j] += gate * (near_J[6 * k + j] - linear[j]) + apart[j] * slope[k];
      $_rotate_(between, angular, v);
      for (j = 0; j < 3; ++j) v[j] = near_J[6 * k + 3 + j] - v[j];
      $_rotate_(inverse, v, v);
      for (j = 0; j < 3; ++j) v[j] = gate * v[j] + phi[j] * slope[k];
      $_rotate_(left, v, v);
      $_rotate_(turn, angular, angular);
      for (j = 0; j < 3; ++j) angular[j] += v[j];
    }
  }
  $_product_(turn, far_frame, rotated);
  for (j = 0; j < 9; ++j) far_frame[j] = rotated[j];
  for (j = 0; j < 3; ++j) far_frame[9 + j] += gate * apart[j];
}
@end
)C";
}

VERNIER_IMPL std::string_view c_learned_code() {
  return R"C(@if learned

static inline void $_accumulate_(int first, double factor, const double *terms, double *sums) {
  int j;
  if (first)
    for (j = 0; j < $$_FEATURES_; ++j) sums[j] = factor * terms[j];
  else
    for (j = 0; j < $$_FEATURES_; ++j) sums[j] += factor * terms[j];
}

/* The learned position error, and its derivative as columns of three; 0 for none. */
static inline void $_learned_(const double *q, double *y, double *slope) {
  double x[$$_FEATURES_], gradient[3 * $$_FEATURES_];
  int i, j, k, o;
@if sines
  double c[$$_JOINTS], s[$$_JOINTS];
  for (i = 0; i < $$_JOINTS; ++i) {
    c[i] = cos(q[i]);
    s[i] = sin(q[i]);
  }
@end
@if map_raw
  for (i = 0; i < $$_JOINTS; ++i) x[i] = q[i];
@end
@if map_sines_and_cosines
  for (i = 0; i < $$_JOINTS; ++i) {
    x[i] = s[i];
    x[$$_JOINTS + i] = c[i];
  }
@end
@if map_products
  for (i = $$_JOINTS - 1, k = 0; i >= 0; --i)
    for (o = 0; o < 2; ++o) {
      const double factor = o ? c[i] : s[i];
      x[k++] = factor;
      for (j = $$_JOINTS - 1; j > i; --j) {
        x[k++] = factor * s[j];
        x[k++] = factor * c[j];
      }
    }
@end
  for (j = 0; j < $$_FEATURES_; ++j) x[j] = (x[j] - $_feature_offset_[j]) * $_feature_factor_[j];
  for (o = 0; o < 3; ++o) y[o] = $_output_offset_[o];
  for (k = 0; k < $$_NODES_; ++k) { /* weights, bias, three output weights */
    const double *w = $_nodes_ + k * ($$_FEATURES_ + 4), bias = w[$$_FEATURES_], *beta = w + $$_FEATURES_ + 1;
    double z = 0, dz;
@if radial_basis
    double apart[$$_FEATURES_];
    for (j = 0; j < $$_FEATURES_; ++j) {
      apart[j] = x[j] - w[j];
      z += apart[j] * apart[j];
    }
    z = exp(-bias * bias * z);
    dz = -2 * bias * bias * z;
    w = apart;
@end
@if !radial_basis
    for (j = 0; j < $$_FEATURES_; ++j) z += w[j] * x[j];
    z += bias;
@end
@if sigmoid
    z = 1 / (1 + exp(-z));
    dz = z * (1 - z);
@end
@if tanh
    z = tanh(z);
    dz = 1 - z * z;
@end
@if sine
    dz = cos(z);
    z = sin(z);
@end
    for (o = 0; o < 3; ++o) {
      y[o] += beta[o] * z;
      if (slope) $_accumulate_(k == 0, beta[o] * dz, w, gradient + o * $$_FEATURES_);
    }
  }
  if (!slope) return;
  for (o = 0; o < 3; ++o) {
    double *g = gradient + o * $$_FEATURES_;
    for (j = 0; j < $$_FEATURES_; ++j) g[j] *= $_feature_factor_[j];
@if map_raw
    for (i = 0; i < $$_JOINTS; ++i) slope[3 * i + o] = g[i];
@end
@if map_sines_and_cosines
    for (i = 0; i < $$_JOINTS; ++i) slope[3 * i + o] = g[i] * c[i] - g[$$_JOINTS + i] * s[i];
@end
@if map_products
    for (i = $$_JOINTS - 1; i >= 0; --i) {
      double sum = 0;
      for (k = 0; k < 2; ++k) {
        const double factor = k ? c[i] : s[i], rate = k ? -s[i] : c[i];
        double of_rate = *g++;
        for (j = $$_JOINTS - 1; j > i; --j, g += 2) {
          of_rate += g[0] * s[j] + g[1] * c[j];
          slope[3 * j + o] += factor * (g[0] * c[j] - g[1] * s[j]);
        }
        sum += of_rate * rate;
      }
      slope[3 * i + o] = sum;
    }
@end
  }
}
@end
)C";
}

}  // namespace vernier::detail
