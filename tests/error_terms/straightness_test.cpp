// SPDX-License-Identifier: BSD-3-Clause
// Guides that are not straight: by hand, against moved frames of the chain, and derivatives.

#include "vernier/error_terms/straightness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier::straightness_test {
namespace {

using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::normals;
using vernier_test::stepped;

const std::vector<JointRange> four_ranges(4, {-1, 2});

/// A chain whose second and third joints slide.
template <class Convention>
DhChain<4, Convention> sliding_chain(Rng& rng) {
  auto rows = vernier_test::random_chain<4, Convention>(rng, {.prismatic = 0}).rows();
  rows[1].joint = rows[2].joint = JointType::prismatic;
  return DhChain<4, Convention>::from_rows(rows);
}

// A rail along z that sags: half a metre from its begin it is lower by cos(pi / 4), and beyond its end it stays.
TEST(Straightness, OfARailByHand) {
  const DhChain<2> arm({{.joint = JointType::prismatic}, {.a = 0.3}});
  const Straightness rail(detail::ChainTable(arm.view()), {{0, 2}, {0, 0}}, 2);
  ASSERT_EQ(rail.size(), 12);
  VectorX coefficients = VectorX::Zero(12);
  coefficients(0) = 1e-3;  // along x
  coefficients(7) = 1e-4;  // about x, second order
  const auto at = [&](double q) { return rail.motion(JointVector<2>(q, 0.4).data(), coefficients.data()); };
  EXPECT_NEAR(at(0.5)(0), 1e-3 * std::cos(std::numbers::pi / 4), 1e-18);
  EXPECT_NEAR(at(0.25)(3), 1e-4 * std::cos(std::numbers::pi / 4), 1e-18);
  EXPECT_NEAR(at(0.25)(1), 0.25 * 1e-4 * std::cos(std::numbers::pi / 4), 1e-18);  // the origin lies above that of base
  EXPECT_EQ(at(0.25)(2), 0);
  EXPECT_EQ(at(2)(0), at(3)(0));
  EXPECT_EQ(at(0)(0), at(-3)(0));
}

template <class Convention>
void expect_moved_frames() {
  Rng rng(3);
  for (int trial = 0; trial < 10; ++trial) {
    const auto arm = sliding_chain<Convention>(rng);
    JointTerms terms(4);
    terms.straightness.emplace(detail::ChainTable(arm.view()), four_ranges, 3);
    const Straightness& guides = *terms.straightness;
    ASSERT_EQ(guides.size(), 36);
    const JointErrors errors(terms, normals(rng, 36, 1e-7));
    const JointVector<4> q = vernier_test::random_joints<4>(rng, 0.9);
    // the chain up to each guide, the motion in its frame, the rest of the chain
    Isometry3 expected = arm.pose(q);
    for (int guide = 1; guide >= 0; --guide) {
      const int p = guide + 1;
      auto rows = arm.rows();
      for (int k = p; k < 4; ++k) {
        auto& row = rows[static_cast<std::size_t>(k)];
        if (k > p) row = {.joint = row.joint};
        if (k == p && !Convention::modified) row.a = row.alpha = row.beta = 0;  // behind the joint, before the link
      }
      JointVector<4> until = q;
      for (int k = p + 1; k < 4; ++k) until(k) = 0;
      const Isometry3 frame = DhChain<4, Convention>::from_rows(rows).pose(until);
      double motion[6] = {};
      const double u = (q(p) + 1) / 3;
      for (int component = 0; component < 6; ++component)
        for (int k = 1; k <= 3; ++k)
          motion[component] +=
              errors.coefficients()(18 * guide + 3 * component + k - 1) * std::cos(k * std::numbers::pi * u);
      const Isometry3 moved =
          rigid_motion(exp_so3(Vector3(motion[3], motion[4], motion[5])), Vector3(motion[0], motion[1], motion[2]));
      expected = frame * moved * frame.inverse() * expected;
    }
    Isometry3 found = arm.pose(q);
    errors.tilt(q.data(), found);
    EXPECT_LE((found.matrix() - expected.matrix()).norm(), 1e-11);

    MatrixX basis(6, 36);
    guides.basis(q.data(), basis);
    const Vector6 motion = guides.motion(q.data(), errors.coefficients().data());
    EXPECT_LE(difference(VectorX(motion), detail::product(basis, errors.coefficients())), 1e-18);

    double rates[24];
    (void)guides.motion(q.data(), errors.coefficients().data(), rates);
    const double h = 1e-5;
    for (int k = 0; k < 4; ++k) {
      const auto moved = [&](double step) {
        return guides.motion(stepped(q, k, step).data(), errors.coefficients().data());
      };
      const Vector6 slope = (moved(h) - moved(-h)) / (2 * h);
      for (int r = 0; r < 6; ++r) EXPECT_NEAR(rates[6 * k + r], slope(r), 1e-12) << k << ", " << r;
    }
  }
}

TEST(Straightness, MovesTheFrameBehindEachGuide) {
  expect_moved_frames<StandardDh>();
  expect_moved_frames<ModifiedDh>();
}

TEST(Straightness, BesideTiltsBothMoveTheEnd) {
  Rng rng(8);
  const auto arm = sliding_chain<StandardDh>(rng);
  JointTerms terms(4);
  terms.tilt.emplace(arm);
  terms.straightness.emplace(detail::ChainTable(arm.view()), four_ranges, 1);
  EXPECT_EQ(terms.names()[24], "straight2_x1");
  EXPECT_EQ(terms.names().back(), "straight3_rz1");
  EXPECT_EQ(terms.end_begin(), 0);
  const VectorX both = normals(rng, terms.size(), 1e-4);
  const JointVector<4> q = vernier_test::random_joints<4>(rng, 0.9);
  double rates[24], of_tilt[24], of_guides[24];
  const Vector6 sum = terms.end_motion(q.data(), {}, both.data(), rates);
  const Vector6 tilted = terms.tilt->motion(q.data(), both.data(), of_tilt),
                guided = terms.straightness->motion(q.data(), both.data() + 24, of_guides);
  EXPECT_LE((sum - tilted - guided).norm(), 1e-18);
  for (int k = 0; k < 24; ++k) EXPECT_NEAR(rates[k], of_tilt[k] + of_guides[k], 1e-18);
}

TEST(Straightness, RefusesRangesThatAreNone) {
  const detail::ChainTable chain(std::vector<DhRow>{{.joint = JointType::prismatic}, {.a = 0.3}}, false);
  EXPECT_EQ(complaint([&] { Straightness(chain, {{0, 1}, {0, 0}}); }), "");
  EXPECT_NE(complaint([&] { Straightness(chain, {{0, 0}, {0, 1}}); }), "");
  EXPECT_NE(complaint([&] { Straightness(chain, {{0, 1}}); }), "");
  EXPECT_NE(complaint([&] { Straightness(chain, {{0, 1}, {0, 0}}, 0); }), "");
}

}  // namespace
}  // namespace vernier::straightness_test
