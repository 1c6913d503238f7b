// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/simd.hpp"
#include "vernier/regression/input_map.hpp"

namespace vernier::detail {

VERNIER_IMPL void sines_and_cosines_of(const double* angles, Index n, double* sines, double* cosines) noexcept {
  constexpr Index block = 8;
  for (Index first = 0; first < n; first += block) {
    const Index count = (std::min)(block, n - first);
    double x[block] = {}, s[block], c[block];
    std::copy(angles + first, angles + first + count, x);
    sines_and_cosines<block>(x, s, c);
    std::copy(s, s + count, sines + first);
    std::copy(c, c + count, cosines + first);
  }
}

VERNIER_IMPL void map_inputs(InputMap map, const double* x, Index n, double* features, double* sine,
                             double* cosine) noexcept {
  if (map == InputMap::raw) {
    std::copy(x, x + n, features);
    return;
  }
  sines_and_cosines_of(x, n, sine, cosine);
  if (map == InputMap::sines_and_cosines) {
    std::copy(sine, sine + n, features);
    std::copy(cosine, cosine + n, features + n);
    return;
  }
  for (Index i = n - 1; i >= 0; --i)
    for (const double factor : {sine[i], cosine[i]}) {
      *features++ = factor;
      for (Index j = n - 1; j > i; --j) {
        *features++ = factor * sine[j];
        *features++ = factor * cosine[j];
      }
    }
}

VERNIER_IMPL void add_input_gradient(InputMap map, const double* gradient, const double* sine, const double* cosine,
                                     Index n, double* out, Index stride) noexcept {
  if (map == InputMap::raw) {
    for (Index i = 0; i < n; ++i) out[i * stride] += gradient[i];
    return;
  }
  if (map == InputMap::sines_and_cosines) {
    for (Index i = 0; i < n; ++i) out[i * stride] += gradient[i] * cosine[i] - gradient[n + i] * sine[i];
    return;
  }
  for (Index i = n - 1; i >= 0; --i)
    for (const bool is_cosine : {false, true}) {
      const double factor = is_cosine ? cosine[i] : sine[i], slope = is_cosine ? -sine[i] : cosine[i];
      double of_slope = *gradient++;  // what the slope of the factor is multiplied by
      for (Index j = n - 1; j > i; --j, gradient += 2) {
        of_slope += gradient[0] * sine[j] + gradient[1] * cosine[j];
        out[j * stride] += factor * (gradient[0] * cosine[j] - gradient[1] * sine[j]);
      }
      out[i * stride] += of_slope * slope;
    }
}

}  // namespace vernier::detail
