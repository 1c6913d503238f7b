// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Maps of the inputs in front of a learner.

#include "vernier/core/types.hpp"

namespace vernier {

/// Features of the inputs that a learner is trained on.
enum class InputMap {
  raw,                ///< the inputs themselves
  sines_and_cosines,  ///< sines of all inputs, then cosines of all: for joint angles [rad]
  /// Sines and cosines of single inputs [rad] and all their products over two different inputs, 2 n^2 features of n
  /// inputs. They are ordered as the numbers whose digits to base 3, the first input's being the most significant one,
  /// are 0, 1 and 2 for no factor, the sine and the cosine.
  sine_cosine_products
};

namespace detail {

/// Number of features.
constexpr int feature_count(InputMap map, int inputs) {
  return map == InputMap::raw ? inputs : map == InputMap::sines_and_cosines ? 2 * inputs : 2 * inputs * inputs;
}

/// Products of more inputs than these are refused: predictors keep the features of a sample on the stack.
inline constexpr int max_inputs_of_products = 32;
/// Upper bound of the number of features, whatever the map.
constexpr int max_feature_count(int inputs) {
  return feature_count(inputs <= max_inputs_of_products ? InputMap::sine_cosine_products : InputMap::sines_and_cosines,
                       inputs);
}

/// Sines and cosines of n angles [rad], the same bits on every machine.
VERNIER_API void sines_and_cosines_of(const double* angles, Index n, double* sines, double* cosines) noexcept;

/// Features of one sample.
/// @param sine, cosine n each: those of the inputs, where the map has them
VERNIER_API void map_inputs(InputMap map, const double* x, Index n, double* features, double* sine,
                            double* cosine) noexcept;

/// The chain rule: adds `d features / d x` times a gradient with respect to the features.
/// @param gradient one value a feature
/// @param sine, cosine as `map_inputs` has them
/// @param out      entry i is `out[i * stride]`, added to
VERNIER_API void add_input_gradient(InputMap map, const double* gradient, const double* sine, const double* cosine,
                                    Index n, double* out, Index stride) noexcept;

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/input_map.ipp"
#endif
