// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The laws of regressors, and the memory that predictors take.

#include <gtest/gtest.h>

#include "allocation_counter.hpp"
#include "laws.hpp"
#include "regression_samples.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier_test {

/// `expect_laws(Elm{}, {.weights = SampleWeights::taken})`
template <class R>
void expect_laws(const R& recipe, const vernier::testing::RegressorLaws& laws) {
  EXPECT_TRUE(no_violations(vernier::testing::regressor_violations(recipe, laws)));
}

/// Predictions of one sample take no memory. Those of rows do, so the counter counts.
template <class P>
void expect_no_allocations(const P& predictor) {
  const vernier::Vector3 at(0.1, -0.2, 0.3);
  EXPECT_EQ(allocations([&] {
              keep(predictor.predict(at));
              keep(predictor.derivative(at));
              if constexpr (vernier::UncertainPredictor<P>) keep(predictor.standard_deviation(at));
            }),
            0);
  EXPECT_GT(allocations([&] { keep(predictor.predict(inputs(60, 12))); }), 0);
}

}  // namespace vernier_test
