// SPDX-License-Identifier: BSD-3-Clause
// One set of kernels. Compiled with the flags of its instruction set, and with an Eigen of its own (the macro renames
// the namespace), so that no inline function is shared with units of other flags.

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "vernier/core/detail/dense_kernels.hpp"

namespace vernier::detail {

namespace {

using Matrix = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;

Matrix map(const MatrixAt<double>& m) { return {m.data, m.rows, m.cols, Eigen::OuterStride<>(m.stride)}; }
ConstMatrix map(const MatrixAt<const double>& m) { return {m.data, m.rows, m.cols, Eigen::OuterStride<>(m.stride)}; }

}  // namespace

const DenseKernels VERNIER_KERNELS{
    [](MatrixAt<double> out, MatrixAt<const double> a, MatrixAt<const double> b, double factor) {
      map(out).noalias() += factor * (map(a) * map(b));
    },
    [](MatrixAt<double> out, MatrixAt<const double> a, MatrixAt<const double> b, double factor) {
      map(out).noalias() += factor * (map(a).transpose() * map(b));
    },
    [](MatrixAt<double> matrix) {
      Matrix mapped = map(matrix);
      Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>> in_place(mapped);
      return Eigen::LLT<decltype(in_place)>(in_place).info() == Eigen::Success;
    },
    [](MatrixAt<const double> factor, MatrixAt<double> right) {
      const ConstMatrix triangle = map(factor);
      Matrix mapped = map(right);
      triangle.triangularView<Eigen::Lower>().solveInPlace(mapped);
    },
    [](MatrixAt<const double> factor, MatrixAt<double> right) {
      const ConstMatrix triangle = map(factor);
      Matrix mapped = map(right);
      triangle.triangularView<Eigen::Lower>().transpose().solveInPlace(mapped);
    }};

}  // namespace vernier::detail
