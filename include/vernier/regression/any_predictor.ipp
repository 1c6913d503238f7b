// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/regression/any_predictor.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL ElmFitness RunTimeFit::objective(const Elm& recipe, const ConstMatrixRef& inputs,
                                              const ConstMatrixRef& targets, const VectorX* weights) {
  recipe.validate();
  check_samples("Elm", inputs, targets, weights);
  return recipe.fitness(inputs, targets, weights);
}
VERNIER_IMPL RidgeElmLeaveOneOutError RunTimeFit::objective(const RidgeElm& recipe, const ConstMatrixRef& inputs,
                                                            const ConstMatrixRef& targets, const VectorX* weights) {
  recipe.layer().validate("RidgeElm");
  check_samples("RidgeElm", inputs, targets, weights);
  return recipe.leave_one_out_error(inputs, targets, weights);
}
VERNIER_IMPL VarProTrainingError RunTimeFit::objective(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                                       const ConstMatrixRef& targets, const VectorX* weights) {
  recipe.validate();
  check_samples("VarProElm", inputs, targets, weights);
  return recipe.training_error(inputs, targets, weights);
}

VERNIER_IMPL FittedNetwork RunTimeFit::at(const Elm& recipe, const ConstMatrixRef& inputs,
                                          const ConstMatrixRef& targets, const VectorX& theta,
                                          const FitOptions& options) {
  recipe.validate();
  check_samples("Elm", inputs, targets, options.weights);
  return recipe.solve(inputs, targets, theta, options);
}
VERNIER_IMPL FittedNetwork RunTimeFit::at(const RidgeElm& recipe, const ConstMatrixRef& inputs,
                                          const ConstMatrixRef& targets, const VectorX& theta,
                                          const FitOptions& options) {
  recipe.layer().validate("RidgeElm");
  check_samples("RidgeElm", inputs, targets, options.weights);
  return recipe.solve(inputs, targets, theta, options);
}
VERNIER_IMPL FittedNetwork RunTimeFit::at(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                          const ConstMatrixRef& targets, const VectorX& theta,
                                          const FitOptions& options) {
  recipe.validate();
  check_samples("VarProElm", inputs, targets, options.weights);
  return recipe.train(inputs, targets, &theta, options);
}
VERNIER_IMPL FittedNetwork RunTimeFit::drawn(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                             const ConstMatrixRef& targets, const FitOptions& options) {
  recipe.validate();
  check_samples("VarProElm", inputs, targets, options.weights);
  return recipe.train(inputs, targets, nullptr, options);
}
VERNIER_IMPL FittedKernels RunTimeFit::kernels(const KernelElm& recipe, const ConstMatrixRef& inputs,
                                               const ConstMatrixRef& targets, const FitOptions& options) {
  check_samples("KernelElm", inputs, targets, options.weights);
  return recipe.solve(inputs, targets, options);
}
VERNIER_IMPL FittedProcess RunTimeFit::process(const GaussianProcess& recipe, const ConstMatrixRef& inputs,
                                               const ConstMatrixRef& targets, const FitOptions& options) {
  check_samples("GaussianProcess", inputs, targets, options.weights);
  return recipe.solve(inputs, targets, options);
}

}  // namespace detail

namespace detail {

/// Kernels as functions of nodes.
VERNIER_LOCAL NodeFunction node_function(Kernel kernel) {
  return kernel == Kernel::squared_exponential ? NodeFunction::squared_exponential : NodeFunction::matern_5_2;
}

/// The sum of nodes of parts.
VERNIER_LOCAL NodeSum node_sum_of(const PredictorParts& parts) {
  demand(parts.inputs >= 1 && parts.inputs <= 1000000 && parts.node_function >= 0 &&
             parts.node_function <= static_cast<int>(NodeFunction::matern_5_2) && parts.input_map >= 0 &&
             parts.input_map <= static_cast<int>(InputMap::sine_cosine_products),
         "AnyPredictor: unknown functions of ", parts.inputs, " inputs");
  const auto map = static_cast<InputMap>(parts.input_map);
  demand(map != InputMap::sine_cosine_products || parts.inputs <= max_inputs_of_products, "AnyPredictor: products of ",
         parts.inputs, " inputs");
  const Index f = feature_count(map, static_cast<int>(parts.inputs)), n = parts.coefficients.rows();
  demand(n >= 1 && parts.nodes.size() == n * (f + 1) && parts.scaling.offset.size() == f &&
             parts.scaling.factor.size() == f && parts.offset.size() == parts.coefficients.cols(),
         "AnyPredictor: ", n, " nodes of ", f, " features do not fit ", parts.nodes.size(), " weights, ",
         parts.scaling.offset.size(), " scales and ", parts.offset.size(), " offsets");
  MatrixX weights(f, n);
  VectorX biases(n);
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < f; ++j) weights(j, k) = parts.nodes(k * (f + 1) + j);
    biases(k) = parts.nodes(k * (f + 1) + f);
  }
  return {static_cast<NodeFunction>(parts.node_function),
          map,
          static_cast<int>(parts.inputs),
          parts.scaling,
          weights,
          biases,
          parts.coefficients,
          parts.offset};
}

}  // namespace detail

VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedNetwork& network, Index inputs)
    : inputs_(inputs),
      function_(static_cast<detail::NodeFunction>(network.layer.activation)),  // the first four of them
      map_(network.layer.input_map),
      sum_(detail::node_sum_of(network, static_cast<int>(inputs))) {}
VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedKernels& kernels, Index inputs)
    : inputs_(inputs),
      function_(detail::node_function(kernels.kernel)),
      map_(kernels.input_map),
      sum_(detail::node_sum_of(kernels, static_cast<int>(inputs))) {}
VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedProcess& process, Index inputs)
    : AnyPredictor(process.kernels, inputs) {
  spread_.emplace(process.spread);
}
VERNIER_IMPL AnyPredictor::AnyPredictor(const PredictorParts& parts)
    : inputs_(parts.inputs),
      function_(static_cast<detail::NodeFunction>(parts.node_function)),
      map_(static_cast<InputMap>(parts.input_map)),
      sum_(detail::node_sum_of(parts)) {
  if (!parts.spread) return;
  spread_.emplace(*parts.spread);
  constexpr Index tile = detail::LowerInverseTiles::size;
  demand(spread_->padded_samples() == (nodes() + tile - 1) / tile * tile &&
             spread_->signal_deviation().size() == outputs(),
         "AnyPredictor: a spread of ", spread_->padded_samples(), " samples and ", spread_->signal_deviation().size(),
         " outputs for ", nodes(), " kernels and ", outputs(), " outputs");
}

VERNIER_IMPL PredictorParts AnyPredictor::parts() const {
  PredictorParts out{inputs_,
                     static_cast<int>(function_),
                     static_cast<int>(map_),
                     sum_.scaling(),
                     sum_.weights_and_biases(),
                     sum_.coefficients(),
                     sum_.offset(),
                     {}};
  if (spread_) out.spread = spread_->parts();
  return out;
}

VERNIER_IMPL void AnyPredictor::check(Index columns) const {
  demand(columns == inputs_, "AnyPredictor: samples of ", columns, " inputs, it was fitted to ", inputs_);
}

VERNIER_IMPL MatrixX AnyPredictor::predict(const ConstMatrixRef& samples) const {
  check(samples.cols());
  MatrixX out(samples.rows(), outputs());
  if (out.rows() > 0) sum_.evaluate_rows(samples, out);
  return out;
}

VERNIER_IMPL MatrixX AnyPredictor::derivative(const ConstVectorRef& sample) const {
  check(sample.size());
  const VectorX x = sample;
  VectorX y(outputs());
  MatrixX out(outputs(), inputs_);
  std::vector<double> workspace(static_cast<std::size_t>(detail::NodeSum::workspace(static_cast<int>(inputs_))));
  sum_.evaluate(x.data(), y.data(), out.data(), workspace.data());
  return out;
}

VERNIER_IMPL MatrixX AnyPredictor::standard_deviations(const ConstMatrixRef& samples) const {
  check(samples.cols());
  demand(uncertain(), "AnyPredictor: this one has no standard deviations, a Gaussian process has");
  MatrixX out(samples.rows(), outputs());
  VectorX x(inputs_), deviations(outputs());
  std::vector<double> workspace(static_cast<std::size_t>(detail::NodeSum::workspace(static_cast<int>(inputs_))));
  for (Index i = 0; i < samples.rows(); ++i) {
    for (Index k = 0; k < inputs_; ++k) x(k) = samples(i, k);
    spread_->standard_deviation(sum_, x.data(), deviations.data(), workspace.data());
    for (Index o = 0; o < outputs(); ++o) out(i, o) = deviations(o);
  }
  return out;
}

VERNIER_IMPL AnyPredictor fit_any(const Elm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                  const FitOptions& options) {
  recipe.layer().validate("Elm");
  const VectorX theta = recipe.layer().draw(static_cast<int>(inputs.cols()), options.seed);
  return {detail::RunTimeFit::at(recipe, inputs, targets, theta, options), inputs.cols()};
}
VERNIER_IMPL AnyPredictor fit_any(const RidgeElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                  const FitOptions& options) {
  recipe.layer().validate("RidgeElm");
  const VectorX theta = recipe.layer().draw(static_cast<int>(inputs.cols()), options.seed);
  return {detail::RunTimeFit::at(recipe, inputs, targets, theta, options), inputs.cols()};
}
VERNIER_IMPL AnyPredictor fit_any(const VarProElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                  const FitOptions& options) {
  return {detail::RunTimeFit::drawn(recipe, inputs, targets, options), inputs.cols()};
}
VERNIER_IMPL AnyPredictor fit_any(const KernelElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                  const FitOptions& options) {
  return {detail::RunTimeFit::kernels(recipe, inputs, targets, options), inputs.cols()};
}
VERNIER_IMPL AnyPredictor fit_any(const GaussianProcess& recipe, const ConstMatrixRef& inputs,
                                  const ConstMatrixRef& targets, const FitOptions& options) {
  return {detail::RunTimeFit::process(recipe, inputs, targets, options), inputs.cols()};
}

}  // namespace vernier
