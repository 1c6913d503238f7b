// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The overloads of a `Predictor`, made of one function.

#include <utility>

#include "vernier/regression/concepts.hpp"

namespace vernier::detail {

/// `predict` and `derivative` of `Self`, which has
///
/// - `evaluate(x, y, slope)`: the prediction, and where `slope` is not null the derivative;
/// - `evaluate_rows(X, Y)`: samples as rows, where that is better than one at a time.
template <class Self, int Inputs, int Outputs>
class PredictorInterface {
 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;
  /// Predictions, one a row.
  using OutputRows = Eigen::Matrix<double, Eigen::Dynamic, Outputs>;
  /// A derivative.
  using Slope = Eigen::Matrix<double, Outputs, Inputs>;

  /// One sample.
  template <class Derived>
    requires SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    Output y;
    self().evaluate(Input(x), y, nullptr);
    return y;
  }

  /// Samples as rows, n x inputs to n x outputs.
  template <class Derived>
    requires SampleRowsOf<Derived, Inputs> OutputRows predict(const Eigen::MatrixBase<Derived>& x)
  const {
    OutputRows out(x.rows(), Outputs);
    if constexpr (requires { self().evaluate_rows(x.derived(), out); }) {
      self().evaluate_rows(x.derived(), out);
    } else {
      Output y;
      for (Index i = 0; i < x.rows(); ++i) {
        self().evaluate(Input(x.row(i).transpose()), y, nullptr);
        out.row(i) = y.transpose();
      }
    }
    return out;
  }

  /// d predict / d x at one sample.
  template <class Derived>
    requires SampleOf<Derived, Inputs> Slope derivative(const Eigen::MatrixBase<Derived>& x)
  const noexcept { return predict_and_derivative(x).second; }

  /// Both in one pass.
  template <class Derived>
    requires SampleOf<Derived, Inputs> std::pair<Output, Slope> predict_and_derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    std::pair<Output, Slope> out;
    self().evaluate(Input(x), out.first, &out.second);
    return out;
  }

 private:
  const Self& self() const noexcept { return static_cast<const Self&>(*this); }
};

}  // namespace vernier::detail
