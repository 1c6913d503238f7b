// SPDX-License-Identifier: BSD-3-Clause
// The spectrum of joints: lines of simulated drives at their order, with amplitudes inside their intervals; no lines
// where there are none.

#include "vernier/error_model/joint_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

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
using vernier_test::vector;
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
  return fit_error_model(start, data, options, squared);
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
    ASSERT_EQ(model.blocks.back().block, Block::lines);
    EXPECT_TRUE(model.blocks.back().used);
    for (int joint = 0; joint < 3; ++joint) {
      std::vector<int> wanted{1, 2, 3, 4};
      if (joint == line.joint) wanted.push_back(line.order);
      EXPECT_EQ(model.arm.terms().transmission[static_cast<std::size_t>(joint)].orders, wanted);
    }
    const Index last = model.arm.num_dense() - model.arm.terms().num_dense_terms() +
                       model.arm.terms().transmission_begin(line.joint + 1) - 1;
    EXPECT_EQ(model.arm.scales()(last), 7e-6);
    const auto estimate = joint_spectrum(model, line.joint).back();
    EXPECT_EQ(estimate.order, line.order);
    EXPECT_NEAR(estimate.amplitude, line.amplitude, 3.5 * estimate.std);
    EXPECT_LT(estimate.std, 5e-6);
  }
}

TEST(JointSpectrum, LinesAreSoughtWhereThatIsAllowed) {
  ErrorModelOptions few = options();
  few.spectrum = {{1, 4, 100e-6}};
  few.find_lines = false;
  Rng rng(1);
  const auto model = fitted(arm_with({{1, 1873, 40e-6, 0.7}}, rng), few, rng);
  for (const BlockChoice& block : model.blocks) EXPECT_NE(block.block, Block::lines);
}

TEST(JointSpectrum, LinesOfAStatedDriveAreInTheModel) {
  ErrorModelOptions few = options();
  few.spectrum = {{1, 4, 100e-6}};
  few.drives = {{}, {.gear_ratio = 101}, {}};
  Rng rng(5);
  const Line line{1, 1010, 40e-6, 0.7};
  const auto model = fitted(arm_with({line}, rng), few, rng);
  EXPECT_NE(model.blocks.back().block, Block::lines);
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
    blocks += model.blocks.back().block == Block::lines;
    for (int joint = 0; joint < 3; ++joint)
      for (const HarmonicEstimate& one : lines_in(joint_spectrum(model, joint), line_threshold(108)))
        lines += one.order > 4;
  }
  EXPECT_LE(lines, 1);  // one in a hundred
  EXPECT_LE(blocks, 1);
}

// What the measurements alone say, by hand: the information of the two coefficients of an order is I, their estimate
// (6, -8) or so; the fit had priors P on them, so it found (I + P)^-1 I (6, -8) with the covariance (I + P)^-1.
TEST(JointSpectrum, IsTheEstimateWithoutPriors) {
  const DhChain<3> chain = nominal;
  ErrorModelEstimate estimate{.arm = ArmParameterisation({ArmGeometry(Framed<Chain>(chain))}, {{0, -1, 1e-3, 0}})};
  JointTerms terms(3);
  terms.gear_ratio = true;
  terms.transmission[0] = Fourier::up_to(1);
  terms.transmission[2] = {{2, 5, 9}};
  estimate.arm.set_terms(terms, VectorX::Constant(11, 2e-6), vector({1, 1, 1, 1, 1, 2, 5, 3, 3, 4, 7}));
  const std::array informations{RealMatrix(2, 2, {4, 1, 1, 3}), RealMatrix(2, 2, {1, 2, 2, 4}),
                                RealMatrix(2, 2, {9, -2, -2, 16})};
  const std::array values{vector({6, -8}), vector({1, 1}), vector({0, 2})};
  RealMatrix covariance = RealMatrix::identity(12);
  VectorX steps = VectorX::Ones(12);
  for (Index k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const RealMatrix precisions = RealMatrix::diagonal(RealMatrix(estimate.arm.precisions()).block(6 + 2 * k, 0, 2, 1));
    const RealMatrix inverse = (informations[at] + precisions).inverse();
    const RealMatrix found = inverse * informations[at] * values[at];
    covariance.set_block(6 + 2 * k, 6 + 2 * k, inverse);
    for (Index i = 0; i < 2; ++i) steps(6 + 2 * k + i) = found(i);
  }
  estimate.arm.move(steps);
  estimate.residual_variance = 2;
  estimate.variance_factor = 0.5;  // of the covariance
  estimate.covariance = 0.5 * covariance;
  const auto spectrum = joint_spectrum(estimate, 2);
  ASSERT_EQ(spectrum.size(), 2u);  // of order 5 one combination is not determined
  EXPECT_EQ(spectrum[0].order, 2);
  EXPECT_NEAR(spectrum[0].amplitude, 20e-6, 1e-15);
  // along (0.6, -0.8): inverse of [4 1; 1 3] is [3 -1; -1 4] / 11, so 4.6 / 11
  EXPECT_NEAR(spectrum[0].std, 2e-6 * std::sqrt(2 * 4.6 / 11), 1e-15);
  EXPECT_NEAR(spectrum[0].margin(), 1.96 * spectrum[0].std, 1e-20);
  EXPECT_NEAR(spectrum[0].chi_square, (4 * 36 - 2 * 48 + 3 * 64) / 2.0, 1e-9);
  EXPECT_EQ(spectrum[1].order, 9);
  EXPECT_NEAR(spectrum[1].amplitude, 4e-6, 1e-15);
  EXPECT_NEAR(spectrum[1].std, 2e-6 * std::sqrt(2 * 9 / 140.0), 1e-15);
  EXPECT_NEAR(spectrum[1].chi_square, 16 * 4 / 2.0, 1e-9);
  EXPECT_TRUE(joint_spectrum(estimate, 1).empty());
}

// The smaller of two lines is only a neighbour if it is at most a quarter of its order away, and four. A threshold is
// one in a hundred of all orders in the tail of chi-square with two degrees of freedom.
TEST(JointSpectrum, LinesOfLowOrdersAreCloser) {
  const auto orders = [](const std::vector<HarmonicEstimate>& spectrum) {
    std::vector<int> out;
    for (const HarmonicEstimate& line : lines_in(spectrum, 10)) out.push_back(line.order);
    return out;
  };
  const auto one = [](int order, double amplitude) { return HarmonicEstimate{order, amplitude, 1, 10.5}; };
  EXPECT_EQ(orders({one(1, 5), one(2, 4), one(3, 3)}), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(orders({one(9, 5), one(12, 4), one(7, 3), one(6, 2)}), (std::vector<int>{9, 7}));
  EXPECT_EQ(orders({one(12, 5), one(9, 4)}), (std::vector<int>{12, 9}));
  EXPECT_EQ(orders({one(20, 3), one(24, 4), one(29, 2)}), (std::vector<int>{24, 29}));
  EXPECT_EQ(orders({one(100, 6), one(101, 7), one(105, 8)}), (std::vector<int>{105, 100}));
  EXPECT_TRUE(orders({{30, 9, 1, 10}, {40, 8, 1, 9}}).empty());  // not above the threshold
  EXPECT_NEAR(std::exp(-line_threshold(1000) / 2) * 1000, 0.01, 1e-12);
}

/// As many angles, all around.
VectorX around(Index n) {
  VectorX out(n);
  for (Index i = 0; i < n; ++i) out(i) = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
  return out;
}

/// Orders and amplitudes of what is left.
using Remainder = std::vector<std::pair<int, double>>;

/// Scores of unit weights for a remainder.
VectorX score_of(const Remainder& lines, const VectorX& angles) {
  VectorX out = VectorX::Zero(angles.size());
  for (Index i = 0; i < angles.size(); ++i)
    for (const auto& [order, amplitude] : lines) out(i) += amplitude * std::sin(order * angles(i) + order);
  return out;
}

// All around a turn orders are orthogonal: an amplitude of a in 202 values has a chi-square of 101 a^2.
TEST(PeriodogramWhiteBox, LinesAreTakenOneAfterTheOther) {
  const VectorX angles = around(202), ones = VectorX::Ones(202);
  const Remainder lines{{3, 1.0}, {40, 3.0}, {17, 2.0}, {60, 9.0}};
  const VectorX power = detail::periodogram(angles, score_of(lines, angles), ones, 60);
  for (int order = 1; order <= 60; ++order) {
    double amplitude = 0;
    for (const auto& line : lines) amplitude += line.first == order ? line.second : 0;
    EXPECT_NEAR(power(order - 1), 101 * amplitude * amplitude, 1e-8) << order;
  }
  const auto found = [&](const Remainder& of, const std::vector<int>& known, int highest, double threshold) {
    return detail::lines_of_residuals(angles, score_of(of, angles), ones, known, highest, threshold);
  };
  EXPECT_EQ(found(lines, {}, 60, 1), (std::vector<int>{60, 40, 17, 3}));
  EXPECT_EQ(found(lines, {}, 59, 1), (std::vector<int>{40, 17, 3}));
  EXPECT_EQ(found(lines, {2, 17, 60, 200}, 60, 1), (std::vector<int>{40, 3}));
  EXPECT_EQ(found(lines, {}, 60, 101 * 3.99), (std::vector<int>{60, 40, 17}));
  EXPECT_EQ(found(lines, {}, 60, 101 * 4.01), (std::vector<int>{60, 40}));
  EXPECT_TRUE(found({}, {}, 60, 1).empty());
  Remainder many;
  for (int k = 0; k < 10; ++k) many.push_back({5 * k + 1, 10.0 - k});
  EXPECT_EQ(found(many, {}, 60, 1), (std::vector<int>{1, 6, 11, 16, 21, 26, 31, 36}));  // eight
}

// Measured over a part of a turn, a line has side lobes, which must not be taken for lines.
TEST(PeriodogramWhiteBox, AnEchoIsNoLine) {
  Rng rng(4);
  VectorX angles(150), weight(150);
  for (Index i = 0; i < 150; ++i) {
    angles(i) = rng.uniform(-0.8, 0.8);
    weight(i) = rng.uniform(0.2, 2);
  }
  VectorX score = score_of({{30, 2.0}}, angles);
  for (Index i = 0; i < 150; ++i) score(i) *= weight(i);
  const VectorX power = detail::periodogram(angles, score, weight, 60);
  EXPECT_GT(power(28), 1);
  EXPECT_EQ(detail::lines_of_residuals(angles, score, weight, {}, 60, 1), (std::vector<int>{30}));
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

// Two sets of angles whose orders 150 are half a period apart: they cancel but for their difference, a share of the
// weight. All other orders up to 299 cancel altogether.
TEST(PeriodogramWhiteBox, OrdersUpToTwiceTheHighestAreToldApart) {
  const VectorX grid = around(300);
  const auto apart = [&](double share, int highest) {
    VectorX weight(300);
    for (Index i = 0; i < 300; ++i) weight(i) = i % 2 == 0 ? 1 + share : 1 - share;
    return detail::tells_orders_apart(grid, weight, highest);
  };
  EXPECT_TRUE(apart(0.48, 80));
  EXPECT_FALSE(apart(0.52, 80));
  EXPECT_FALSE(apart(0.52, 75));  // 2 * 75
  EXPECT_TRUE(apart(0.52, 74));
}

// Over a part of a turn of width s, orders that differ by k are correlated by sin(k s / 2) / (k s / 2): a half at
// k s = 3.79. Orders closer than forty need not be distinguishable.
TEST(PeriodogramWhiteBox, CloseOrdersNeedNotBeToldApart) {
  const VectorX ones = VectorX::Ones(2000);
  for (const auto& [width, apart] : {std::pair{3.6 / 40, false}, {4.0 / 40, true}})
    EXPECT_EQ(detail::tells_orders_apart(VectorX::LinSpaced(2000, 0, width), ones, 100), apart) << width;
}

}  // namespace
}  // namespace vernier::joint_spectrum_test
