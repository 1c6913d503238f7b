// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Samples of a smooth function, every kind of hidden layer, and formulas over samples, for tests of regressors.

#include <algorithm>
#include <cmath>
#include <concepts>
#include <span>
#include <utility>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier_test {

inline constexpr vernier::Activation activations[] = {vernier::Activation::sigmoid, vernier::Activation::tanh,
                                                      vernier::Activation::sine, vernier::Activation::radial_basis};
inline constexpr vernier::InputMap input_maps[] = {vernier::InputMap::raw, vernier::InputMap::sines_and_cosines};

using Inputs = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Targets = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// All elements of a matrix, column by column.
template <class M>
std::span<double> elements(M& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

/// Uniform in [-1.5, 1.5].
inline Inputs inputs(vernier::Index n, std::uint64_t seed) {
  vernier::Rng rng(seed);
  Inputs x(n, 3);
  for (double& value : elements(x)) value = rng.uniform(-1.5, 1.5);
  return x;
}

/// Millimetres in metres, the first output far from zero, with normal noise.
inline Targets targets(const Inputs& x, double noise = 0) {
  vernier::Rng rng(99);
  Targets y(x.rows(), 2);
  for (Index i = 0; i < x.rows(); ++i) {
    y(i, 0) = 1e-3 * std::sin(2 * x(i, 0)) * x(i, 1) + 0.5;
    y(i, 1) = 1e-3 * std::cos(x(i, 2) - x(i, 0));
  }
  if (noise > 0)
    for (double& value : elements(y)) value += noise * rng.normal();
  return y;
}

/// A matrix of two columns as targets.
inline Targets as_targets(const RealMatrix& a) {
  Targets y(a.rows(), 2);
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < 2; ++j) y(i, j) = a(i, j);
  return y;
}
/// The i-th sample of targets.
inline Eigen::Vector2d target(const Targets& y, Index i) { return {y(i, 0), y(i, 1)}; }

/// Largest absolute difference of elements; infinite where the shapes differ, NaN where a difference is.
template <class A, class B>
  requires(std::same_as<A, Targets> || std::same_as<B, Targets>)
double difference(const A& a, const B& b) { return difference(RealMatrix::of(a), RealMatrix::of(b)); }

inline RealMatrix zeros(Index rows, Index cols) { return {rows, cols}; }
/// All elements the same.
inline RealMatrix filled(Index rows, Index cols, double value) {
  RealMatrix out(rows, cols);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = value;
  return out;
}

/// [a b]
inline RealMatrix beside(const RealMatrix& a, const RealMatrix& b) {
  RealMatrix out(a.rows(), a.cols() + b.cols());
  out.set_block(0, 0, a);
  out.set_block(0, a.cols(), b);
  return out;
}
/// Columns side by side, as the population of a search.
inline RealMatrix beside(const std::vector<vernier::VectorX>& columns) {
  RealMatrix out(columns.front().size(), static_cast<Index>(columns.size()));
  for (Index j = 0; j < out.cols(); ++j) out.set_block(0, j, columns[static_cast<std::size_t>(j)]);
  return out;
}
/// [a; b]
inline RealMatrix above(const RealMatrix& a, const RealMatrix& b) {
  RealMatrix out(a.rows() + b.rows(), a.cols());
  out.set_block(0, 0, a);
  out.set_block(a.rows(), 0, b);
  return out;
}
/// [a 1]
inline RealMatrix with_ones(const RealMatrix& a) { return beside(a, filled(a.rows(), 1, 1)); }
/// First rows of a matrix, or its last.
inline RealMatrix top(const RealMatrix& a, Index rows) { return a.block(0, 0, rows, a.cols()); }
inline RealMatrix bottom(const RealMatrix& a, Index rows) { return a.block(a.rows() - rows, 0, rows, a.cols()); }

/// Some rows of a matrix, or some columns, in the order given.
inline RealMatrix rows_of(const RealMatrix& a, const std::vector<Index>& rows) {
  RealMatrix out(static_cast<Index>(rows.size()), a.cols());
  for (Index i = 0; i < out.rows(); ++i) out.set_block(i, 0, a.row(rows[static_cast<std::size_t>(i)]));
  return out;
}
inline RealMatrix columns_of(const RealMatrix& a, const std::vector<Index>& columns) {
  return rows_of(a.transpose(), columns).transpose();
}
/// The same of samples.
template <class Rows>
Rows samples_of(const Rows& samples, const std::vector<Index>& rows) {
  Rows out(static_cast<Index>(rows.size()), samples.cols());
  for (Index i = 0; i < out.rows(); ++i)
    for (Index j = 0; j < out.cols(); ++j) out(i, j) = samples(rows[static_cast<std::size_t>(i)], j);
  return out;
}
/// So many samples from a first one on.
template <class Rows>
Rows part(const Rows& samples, Index first, Index count) {
  std::vector<Index> rows;
  for (Index i = 0; i < count; ++i) rows.push_back(first + i);
  return samples_of(samples, rows);
}
/// The numbers of all samples but one.
inline std::vector<Index> all_but(Index left_out, Index n) {
  std::vector<Index> out;
  for (Index i = 0; i < n; ++i)
    if (i != left_out) out.push_back(i);
  return out;
}

/// diag(factors) a
inline RealMatrix scaled_rows(const RealMatrix& factors, const RealMatrix& a) {
  RealMatrix out = a;
  for (Index j = 0; j < a.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i) out(i, j) *= factors(i);
  return out;
}
/// A row added to each row.
inline RealMatrix plus_row(const RealMatrix& a, const RealMatrix& row) {
  RealMatrix out = a;
  for (Index j = 0; j < a.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i) out(i, j) += row(0, j);
  return out;
}
/// Mean of each column, a row.
inline RealMatrix column_means(const RealMatrix& a) {
  RealMatrix out(1, a.cols());
  for (Index j = 0; j < a.cols(); ++j) out(0, j) = a.col(j).mean();
  return out;
}
/// Less the mean of each column.
inline RealMatrix centred(const RealMatrix& a) { return plus_row(a, -column_means(a)); }

/// Least and largest element of a column.
inline std::pair<double, double> range_of_column(const RealMatrix& a, Index j) {
  std::pair<double, double> range{a(0, j), a(0, j)};
  for (Index i = 0; i < a.rows(); ++i) range = {std::min(range.first, a(i, j)), std::max(range.second, a(i, j))};
  return range;
}
/// Each column by the map that takes the range of this column of some samples to [-1, 1].
inline RealMatrix scaled_to_range_of(const RealMatrix& samples, const RealMatrix& a) {
  RealMatrix out = a;
  for (Index j = 0; j < a.cols(); ++j) {
    const auto [low, high] = range_of_column(samples, j);
    for (Index i = 0; i < a.rows(); ++i) out(i, j) = 2 * (a(i, j) - low) / (high - low) - 1;
  }
  return out;
}

/// [sin x, cos x]
inline RealMatrix sines_and_cosines(const RealMatrix& x) {
  RealMatrix out(x.rows(), 2 * x.cols());
  for (Index i = 0; i < x.rows(); ++i)
    for (Index j = 0; j < x.cols(); ++j) {
      out(i, j) = std::sin(x(i, j));
      out(i, x.cols() + j) = std::cos(x(i, j));
    }
  return out;
}
/// Distance of the i-th row of a from the j-th of b.
inline double distance_of_rows(const RealMatrix& a, Index i, const RealMatrix& b, Index j) {
  double square = 0;
  for (Index c = 0; c < a.cols(); ++c) square += (a(i, c) - b(j, c)) * (a(i, c) - b(j, c));
  return std::sqrt(square);
}

/// A vector with one element moved.
inline vernier::VectorX moved(vernier::VectorX x, Index i, double step) {
  x(i) += step;
  return x;
}

/// What a hidden layer makes of features.
inline RealMatrix hidden_outputs(const vernier::HiddenLayer& layer, const vernier::ConstMatrixRef& features,
                                 const vernier::VectorX& theta) {
  vernier::MatrixX h;
  layer.outputs(features, theta, h);
  return h;
}

/// Derivative of a predictor's outputs by one of its inputs, by central differences.
template <class P>
RealMatrix difference_quotient(const P& predictor, const vernier::Vector3& at, Index input, double step) {
  vernier::Vector3 plus = at, minus = at;
  plus(input) += step;
  minus(input) -= step;
  return (RealMatrix::of(predictor.predict(plus)) - RealMatrix::of(predictor.predict(minus))) / (2 * step);
}

/// Numbers of 1, 2 or 3, as weights of samples.
inline vernier::VectorX small_whole_weights(Index n, std::uint64_t seed) {
  vernier::Rng rng(seed);
  vernier::VectorX q(n);
  for (double& value : elements(q)) value = static_cast<double>(1 + rng.below(3));
  return q;
}
/// Uniform in [0.2, 4], as weights of samples.
inline vernier::VectorX random_weights(Index n) {
  vernier::Rng rng(5);
  vernier::VectorX w(n);
  for (double& value : elements(w)) value = rng.uniform(0.2, 4);
  return w;
}

}  // namespace vernier_test
