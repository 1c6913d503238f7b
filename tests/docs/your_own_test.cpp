// SPDX-License-Identifier: BSD-3-Clause
// The blocks of code of docs/your_own.md, in the order of the page. Its types are declarations; the bodies stand here.

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include "page_blocks.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/measurements/sensor.hpp"
#include "vernier/regression/os_elm.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/testing/kinematic_laws.hpp"
#include "vernier/testing/metaheuristic_laws.hpp"
#include "vernier/testing/regressor_laws.hpp"
#include "vernier/testing/sensor_laws.hpp"

namespace vernier::your_own_test {
namespace {

static_assert(your_own_blocks == 10, "a block of docs/your_own.md without a test");

namespace vn = vernier;

// --- your own robot

#include "your_own_1.inc"

vn::PoseAndJacobian<4> Scara::pose_and_jacobian(const vn::JointVector<4>& q) const noexcept {
  constexpr double l1 = 0.325, l2 = 0.275, height = 0.4;  // [m]
  const double b = q(0) + q(1), x2 = l2 * std::cos(b), y2 = l2 * std::sin(b);
  const double x = l1 * std::cos(q(0)) + x2, y = l1 * std::sin(q(0)) + y2;
  vn::PoseAndJacobian<4> out{vn::Isometry3::Identity(), vn::Jacobian<4>::Zero()};
  out.pose.translation() << x, y, height - q(2);
  out.pose.linear() = vn::exp_so3(vn::Vector3(0, 0, b + q(3)));
  out.jacobian.col(0) << -y, x, 0, 0, 0, 1;
  out.jacobian.col(1) << -y2, x2, 0, 0, 0, 1;
  out.jacobian.col(2) << 0, 0, -1, 0, 0, 0;
  out.jacobian.col(3) << 0, 0, 0, 0, 0, 1;
  return out;
}
vn::Isometry3 Scara::pose(const vn::JointVector<4>& q) const noexcept { return pose_and_jacobian(q).pose; }
vn::Vector3 Scara::position(const vn::JointVector<4>& q) const noexcept { return pose(q).translation(); }
vn::Jacobian<4> Scara::jacobian(const vn::JointVector<4>& q) const noexcept { return pose_and_jacobian(q).jacobian; }

/// A SCARA whose first column is not the derivative.
struct Wrong : Scara {
  vn::PoseAndJacobian<4> pose_and_jacobian(const vn::JointVector<4>& q) const noexcept {
    vn::PoseAndJacobian<4> out = Scara::pose_and_jacobian(q);
    out.jacobian.col(0) *= 1.01;
    return out;
  }
  vn::Jacobian<4> jacobian(const vn::JointVector<4>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
};

template <class Model>
std::string printed_violations(const Model& scara) {
  vn::JointLimits<4> limits;
  limits.lower << -2, 0.3, 0, -3;
  limits.upper << 2, 2.3, 0.2, 3;
  const vn::JointRows<4> joints = vn::sample_joints(limits, 50, 1);
  ::testing::internal::CaptureStdout();
#include "your_own_2.inc"
  return ::testing::internal::GetCapturedStdout();
}

TEST(YourOwn, Robot) {
  EXPECT_EQ(printed_violations(Scara{}), "");
  EXPECT_NE(printed_violations(Wrong{}), "");
  const Scara scara;
  const vn::JointVector<4> q(0.3, 1.0, 0.05, 0.5), seed = q.array() + 0.2;
  EXPECT_LT((inverse_kinematics(scara, scara.pose(q), seed).joints - q).norm(), 1e-5);
}

// --- your own regressor

#include "your_own_3.inc"

template <int Inputs>
Eigen::Matrix<double, 2 * Inputs + 1, 1> features(const Eigen::Matrix<double, Inputs, 1>& x) {
  return (Eigen::Matrix<double, 2 * Inputs + 1, 1>() << 1, x.array().sin(), x.array().cos()).finished();
}
template <int Inputs, int Outputs>
Eigen::Matrix<double, Outputs, 1> HarmonicMap<Inputs, Outputs>::predict(const Input& x) const noexcept {
  return weights.transpose() * features<Inputs>(x);
}
template <int Inputs, int Outputs>
Eigen::Matrix<double, Eigen::Dynamic, Outputs> HarmonicMap<Inputs, Outputs>::predict(const Rows& x) const {
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> y(x.rows(), Outputs);
  for (vn::Index i = 0; i < x.rows(); ++i) y.row(i) = predict(Input(x.row(i).transpose())).transpose();
  return y;
}
template <int Inputs, int Outputs>
Eigen::Matrix<double, Outputs, Inputs> HarmonicMap<Inputs, Outputs>::derivative(const Input& x) const noexcept {
  return weights.template middleRows<Inputs>(1).transpose() * x.array().cos().matrix().asDiagonal() -
         weights.template bottomRows<Inputs>().transpose() * x.array().sin().matrix().asDiagonal();
}
template <class X, class Y>
HarmonicMap<X::ColsAtCompileTime, Y::ColsAtCompileTime> HarmonicRegression::fit(const Eigen::MatrixBase<X>& x,
                                                                                const Eigen::MatrixBase<Y>& y,
                                                                                const vn::FitOptions& options) const {
  vn::demand(options.weights == nullptr, "HarmonicRegression takes no weights");
  vn::demand(x.rows() == y.rows(), "HarmonicRegression: ", x.rows(), " inputs, but ", y.rows(), " targets");
  constexpr int inputs = X::ColsAtCompileTime;
  vn::MatrixX h(x.rows(), 2 * inputs + 1);
  for (vn::Index i = 0; i < x.rows(); ++i) h.row(i) = features<inputs>(x.row(i).transpose()).transpose();
  return {h.colPivHouseholderQr().solve(vn::MatrixX(y))};
}

TEST(YourOwn, Regressor) {
#include "your_own_4.inc"
  EXPECT_EQ(harmonic, std::vector<std::string>());
  EXPECT_EQ(weighted, std::vector<std::string>());
  EXPECT_FALSE(vn::testing::regressor_violations(HarmonicRegression{}, {.uses_seed = true}).empty());
}

// --- your own search

#include "your_own_5.inc"

/// Children around the parent, kept in the box; true when the best of them replaced it.
bool breed(EvolutionStrategy::State& s, const vn::Box& box, vn::Evaluate evaluate) {
  vn::MatrixX population(box.dimension(), 20);
  for (vn::Index k = 0; k < population.cols(); ++k)
    for (vn::Index d = 0; d < box.dimension(); ++d)
      population(d, k) = std::clamp(s.best(d) + s.step_size * (box.upper(d) - box.lower(d)) * s.rng.normal(),
                                    box.lower(d), box.upper(d));
  vn::VectorX fitness;
  evaluate(population, fitness);
  vn::Index leader = 0;
  if (!(fitness.minCoeff(&leader) < s.best_fitness)) return false;
  s.best_fitness = fitness(leader);
  s.best = population.col(leader);
  return true;
}
EvolutionStrategy::State EvolutionStrategy::start(const vn::Box& box, std::uint64_t seed, vn::Evaluate evaluate) const {
  State s{(box.lower + box.upper) / 2, HUGE_VAL, 0, 0.15, vn::Rng(seed)};
  breed(s, box, evaluate);
  return s;
}
void EvolutionStrategy::step(State& s, const vn::Box& box, vn::Evaluate evaluate) const {
  s.step_size *= breed(s, box, evaluate) ? 1.3 : 0.85;
  ++s.generation;
}
bool EvolutionStrategy::done(const State& s) const { return s.generation >= 400; }
vn::Index EvolutionStrategy::next_evaluations(const State&) const { return 20; }

TEST(YourOwn, Search) {
  const EvolutionStrategy strategy;
  const auto objective = [](const vn::VectorX& x) { return (x.array() - 0.3).square().sum(); };
  const vn::Box box{vn::VectorX::Constant(5, -1), vn::VectorX::Constant(5, 1)};
  const std::uint64_t seed = 3;
#include "your_own_6.inc"
  EXPECT_EQ(search.evaluations, 5000);
  const auto at_once = vn::minimize(strategy, objective, box, {.max_evaluations = 5000}, seed);
  EXPECT_EQ(search.state.best, at_once.best);
  EXPECT_LT(search.state.best_fitness, 1e-4);
#include "your_own_7.inc"
  EXPECT_EQ(violations, std::vector<std::string>());
}

// --- a sensor of your own

#include "your_own_8.inc"

/// A dial gauge with a derivative that is a thousand times too small.
struct Shrunk : DialGauge {
  using DialGauge::DialGauge;
  void sense(vn::Index i, const vn::Isometry3& pose, vn::SensedRows& rows) const {
    DialGauge::sense(i, pose, rows);
    rows.motion *= 1e-3;
  }
};

template <class Gauge>
std::string printed_violations(const Gauge& exact, const std::vector<vn::Isometry3>& poses) {
  ::testing::internal::CaptureStdout();
#include "your_own_9.inc"
  return ::testing::internal::GetCapturedStdout();
}

TEST(YourOwn, Sensor) {
  const auto robot = vn::robots::ur10();
  const auto& arm = robot.chain;
  const auto actual = vn::with_geometric_errors(arm, {}, 3);
  const vn::Vector3 direction(0.6, 0, 0.8);
  const vn::JointRows<6> joints = vn::sample_joints(robot.limits, 60, 1);
  const vn::VectorX readings = (vn::positions(actual, joints) * direction).array() + 0.4;
  const std::vector<vn::Isometry3> poses = vn::poses(actual, joints);
  EXPECT_EQ(printed_violations(DialGauge(readings), poses), "");
  EXPECT_NE(printed_violations(Shrunk(readings), poses), "");
  const auto tracked = vn::measure(actual, vn::sample_joints(robot.limits, 60, 2), {.position = 0.05e-3}, 3);
#include "your_own_10.inc"
  const auto report = vn::evaluate(calibration, tracked);
  ASSERT_EQ(report.others.size(), 1u);
  EXPECT_EQ(report.others[0].kind, "dial gauge");
  EXPECT_EQ(report.others[0].name, "gauge.csv");
  EXPECT_LT(report.others[0].rms, 0.02e-3);
  const auto fresh = vn::measure(actual, vn::sample_joints(robot.limits, 200, 4));
  EXPECT_LT(vn::prediction_error(calibration.errors.models(vn::Stage::geometry).front(), fresh).mean, 0.02e-3);
}

}  // namespace
}  // namespace vernier::your_own_test
