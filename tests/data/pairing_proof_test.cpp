// SPDX-License-Identifier: BSD-3-Clause
// What a proof of pairs reports, by the distances themselves, and what it must not be misled by.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/pair_search.hpp"
#include "vernier/data/detail/point_alignment.hpp"
#include "vernier/data/pair_points.hpp"

namespace vernier::pairing_proof_test {
namespace {

using Kind = PairingFault::Kind;

Vector3 drawn(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Random poses of a flange, and exact points of a reflector on it.
struct Measured {
  std::vector<Isometry3> flanges;
  PointRows points;

  Measured(Index n, double reach, double offset, Rng& rng) : points(n, 3) {
    const Isometry3 base = rigid_motion(exp_so3(Vector3(0.3, -0.5, 1)), Vector3(2, -1, 0.5));
    const Vector3 reflector = offset * Vector3(0.6, 0, 0.8);
    for (Index i = 0; i < n; ++i) {
      flanges.push_back(rigid_motion(exp_so3(drawn(rng, 1.5)), drawn(rng, reach)));
      set_point(points, i, transformed(base, transformed(flanges.back(), reflector)));
    }
  }
};

// The 90 % quantile three times, for nine unknowns fitted to sixty points, or the median six times; at least a tenth of
// a millimetre.
TEST(PairingProof, LimitAndMedianAreThoseOfTheDistances) {
  for (const double larger : {0.3e-3, 1.5e-3, 0.0}) {  // ten errors among fifty of 0.3 mm; none at all
    Rng rng(31);
    Measured session(60, 1, 0.1, rng);
    for (Index i = 0; i < 60; ++i) {
      const double size = larger == 0 ? 0 : i % 6 == 0 ? larger : 0.3e-3;
      set_point(session.points, i, point(session.points, i) + size * drawn(rng, 1).normalized());
    }
    const Pairing found = pair_by_order(session.flanges, session.points);
    ASSERT_TRUE(found.proof);
    ASSERT_EQ(found.proof->status, PairingStatus::proven);
    ASSERT_EQ(found.pairs.size(), 60u);
    std::vector<double> distances;
    for (Index i = 0; i < 60; ++i)
      distances.push_back((point(session.points, i) -
                           transformed(found.proof->base,
                                       transformed(session.flanges[static_cast<std::size_t>(i)], found.proof->offset)))
                              .norm());
    std::sort(distances.begin(), distances.end());
    const double median = distances[30], quantile = distances[54] * std::sqrt(60.0 / 57);
    EXPECT_NEAR(found.proof->median, median, 1e-9);
    EXPECT_NEAR(found.proof->limit, std::max(1e-4, std::min(3 * quantile, 6 * median)), 1e-9);
    EXPECT_TRUE(larger == 0 || (3 * quantile < 6 * median) == (larger == 0.3e-3));
  }
}

// A reflector far from a flange that hardly moves but turns: its points scatter twice as wide.
TEST(PairingProof, AReflectorFarOffIsNoWrongUnit) {
  Rng rng(32);
  const Measured session(40, 0.12, 0.3, rng);
  const Pairing found = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  EXPECT_GT(found.proof->spread_ratio, 1.6);
  EXPECT_LT(found.proof->spread_ratio, 2.9);
  EXPECT_NEAR(found.proof->offset.norm(), 0.3, 1e-4);
  EXPECT_NEAR(found.proof->scale, 1, 1e-4);
  EXPECT_EQ(found.proof->indistinct, 0);
}

// By name: the point of pose 5 is lost, and that of pose 12 lies where pose 5 was. That is one fault.
TEST(PairingProof, APointThatAnotherPoseTookIsNoMisfit) {
  Rng rng(33);
  Measured session(30, 1, 0.1, rng);
  Pairing named;
  for (Index i = 0; i < 30; ++i) named.pairs.push_back({i, i});
  set_point(session.points, 12, point(session.points, 5));
  set_point(session.points, 5, Vector3(9, 9, 9));
  const Pairing found = check_pairs(named, session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].kind, Kind::out_of_order);
  EXPECT_EQ(found.faults[0].rows.first, 5);
  EXPECT_EQ(found.faults[0].points.first, 12);
  EXPECT_EQ(found.pairs.size(), 29u);
}

// Three tenths of the names may be wrong, half of them may not.
TEST(PairingProof, MostPairsMustFit) {
  Rng rng(34);
  Measured session(40, 1, 0.1, rng);
  Pairing named;
  for (Index i = 0; i < 40; ++i) named.pairs.push_back({i, i});
  for (Index i = 28; i < 40; ++i) set_point(session.points, i, drawn(rng, 3));
  EXPECT_EQ(check_pairs(named, session.flanges, session.points).proof->status, PairingStatus::proven);
  for (Index i = 20; i < 28; ++i) set_point(session.points, i, drawn(rng, 3));
  EXPECT_EQ(check_pairs(named, session.flanges, session.points).proof->status, PairingStatus::unrelated);
}

// The limit of exact points is a tenth of a millimetre: poses nearer to the one before are counted.
TEST(PairingProof, CountsPosesThatCannotBeToldApart) {
  Rng rng(35);
  Measured session(40, 1, 0.1, rng);
  for (Index i = 1; i < 40; i += 2) {
    const Vector3 step(i % 4 == 1 ? 0.15e-3 : 0.05e-3, 0, 0);
    const Isometry3& before = session.flanges[static_cast<std::size_t>(i - 1)];
    session.flanges[static_cast<std::size_t>(i)] = rigid_motion(rotation(before), translation(before) + step);
    // the base turns the step with it
    set_point(session.points, i, point(session.points, i - 1) + exp_so3(Vector3(0.3, -0.5, 1)) * step);
  }
  const Pairing found = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  EXPECT_NEAR(found.proof->limit, 1e-4, 1e-12);
  EXPECT_EQ(found.proof->indistinct, 10);
}

// Links that are three thousandths too long, or a tracker's scale: the proof holds, and says so.
TEST(PairingProof, TellsTheScale) {
  Rng rng(38);
  Measured session(40, 1, 0.1, rng);
  for (const double scale : {1.003, 1003.0}) {
    Measured scaled = session;
    for (Index i = 0; i < 40; ++i) set_point(scaled.points, i, scale * point(session.points, i));
    const Pairing found = pair_by_order(scaled.flanges, scaled.points);
    EXPECT_EQ(found.proof->status, scale < 2 ? PairingStatus::proven : PairingStatus::wrong_unit);
    EXPECT_NEAR(found.proof->scale / scale, 1, 5e-4);
  }
}

TEST(PairingProof, TheFirstPoseMayBeSwapped) {
  Rng rng(36);
  Measured session(30, 1, 0.1, rng);
  Pairing named;
  for (Index i = 0; i < 30; ++i) named.pairs.push_back({i, i});
  const Vector3 first = point(session.points, 0);
  set_point(session.points, 0, point(session.points, 5));
  set_point(session.points, 5, first);
  const Pairing found = check_pairs(named, session.flanges, session.points);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].kind, Kind::swapped);
  EXPECT_EQ(found.faults[0].rows.first, 0);
  EXPECT_EQ(found.faults[0].rows.last, 5);
  EXPECT_EQ(found.faults[0].points.first, 5);
  EXPECT_EQ(found.faults[0].points.last, 0);
  EXPECT_EQ(found.pairs.size(), 30u);
}

// Where the flange only turns, its positions say nothing about the base, and the reflector's circles say all.
TEST(PairingProof, AFlangeThatOnlyTurns) {
  Rng rng(37);
  for (int repeat = 0; repeat < 20; ++repeat) {
    Measured session(15, 1e-3, 0.4, rng);
    const Isometry3 moved = rigid_motion(exp_so3(drawn(rng, 1.7)), drawn(rng, 2));
    std::vector<PointPair> pairs;
    for (Index i = 0; i < 15; ++i) {
      set_point(session.points, i, transformed(moved, point(session.points, i)));
      pairs.push_back({i, i});
    }
    const detail::PointFrames found = detail::fit_point_frames(session.flanges, session.points, pairs);
    EXPECT_LT(found.rms, 1e-6) << repeat;
    EXPECT_NEAR(found.offset.norm(), 0.4, 1e-5);
  }
}

/// Whether poses along a line, one beside it, would be as good shifted.
bool ambiguous(const std::vector<double>& steps, double beside, Index at = 0) {
  std::vector<Isometry3> flanges;
  PointRows points(20, 3);
  detail::PairSearch::Found found;
  found.limit = 0.01;
  double x = 0;
  for (Index i = 0; i < 20; ++i) {
    set_point(points, i, Vector3(x, i == at ? beside : 0, 0));
    flanges.push_back(rigid_motion(Matrix3::Identity(), point(points, i)));
    found.pairs.push_back({i, i});
    x += steps[static_cast<std::size_t>(i) % steps.size()];
  }
  return detail::PairSearch{flanges, points, true, {}}.ambiguous(found);
}

TEST(PairSearchWhiteBox, StepsThatRepeatAreAmbiguous) {
  EXPECT_TRUE(ambiguous({0.05}, 0));
  EXPECT_TRUE(ambiguous({0.05, 0.12}, 0));
  EXPECT_TRUE(ambiguous({0.05, 0.12, 0.2}, 0));
  EXPECT_FALSE(ambiguous({0.05, 0.12, 0.2, 0.3}, 0));  // four rows are not looked at
  EXPECT_TRUE(ambiguous({0.05}, 0.02));                // a single pair that does not fit proves nothing
  EXPECT_FALSE(ambiguous({0.05}, 0.015, 10));          // in the middle it spoils two pairs
}

}  // namespace
}  // namespace vernier::pairing_proof_test
