// SPDX-License-Identifier: BSD-3-Clause
// Your own regressor: a recipe whose fit() gives a predictor. It can then be used wherever an Elm can.

#include <Eigen/QR>
#include <cstdio>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/elm.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>
#include <vernier/testing/regressor_laws.hpp>

namespace vn = vernier;

// y = B' [1, sin x, cos x]: linear in the sines and cosines of the inputs.
template <int Inputs, int Outputs>
struct HarmonicMap {
  static constexpr int inputs = Inputs, outputs = Outputs;
  using Input = Eigen::Matrix<double, Inputs, 1>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Inputs>;
  using Features = Eigen::Matrix<double, 2 * Inputs + 1, 1>;
  Eigen::Matrix<double, 2 * Inputs + 1, Outputs> weights;

  static Features features(const Input& x) { return (Features() << 1, x.array().sin(), x.array().cos()).finished(); }

  // One sample: no allocation, no exception.
  Eigen::Matrix<double, Outputs, 1> predict(const Input& x) const noexcept { return weights.transpose() * features(x); }
  // Many samples, one a row.
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(const Rows& x) const {
    Eigen::Matrix<double, Eigen::Dynamic, Outputs> y(x.rows(), Outputs);
    for (vn::Index i = 0; i < x.rows(); ++i) y.row(i) = predict(Input(x.row(i).transpose())).transpose();
    return y;
  }
  // The exact derivative: a corrected model needs it for its Jacobian.
  Eigen::Matrix<double, Outputs, Inputs> derivative(const Input& x) const noexcept {
    return weights.template middleRows<Inputs>(1).transpose() * x.array().cos().matrix().asDiagonal() -
           weights.template bottomRows<Inputs>().transpose() * x.array().sin().matrix().asDiagonal();
  }
};

// The recipe. Numbers of inputs and outputs come from the columns of the samples.
struct HarmonicRegression {
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const vn::FitOptions& options = {}) const {
    vn::demand(options.weights == nullptr, "HarmonicRegression takes no weights");
    vn::demand(x.rows() == y.rows(), "HarmonicRegression: ", x.rows(), " inputs, but ", y.rows(), " targets");
    using Map = HarmonicMap<X::ColsAtCompileTime, Y::ColsAtCompileTime>;
    vn::MatrixX h(x.rows(), 2 * Map::inputs + 1);
    for (vn::Index i = 0; i < x.rows(); ++i) h.row(i) = Map::features(x.row(i).transpose()).transpose();
    return Map{h.colPivHouseholderQr().solve(vn::MatrixX(y))};
  }
};
static_assert(vn::Regressor<HarmonicRegression>);

int main() {
  // The laws: fits repeat bit for bit, rows and samples agree, the derivative is one, misuse throws.
  const auto violations = vn::testing::regressor_violations(HarmonicRegression{}, {.uses_seed = false});
  for (const auto& violation : violations) std::printf("broken law: %s\n", violation.c_str());
  if (!violations.empty()) return 1;
  std::printf("the harmonic regression obeys the laws of regressors\n");

  const auto nominal = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);
  const auto region = vn::abb_irb120_operating_region();
  const auto train = vn::measure(actual, region.sample(nominal, 100, 1));
  const auto test = vn::measure(actual, region.sample(nominal, 300, 2));
  const auto report = [&](const char* name, const auto& model) {
    std::printf("  %-32s %.3f mm\n", name, vn::prediction_error(model, test).mean * 1e3);
  };
  std::printf("mean error on fresh poses, learned from 100:\n");
  report("nominal", nominal);
  report("harmonic regression, 13 features", vn::CartesianCompensation{HarmonicRegression{}}.fit(nominal, train));
  report("ELM, 65 nodes", vn::CartesianCompensation{vn::Elm{}}.fit(nominal, train, {.seed = 1}));
}
