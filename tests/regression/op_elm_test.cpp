// SPDX-License-Identifier: BSD-3-Clause
// Pruning by leave-one-out: the ranking and its errors against fits that leave each sample out.

#include "vernier/regression/op_elm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/detail/rank_nodes.hpp"

namespace vernier::op_elm_test {
namespace {

using testing::SampleWeights;
using namespace vernier_test;

/// Columns drawn at random, as no layer gives them: well conditioned.
RealMatrix random_columns(Index n, Index count) {
  Rng rng(3);
  MatrixX h(n, count);
  for (double& value : elements(h)) value = rng.normal();
  return h;
}

/// Weighted least squares by the pivoted QR of the rows themselves.
RealMatrix solve(const RealMatrix& design, const RealMatrix& y, const RealMatrix& w) {
  return scaled_rows(w.sqrt(), design).solve(scaled_rows(w.sqrt(), y));
}

double squared_error(const RealMatrix& design, const RealMatrix& y, const RealMatrix& w) {
  return scaled_rows(w.sqrt(), y - design * solve(design, y, w)).squared_norm();
}

TEST(RankNodes, PressEqualsLeavingEachSampleOut) {
  const Index n = 24;
  const Inputs x = inputs(n, 1);
  const RealMatrix y = RealMatrix::of(targets(x, 1e-4));
  const HiddenLayer layer{.nodes = 9, .activation = Activation::sine, .weight_limit = 2};
  const RealMatrix h = hidden_outputs(layer, x, layer.draw(3, 4));
  for (const VectorX& w : {VectorX(VectorX::Ones(n)), random_weights(n)}) {
    const detail::RankedNodes ranked = detail::rank_nodes(h, y, w);
    ASSERT_EQ(ranked.order.size(), 9u);
    ASSERT_EQ(ranked.press.size(), 10u);
    for (std::size_t count = 0; count <= 9; ++count) {
      const std::vector<Index> nodes(ranked.order.begin(), ranked.order.begin() + static_cast<std::ptrdiff_t>(count));
      const RealMatrix design = with_ones(columns_of(h, nodes));
      double sum = 0;
      for (Index left = 0; left < n; ++left) {
        const std::vector<Index> rest = vernier_test::all_but(left, n);
        const RealMatrix beta = solve(rows_of(design, rest), rows_of(y, rest), samples_of(w, rest));
        sum += w(left) * (y.row(left) - design.row(left) * beta).squared_norm();
      }
      EXPECT_NEAR(ranked.press[count], sum / w.sum(), 1e-8 * sum / w.sum()) << count;
    }
  }
}

// Each node taken is the one whose addition lowers the error of all outputs together by the most.
TEST(RankNodes, TakesTheBestNodeEachTime) {
  const Index n = 40;
  const RealMatrix h = random_columns(n, 8), y = random_columns(n, 10).block(0, 8, n, 2);
  const VectorX w = random_weights(n);
  const detail::RankedNodes ranked = detail::rank_nodes(h, y, w);
  ASSERT_EQ(ranked.order.size(), 8u);
  std::vector<Index> taken;
  for (const Index next : ranked.order) {
    std::vector<Index> trial = taken;
    trial.push_back(next);
    const double chosen = squared_error(with_ones(columns_of(h, trial)), y, w);
    for (Index other = 0; other < 8; ++other) {
      if (other == next || std::find(taken.begin(), taken.end(), other) != taken.end()) continue;
      trial.back() = other;
      EXPECT_GT(squared_error(with_ones(columns_of(h, trial)), y, w), chosen);
    }
    taken.push_back(next);
  }
}

TEST(RankNodes, LeavesOutWhatDependsOnOthersAndWhatReproducesSamples) {
  RealMatrix h = random_columns(30, 6);
  h.set_block(0, 2, h.col(0) + h.col(1));
  h.set_block(0, 5, vernier_test::filled(30, 1, 3));  // the mean is free already
  const RealMatrix y = random_columns(30, 9).block(0, 7, 30, 2);
  const detail::RankedNodes ranked = detail::rank_nodes(h, y, VectorX::Ones(30));
  EXPECT_EQ(ranked.order.size(), 4u);
  EXPECT_EQ(std::count(ranked.order.begin(), ranked.order.end(), 5), 0);
  // as many columns as samples: the last count reproduces them all and may not be chosen
  const detail::RankedNodes full = detail::rank_nodes(random_columns(8, 20), top(y, 8), VectorX::Ones(8));
  EXPECT_EQ(full.order.size(), 7u);
  EXPECT_TRUE(std::isinf(full.press.back()));
  for (std::size_t i = 0; i < 7; ++i) EXPECT_TRUE(std::isfinite(full.press[i]));
}

// What is kept is the least-squares fit of as many nodes as PRESS asks for.
TEST(OpElm, KeepsTheLeastPress) {
  const Inputs x = inputs(150, 6), fresh = inputs(40, 7);
  const Targets y = targets(x, 1e-4);
  const VectorX w = random_weights(150);
  const OpElm recipe{.hidden_nodes = 60, .activation = Activation::tanh, .weight_limit = 2};
  const VectorX theta = recipe.layer().draw(3, 2);
  const RealMatrix h = hidden_outputs(recipe.layer(), recipe.layer().map(x), theta),
                   h_fresh = hidden_outputs(recipe.layer(), recipe.layer().map(fresh), theta);
  for (const VectorX* weights : {static_cast<const VectorX*>(nullptr), &w}) {
    const VectorX used = weights != nullptr ? w : VectorX(VectorX::Ones(150));
    const auto predictor = recipe.fit(x, y, {.seed = 2, .weights = weights});
    const detail::RankedNodes ranked = detail::rank_nodes(h, y, used);
    const auto kept = std::min_element(ranked.press.begin(), ranked.press.end()) - ranked.press.begin();
    EXPECT_GT(kept, 5);
    EXPECT_LT(kept, 50);
    ASSERT_EQ(predictor.layer().nodes, kept);
    const std::vector<Index> nodes(ranked.order.begin(), ranked.order.begin() + kept);
    const RealMatrix beta = solve(with_ones(columns_of(h, nodes)), RealMatrix::of(y), used);
    EXPECT_LT(difference(predictor.predict(fresh), with_ones(columns_of(h_fresh, nodes)) * beta), 1e-9);
  }
}

TEST(OpElm, WithNothingToLearnTheMeanIsLeft) {
  const Inputs x = inputs(40, 10);
  const Targets constant = Targets::Constant(40, 2, 3.25);
  const auto predictor = OpElm{}.fit(x, constant);
  EXPECT_LT(difference(predictor.predict(x), constant), 1e-12);
  const auto single = OpElm{}.fit(x.topRows(1), constant.topRows(1));
  EXPECT_LT(difference(single.predict(x), constant), 1e-15);
  // a target that one sample alone has: leaving samples out says keep the mean
  Targets spike = Targets::Zero(40, 2);
  spike(3, 0) = 1;
  const auto calm = OpElm{.hidden_nodes = 3}.fit(x, spike, {.seed = 1});
  EXPECT_EQ(calm.layer().nodes, 1);
  EXPECT_LT(calm.derivative(Vector3(0, 0, 0)).norm(), 1e-15);
}

TEST(OpElm, KeepsTheLaws) {
  for (const Activation activation : activations)
    for (const InputMap map : input_maps)
      expect_laws(OpElm{.hidden_nodes = 15, .activation = activation, .input_map = map},
                  {.weights = SampleWeights::taken, .weight_tolerance = 1e-8});
}

static_assert(Regressor<OpElm>);

}  // namespace
}  // namespace vernier::op_elm_test
