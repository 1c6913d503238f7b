// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Recipes fitted to samples whose numbers of inputs and outputs are known at run time: compiled once for all of them.

#include <optional>

#include "vernier/regression/elm.hpp"
#include "vernier/regression/gaussian_process.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/var_pro_elm.hpp"

namespace vernier {

/// What an `AnyPredictor` is made of: to be saved, and made again to the same bits.
struct PredictorParts {
  Index inputs = 0;                             ///< their number
  int node_function = 0;                        ///< `detail::NodeFunction`
  int input_map = 0;                            ///< `InputMap`
  ColumnScaling scaling{};                      ///< of the features of the inputs
  VectorX nodes{};                              ///< w and b of each node, node by node
  MatrixX coefficients{};                       ///< nodes x outputs
  VectorX offset{};                             ///< one an output
  std::optional<detail::SpreadParts> spread{};  ///< of a Gaussian process
};

/// A fitted map whose numbers of inputs and outputs are known at run time. It predicts what the predictor of a fixed
/// size predicts, to the bit.
class AnyPredictor {
 public:
  /// A network.
  /// @param network as fitted
  /// @param inputs  their number
  VERNIER_API AnyPredictor(const detail::FittedNetwork& network, Index inputs);
  /// A sum of kernels.
  VERNIER_API AnyPredictor(const detail::FittedKernels& kernels, Index inputs);
  /// A Gaussian process, which has standard deviations.
  VERNIER_API AnyPredictor(const detail::FittedProcess& process, Index inputs);

  /// Of its parts.
  /// @throws std::invalid_argument for sizes that do not fit together
  VERNIER_API explicit AnyPredictor(const PredictorParts& parts);
  /// What it is made of.
  VERNIER_API PredictorParts parts() const;

  /// Number of inputs.
  Index inputs() const { return inputs_; }
  /// Number of outputs.
  Index outputs() const { return sum_.offset().size(); }
  /// Number of hidden nodes, or of kernels.
  Index nodes() const { return sum_.nodes(); }
  /// Whether it has standard deviations.
  bool uncertain() const { return spread_.has_value(); }

  /// Predictions of samples, n x inputs to n x outputs.
  /// @throws std::invalid_argument for another number of inputs
  VERNIER_API MatrixX predict(const ConstMatrixRef& samples) const;
  /// Derivative of the outputs at one sample, outputs x inputs.
  /// @throws std::invalid_argument for another number of inputs
  VERNIER_API MatrixX derivative(const ConstVectorRef& sample) const;
  /// Standard deviations of the predicted functions, n x outputs, without the noise of a new measurement.
  /// @throws std::invalid_argument for another number of inputs, or where there are none
  VERNIER_API MatrixX standard_deviations(const ConstMatrixRef& samples) const;

 private:
  VERNIER_API void check(Index columns) const;

  Index inputs_;
  detail::NodeFunction function_;
  InputMap map_;
  detail::NodeSum sum_;
  std::optional<detail::ProcessSpread> spread_{};
};

/// Fits a recipe to samples of any numbers of inputs and outputs, as its member `fit` does for fixed ones.
/// @param recipe  of the ELM family, of kernels, or a Gaussian process
/// @param inputs  n x inputs
/// @param targets n x outputs
/// @param options seed, executor, observer, weights
/// @throws std::invalid_argument for unusable samples, weights or options
VERNIER_API AnyPredictor fit_any(const Elm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                 const FitOptions& options = {});
/// A ridge ELM, fitted likewise.
VERNIER_API AnyPredictor fit_any(const RidgeElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                 const FitOptions& options = {});
/// A trained ELM, fitted likewise.
VERNIER_API AnyPredictor fit_any(const VarProElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                 const FitOptions& options = {});
/// A kernel ELM, fitted likewise.
VERNIER_API AnyPredictor fit_any(const KernelElm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                 const FitOptions& options = {});
/// A Gaussian process, fitted likewise.
VERNIER_API AnyPredictor fit_any(const GaussianProcess& recipe, const ConstMatrixRef& inputs,
                                 const ConstMatrixRef& targets, const FitOptions& options = {});

namespace detail {

/// The parts of recipes that know their numbers of columns at run time.
struct RunTimeFit {
  /// What a search of hidden weights minimises.
  VERNIER_API static ElmFitness objective(const Elm& recipe, const ConstMatrixRef& inputs,
                                          const ConstMatrixRef& targets, const VectorX* weights);
  /// Of a ridge ELM.
  VERNIER_API static RidgeElmLeaveOneOutError objective(const RidgeElm& recipe, const ConstMatrixRef& inputs,
                                                        const ConstMatrixRef& targets, const VectorX* weights);
  /// Of a trained ELM, where the training starts.
  VERNIER_API static VarProTrainingError objective(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                                   const ConstMatrixRef& targets, const VectorX* weights);
  /// The network at given hidden weights.
  VERNIER_API static FittedNetwork at(const Elm& recipe, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                      const VectorX& theta, const FitOptions& options);
  /// A ridge ELM at given hidden weights.
  VERNIER_API static FittedNetwork at(const RidgeElm& recipe, const ConstMatrixRef& inputs,
                                      const ConstMatrixRef& targets, const VectorX& theta, const FitOptions& options);
  /// A trained ELM that starts from given hidden weights.
  VERNIER_API static FittedNetwork at(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                      const ConstMatrixRef& targets, const VectorX& theta, const FitOptions& options);
  /// A trained ELM that starts from hidden weights drawn from the seed.
  VERNIER_API static FittedNetwork drawn(const VarProElm& recipe, const ConstMatrixRef& inputs,
                                         const ConstMatrixRef& targets, const FitOptions& options);
  /// Kernels.
  VERNIER_API static FittedKernels kernels(const KernelElm& recipe, const ConstMatrixRef& inputs,
                                           const ConstMatrixRef& targets, const FitOptions& options);
  /// A Gaussian process.
  VERNIER_API static FittedProcess process(const GaussianProcess& recipe, const ConstMatrixRef& inputs,
                                           const ConstMatrixRef& targets, const FitOptions& options);
};

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/any_predictor.ipp"
#endif
