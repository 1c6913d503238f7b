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

VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedNetwork& network, Index inputs)
    : inputs_(inputs), sum_(detail::node_sum_of(network, static_cast<int>(inputs))) {}
VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedKernels& kernels, Index inputs)
    : inputs_(inputs), sum_(detail::node_sum_of(kernels, static_cast<int>(inputs))) {}
VERNIER_IMPL AnyPredictor::AnyPredictor(const detail::FittedProcess& process, Index inputs)
    : inputs_(inputs), sum_(detail::node_sum_of(process.kernels, static_cast<int>(inputs))), spread_(process.spread) {}

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
  const VectorX theta = recipe.layer().draw(static_cast<int>(inputs.cols()), options.seed);
  return {detail::RunTimeFit::at(recipe, inputs, targets, theta, options), inputs.cols()};
}
VERNIER_IMPL AnyPredictor fit_any(const RidgeElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                  const FitOptions& options) {
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
