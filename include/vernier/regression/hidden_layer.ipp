// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier {

VERNIER_IMPL Box HiddenLayer::box(int inputs) const {
  return Box::cube(dimension(inputs), -weight_limit, weight_limit);
}

VERNIER_IMPL void HiddenLayer::validate(const char* caller) const {
  demand(nodes >= 1, caller, ": hidden_nodes is ", nodes, ", must be at least 1");
  demand(weight_limit > 0 && weight_limit < 1e6, caller, ": weight_limit is ", weight_limit,
         ", must be positive and below 1e6");
}

VERNIER_IMPL VectorX HiddenLayer::draw(int inputs, std::uint64_t seed) const {
  Rng rng(seed);
  VectorX theta(dimension(inputs));
  for (auto& value : theta) value = rng.uniform(-weight_limit, weight_limit);
  return theta;
}

VERNIER_IMPL MatrixX HiddenLayer::map(const ConstMatrixRef& inputs) const {
  if (input_map == InputMap::raw) return inputs;
  const Index n = inputs.cols();
  MatrixX out(inputs.rows(), features(static_cast<int>(n)));
  if (input_map == InputMap::sines_and_cosines) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < out.rows(); ++i) {
        out(i, j) = std::sin(inputs(i, j));
        out(i, n + j) = std::cos(inputs(i, j));
      }
    return out;
  }
  demand(n <= detail::max_inputs_of_products, "InputMap::sine_cosine_products: ", n, " inputs, must be at most ",
         detail::max_inputs_of_products);
  VectorX features(out.cols()), sine(n), cosine(n);
  for (Index i = 0; i < out.rows(); ++i) {
    const VectorX x = detail::row_of(inputs, i);
    detail::map_inputs(input_map, x.data(), n, features.data(), sine.data(), cosine.data());
    for (Index j = 0; j < out.cols(); ++j) out(i, j) = features(j);
  }
  return out;
}

VERNIER_IMPL ColumnScaling HiddenLayer::scaling(const ConstMatrixRef& mapped) const {
  return ColumnScaling::fit(mapped, input_map == InputMap::sines_and_cosines ? Scaling::none : input_scaling);
}

VERNIER_IMPL void HiddenLayer::outputs(const ConstMatrixRef& features, const ConstVectorRef& theta,
                                       MatrixX& out) const {
  const Index f = features.cols();
  const Eigen::Map<const MatrixX, 0, Eigen::OuterStride<>> weights(theta.data(), f, nodes, Eigen::OuterStride<>(f + 1));
  out.resize(features.rows(), nodes);
  if (activation == Activation::radial_basis) {
    for (Index k = 0; k < nodes; ++k) {
      const double inverse_width = theta(k * (f + 1) + f), factor = -inverse_width * inverse_width;
      VERNIER_LATER(out).col(k).setZero();
      for (Index j = 0; j < f; ++j)
        VERNIER_LATER(out).col(k) +=
            factor * (VERNIER_LATER(features).col(j) - VectorX::Constant(features.rows(), weights(j, k))).cwiseAbs2();
      for (Index i = 0; i < out.rows(); ++i) out(i, k) = std::exp(out(i, k));  // zero far away, unlike Eigen's
    }
  } else {
    for (Index k = 0; k < nodes; ++k) VERNIER_LATER(out).col(k).setConstant(theta(k * (f + 1) + f));
    detail::add_product(out, features, weights);
  }
  auto values = VERNIER_LATER(out).array();
  switch (activation) {
    case Activation::sigmoid: values = values.logistic(); break;
    case Activation::tanh: values = values.tanh(); break;
    case Activation::sine: values = values.sin(); break;
    case Activation::radial_basis: break;
  }
}

}  // namespace vernier
