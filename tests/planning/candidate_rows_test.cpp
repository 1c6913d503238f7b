// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/planning/detail/candidate_rows.hpp"

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/planning/pose_design.hpp"

namespace vernier::candidate_rows_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

RealMatrix random(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  RealMatrix out(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) out(i, j) = rng.normal();
  return out;
}

/// Candidates of two rows: three dense unknowns, groups of two, none, and four functions.
detail::CandidateRows some_rows(Index candidates) {
  return {2, random(3, 2 * candidates, 1), random(3, 2 * candidates, 2), random(6, candidates, 3), {2, 0, 4}};
}

/// Entry by entry, from the definition.
RealMatrix by_hand(const detail::CandidateRows& rows) {
  RealMatrix out(rows.unknowns(), rows.dense.cols());
  for (Index column = 0; column < out.cols(); ++column)
    for (Index k = 0; k < 9; ++k)
      out(k, column) =
          k < 3 ? rows.dense(k, column) : rows.factors(k < 5 ? 0 : 2, column) * rows.functions(k - 3, column / 2);
  return out;
}

TEST(CandidateRows, AreProductsOfFactorsAndFunctions) {
  const detail::CandidateRows rows = some_rows(30);
  const RealMatrix all = by_hand(rows), directions = random(9, 5, 4);
  EXPECT_EQ(rows.size(), 30);
  EXPECT_LE(difference(rows.columns(0, 30), all), 1e-15);
  EXPECT_LE(difference(rows.columns(7, 4), all.block(0, 14, 9, 8)), 1e-15);
  EXPECT_LE(difference(rows.products(directions, 7, 4), directions.transpose() * all.block(0, 14, 9, 8)), 1e-13);
  EXPECT_LE(difference(rows.products(directions, 0, 30), directions.transpose() * all), 1e-13);
}

// More choices than the eight after which the covariance is brought up to date.
TEST(CandidateRows, GiveTheDesignOfTheirMatrix) {
  const detail::CandidateRows rows = some_rows(60);
  const MatrixX all = by_hand(rows).transpose(), measured = random(5, 9, 5), region = random(12, 9, 6);
  for (const auto criterion : {DesignCriterion::information, DesignCriterion::region_variance}) {
    const PoseDesign of_parts = detail::design_poses(rows, {30, criterion, {}}, measured, region),
                     of_matrix = design_poses(all, 2, {30, criterion, {}}, measured, region);
    EXPECT_EQ(of_parts.chosen, of_matrix.chosen);
    EXPECT_LE(difference(of_parts.log_det, of_matrix.log_det), 1e-11);
    EXPECT_LE(difference(of_parts.region_variance, of_matrix.region_variance), 1e-11);
  }
}

}  // namespace
}  // namespace vernier::candidate_rows_test
