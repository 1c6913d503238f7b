// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A learned position error whose kind is known at run time.

#include <string_view>
#include <utility>
#include <variant>

#include "vernier/regression/elm_predictor.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier {

/// A fitted network or sum of kernels from joint values to a position error [m]: a `Predictor`.
template <int N>
class LearnedError : public detail::PredictorInterface<LearnedError<N>, N, 3> {
  using Base = detail::PredictorInterface<LearnedError<N>, N, 3>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;
  /// A member of the ELM family.
  using Network = ElmPredictor<N, 3>;
  /// A kernel method.
  using Kernels = KernelPredictor<N, 3>;

  /// Of a network.
  LearnedError(Network network) : fitted_(std::move(network)) {}  // NOLINT(google-explicit-constructor)
  /// Of kernels.
  LearnedError(Kernels kernels) : fitted_(std::move(kernels)) {}  // NOLINT(google-explicit-constructor)

  /// The prediction, and where `slope` is not null the derivative.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept {
    if (const Network* network = std::get_if<Network>(&fitted_))
      network->evaluate(x, y, slope);
    else
      std::get_if<Kernels>(&fitted_)->evaluate(x, y, slope);
  }
  /// Predictions of samples, one a row.
  void evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const {
    std::visit([&](const auto& fitted) { fitted.evaluate_rows(x, y); }, fitted_);
  }

  /// The network; null where it is of another kind.
  const Network* network() const { return std::get_if<Network>(&fitted_); }
  /// The kernels; null where it is of another kind.
  const Kernels* kernels() const { return std::get_if<Kernels>(&fitted_); }
  /// Whether it is the same everywhere.
  bool constant() const { return network() != nullptr ? network()->beta().isZero(0) : kernels()->alpha().isZero(0); }
  /// This error in a frame that is turned: errors are multiplied by the rotation.
  LearnedError turned(const Matrix3& rotation) const {
    if (const Network* from = network())
      return Network(from->layer(), from->scaling(), from->theta(), from->beta() * rotation.transpose(),
                     rotation * from->offset());
    const Kernels& from = *kernels();
    return Kernels(from.kernel(), from.input_map(), from.scaling(), from.centres(), from.alpha() * rotation.transpose(),
                   rotation * from.mean());
  }

 private:
  std::variant<Network, Kernels> fitted_;
};

}  // namespace vernier
