// SPDX-License-Identifier: BSD-3-Clause
// A regressor whose fitted map has no derivative.
// expect: `derivative(x)` must be const and noexcept and return Eigen::Matrix<double, outputs, inputs>
#include <vernier/compensation/cartesian.hpp>

namespace vn = vernier;

template <int Inputs, int Outputs>
struct HarmonicMap {
  static constexpr int inputs = Inputs, outputs = Outputs;
  using Input = Eigen::Matrix<double, Inputs, 1>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Inputs>;
  Eigen::Matrix<double, Outputs, 1> predict(const Input& x) const noexcept;
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(const Rows& x) const;
#ifndef MISTAKE
  Eigen::Matrix<double, Outputs, Inputs> derivative(const Input& x) const noexcept;
#endif
};

struct HarmonicRegression {
  template <class X, class Y>
  HarmonicMap<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>&, const Eigen::MatrixBase<Y>&,
                                                              const vn::FitOptions& = {}) const;
};

const vn::CartesianCompensation compensation{HarmonicRegression{}, {.moving_joints = 3}};
