// The spectrum of joints: lines of simulated drives at their order, with amplitudes inside their intervals; no lines
// where there are none.

#include "vernier/error_model/joint_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gauss_newton.hpp"
#include "real_matrix.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/error_model/detail/periodogram.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::joint_spectrum_test {
namespace {

using namespace vernier::literals;
using vernier_test::identify_by_gauss_newton;
using vernier_test::RealMatrix;
using Chain = DhChain<3>;
using Actual = Framed<WithJointErrors<Chain>>;

const Chain nominal{{{{.alpha = 90_deg, .d = 300_mm}, {.a = 400_mm}, {.a = 350_mm, .alpha = 20_deg}}}};
const SensorModel squared{.loss = Loss::squared};
const FrameParameters base(Vector6{1.4, -0.3, 0.2, 0.1, -0.2, 0.6});

/// A line of one joint's drive.
struct Line {
  int joint, order;
  double amplitude, phase;
};

/// An arm with geometric errors, three harmonics a joint, and lines.
Actual arm_with(const std::vector<Line>& lines, Rng& rng) {
  JointTerms terms(3);
  for (Fourier& fourier : terms.transmission) fourier = Fourier::up_to(3);
  for (const Line& line : lines) terms.transmission[static_cast<std::size_t>(line.joint)].orders.push_back(line.order);
  VectorX beta(terms.size());
  for (double& value : beta) value = 0.1e-3 * rng.normal();
  for (const Line& line : lines) {
    const Index end = terms.transmission_begin(line.joint + 1);
    beta(end - 2) = line.amplitude * std::cos(line.phase);
    beta(end - 1) = line.amplitude * std::sin(line.phase);
  }
  return Actual({with_geometric_errors(nominal, {}, rng.below(1000000)), JointErrors(terms, beta)}, base, {});
}

FittedErrorModel<Chain> fitted(const Actual& actual, const ErrorModelOptions& options, Rng& rng) {
  JointRows<3> joints(420, 3);
  for (Index joint = 0; joint < 3; ++joint)
    for (Index i = 0; i < joints.rows(); ++i) joints(i, joint) = rng.uniform(-2.9, 2.9);
  const Dataset<3> data = measure(actual, joints, {.position = 0.02e-3}, rng.below(1000000)).without_orientations();
  const auto start =
      identify_by_gauss_newton(Framed<Chain>(nominal, base, {}), data, {.frames = Frames::base}, squared);
  return fit_error_model(start, std::vector<Dataset<3>>{data}, options, squared);
}

/// Orders of which a test's lines are drawn, and few others, to be fast.
ErrorModelOptions options() {
  return {.spectrum = {{1, 4, 100e-6}, {28, 36, 10e-6}, {96, 104, 10e-6}, {126, 130, 10e-6}, {400, 408, 12e-6}},
          .hysteresis = false,
          .drift = false,
          .num_validation_poses = 40};
}

/// Which arm of the hundred: quarters run side by side.
class Lines : public ::testing::TestWithParam<int> {};

TEST_P(Lines, AreFoundWithTheirAmplitude) {
  constexpr int orders[] = {30, 32, 34, 98, 100, 102, 127, 128, 129, 402, 404, 406};
  int found = 0;
  for (int arm = 0; arm < 25; ++arm) {
    Rng rng(1000 * static_cast<std::uint64_t>(GetParam()) + static_cast<std::uint64_t>(arm));
    const Line line{static_cast<int>(rng.below(3)), orders[rng.below(12)], rng.uniform(25e-6, 60e-6),
                    rng.uniform(0, 2 * std::numbers::pi)};
    const auto model = fitted(arm_with({line}, rng), options(), rng);
    ASSERT_TRUE(model.converged);
    const auto spectrum = joint_spectrum(model, line.joint);
    for (const HarmonicEstimate& one : lines_in(spectrum, line_threshold(108)))
      if (std::abs(one.order - line.order) <= 1) {
        found += std::abs(one.amplitude - line.amplitude) <= one.margin();
        break;
      }
  }
  RecordProperty("found", found);
  EXPECT_GE(found, 22) << "of 25 arms";  // of a hundred at least 90; chance leaves 95 % of the intervals right
}

INSTANTIATE_TEST_SUITE_P(HundredArms, Lines, ::testing::Range(0, 4));

TEST(JointSpectrum, OrdersThatNobodyStatedAreFound) {
  ErrorModelOptions few = options();
  few.spectrum = {{1, 4, 100e-6}};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Rng rng(seed);
    const Line line{static_cast<int>(seed % 3), seed % 2 == 0 ? 1010 : 1873, 40e-6, 0.7};
    const auto model = fitted(arm_with({line}, rng), few, rng);
    ASSERT_EQ(model.blocks.back().name, "lines");
    EXPECT_TRUE(model.blocks.back().used);
    for (int joint = 0; joint < 3; ++joint) {
      std::vector<int> wanted{1, 2, 3, 4};
      if (joint == line.joint) wanted.push_back(line.order);
      EXPECT_EQ(model.arm.terms().transmission[static_cast<std::size_t>(joint)].orders, wanted);
    }
    const auto estimate = joint_spectrum(model, line.joint).back();
    EXPECT_EQ(estimate.order, line.order);
    EXPECT_NEAR(estimate.amplitude, line.amplitude, 3.5 * estimate.std);
    EXPECT_LT(estimate.std, 5e-6);
  }
}

TEST(JointSpectrum, LinesOfAStatedDriveAreInTheModel) {
  ErrorModelOptions few = options();
  few.spectrum = {{1, 4, 100e-6}};
  few.drives = {{}, {.gear_ratio = 101}, {}};
  Rng rng(5);
  const Line line{1, 1010, 40e-6, 0.7};
  const auto model = fitted(arm_with({line}, rng), few, rng);
  EXPECT_NE(model.blocks.back().name, "lines");
  EXPECT_EQ(model.arm.terms().transmission[0].orders, (std::vector<int>{1, 2, 3, 4}));
  const auto lines = lines_in(joint_spectrum(model, 1), line_threshold(50));
  const auto found = std::find_if(lines.begin(), lines.end(), [](const auto& one) { return one.order == 1010; });
  ASSERT_NE(found, lines.end());
  EXPECT_NEAR(found->amplitude, line.amplitude, 3.5 * found->std);
  few.drives.pop_back();
  EXPECT_THROW((void)fitted(arm_with({line}, rng), few, rng), std::invalid_argument);
}

TEST(JointSpectrum, ArmsWithoutLinesHaveNone) {
  int lines = 0, blocks = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(100 + seed);
    const auto model = fitted(arm_with({}, rng), options(), rng);
    blocks += model.blocks.back().name == "lines";
    for (int joint = 0; joint < 3; ++joint)
      for (const HarmonicEstimate& one : lines_in(joint_spectrum(model, joint), line_threshold(108)))
        lines += one.order > 4;
  }
  EXPECT_LE(lines, 1);  // one in a hundred
  EXPECT_LE(blocks, 1);
}

TEST(JointSpectrum, AnOrderByHand) {
  const auto one = [](int order, double amplitude) {
    return HarmonicEstimate{order, amplitude, 1, amplitude * amplitude};
  };
  const auto lines = lines_in({one(3, 9), one(100, 6), one(101, 7), one(105, 8), one(110, 2), one(400, 5)}, 10);
  ASSERT_EQ(lines.size(), 4u);  // 101 is a neighbour of 105, 100 one of neither: five away
  EXPECT_EQ(lines[0].order, 3);
  EXPECT_EQ(lines[1].order, 105);
  EXPECT_EQ(lines[2].order, 100);
  EXPECT_EQ(lines[3].order, 400);
  EXPECT_NEAR(std::exp(-line_threshold(1000) / 2) * 1000, 0.01, 1e-12);  // the tail of chi-square with 2 degrees
}

TEST(PeriodogramWhiteBox, IsTheChiSquareOfARegression) {
  Rng rng(3);
  const Index n = 300;
  RealMatrix angles(n, 1), residual(n, 1), effect(n, 1);
  for (Index i = 0; i < n; ++i) {
    angles(i) = rng.uniform(-1, 2);
    effect(i) = rng.uniform(0.2, 1);
    residual(i) = rng.normal() + effect(i) * 0.5 * std::cos(617 * angles(i) - 1);
  }
  const VectorX power = detail::periodogram(angles, effect.times(residual), effect.times(effect), 900);
  for (const int order : {1, 7, 255, 256, 257, 617, 900}) {
    RealMatrix columns(n, 2);
    for (Index i = 0; i < n; ++i) {
      columns(i, 0) = effect(i) * std::cos(order * angles(i));
      columns(i, 1) = effect(i) * std::sin(order * angles(i));
    }
    EXPECT_NEAR(power(order - 1), (columns * columns.solve(residual)).squared_norm(), 1e-8) << order;
  }
  const auto largest = std::max_element(power.data(), power.data() + power.size());
  EXPECT_EQ(largest - power.data() + 1, 617);
}

TEST(PeriodogramWhiteBox, AGridOfAnglesTellsNoOrdersApart) {
  VectorX grid(200), weight = VectorX::Ones(200);
  for (Index i = 0; i < 200; ++i) grid(i) = 2 * std::numbers::pi * static_cast<double>(i % 90) / 180;
  EXPECT_FALSE(detail::tells_orders_apart(grid, weight, 500));
  Rng rng(1);
  for (double& angle : grid) angle += rng.uniform(-0.1, 0.1);
  EXPECT_TRUE(detail::tells_orders_apart(grid, weight, 500));
  EXPECT_FALSE(detail::tells_orders_apart(grid, VectorX::Zero(200), 500));
}

}  // namespace
}  // namespace vernier::joint_spectrum_test
