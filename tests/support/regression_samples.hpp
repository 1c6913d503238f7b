#pragma once

// Samples of a smooth function, and every kind of hidden layer, for tests of regressors.

#include "vernier/core/rng.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier_test {

inline constexpr vernier::Activation activations[] = {vernier::Activation::sigmoid, vernier::Activation::tanh,
                                                      vernier::Activation::sine, vernier::Activation::radial_basis};
inline constexpr vernier::InputMap input_maps[] = {vernier::InputMap::raw, vernier::InputMap::sines_and_cosines};

using Inputs = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Targets = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Uniform in [-1.5, 1.5].
inline Inputs inputs(vernier::Index n, std::uint64_t seed) {
  vernier::Rng rng(seed);
  Inputs x(n, 3);
  for (auto& value : x.reshaped()) value = rng.uniform(-1.5, 1.5);
  return x;
}

/// Millimetres in metres, the first output far from zero, with normal noise.
inline Targets targets(const Inputs& x, double noise = 0) {
  vernier::Rng rng(99);
  Targets y(x.rows(), 2);
  y.col(0) = 1e-3 * (2 * x.col(0).array()).sin() * x.col(1).array() + 0.5;
  y.col(1) = 1e-3 * (x.col(2).array() - x.col(0).array()).cos();
  if (noise > 0)
    for (auto& value : y.reshaped()) value += noise * rng.normal();
  return y;
}

}  // namespace vernier_test
