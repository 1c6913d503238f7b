#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier {

VERNIER_IMPL Box HiddenLayer::box(int inputs) const {
  return Box::cube(dimension(inputs), -weight_limit, weight_limit);
}

VERNIER_IMPL void HiddenLayer::validate(const char* caller) const {
  require(nodes >= 1, caller, ": hidden_nodes is ", nodes, ", must be at least 1");
  require(weight_limit > 0 && weight_limit < 1e6, caller, ": weight_limit is ", weight_limit,
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
    out << inputs.array().sin().matrix(), inputs.array().cos().matrix();
    return out;
  }
  require(n <= detail::max_inputs_of_products, "InputMap::sine_cosine_products: ", n, " inputs, must be at most ",
          detail::max_inputs_of_products);
  VectorX x(n), features(out.cols()), sine(n), cosine(n);
  for (Index i = 0; i < out.rows(); ++i) {
    x = inputs.row(i).transpose();
    detail::map_inputs(input_map, x.data(), n, features.data(), sine.data(), cosine.data());
    out.row(i) = features.transpose();
  }
  return out;
}

VERNIER_IMPL ColumnScaling HiddenLayer::scaling(const ConstMatrixRef& mapped) const {
  return ColumnScaling::fit(mapped, input_map == InputMap::sines_and_cosines ? Scaling::none : input_scaling);
}

VERNIER_IMPL void HiddenLayer::outputs(const ConstMatrixRef& features, const ConstVectorRef& theta,
                                       MatrixX& out) const {
  const Index f = features.cols();
  const Eigen::Map<const MatrixX> weights(theta.data(), f + 1, nodes);
  out.resize(features.rows(), nodes);
  if (activation == Activation::radial_basis) {
    for (Index k = 0; k < nodes; ++k) {
      const double inverse_width = weights(f, k);
      out.col(k) = (-inverse_width * inverse_width *
                    (features.rowwise() - weights.col(k).head(f).transpose()).rowwise().squaredNorm().array())
                       .exp()
                       .matrix();
    }
    return;
  }
  out.noalias() = features * weights.topRows(f);
  out.rowwise() += weights.row(f);
  switch (activation) {
    case Activation::sigmoid: out = (1 + (-out.array()).exp()).inverse().matrix(); break;
    case Activation::tanh: out = out.array().tanh().matrix(); break;
    case Activation::sine: out = out.array().sin().matrix(); break;
    case Activation::radial_basis: break;
  }
}

}  // namespace vernier
