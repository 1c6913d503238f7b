// SPDX-License-Identifier: BSD-3-Clause
// Base and tool frames in closed form, from exact poses, and from poses of which some are flipped.

#include "vernier/camera/hand_eye.hpp"

#include <gtest/gtest.h>

#include <array>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vn = vernier;

namespace hand_eye_test {
namespace {

vn::Isometry3 drawn(vn::Rng& rng, double angle) {
  const vn::Vector3 turn(rng.uniform(-angle, angle), rng.uniform(-angle, angle), rng.uniform(-angle, angle));
  return vn::rigid_motion(vn::exp_so3(turn), {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)});
}

double apart(const vn::Isometry3& a, const vn::Isometry3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

TEST(HandEyeOf, ExactPosesIsExact) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    vn::Rng rng(seed);
    const vn::Isometry3 base = drawn(rng, 2), tool = drawn(rng, 2);
    std::vector<vn::Isometry3> flanges, seen;
    for (int i = 0; i < 5; ++i) {
      flanges.push_back(drawn(rng, 1));
      seen.push_back(base * flanges.back() * tool);
    }
    const vn::HandEye found = vn::hand_eye(flanges, seen);
    EXPECT_LT(apart(found.base, base), 1e-9);
    EXPECT_LT(apart(found.tool, tool), 1e-9);
    EXPECT_GT(found.spread, 0.01);
  }
}

TEST(HandEyeOf, RotationsAboutOneAxisHasNoSpread) {
  vn::Rng rng(1);
  std::vector<vn::Isometry3> flanges, seen;
  for (int i = 0; i < 6; ++i) {
    flanges.push_back(vn::rigid_motion(vn::exp_so3(vn::Vector3(0, 0, rng.uniform(-2, 2))), {rng.uniform(-1, 1), 0, 0}));
    seen.push_back(flanges.back());
  }
  EXPECT_LT(vn::hand_eye(flanges, seen).spread, 1e-9);
}

TEST(ConsistentHandEye, ChoosesTheRightCandidates) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    vn::Rng rng(seed);
    const vn::Isometry3 base = drawn(rng, 2), tool = drawn(rng, 2);
    std::vector<vn::Isometry3> flanges;
    std::vector<std::array<vn::Isometry3, 2>> candidates;
    std::vector<std::size_t> right;
    for (int i = 0; i < 20; ++i) {
      flanges.push_back(drawn(rng, 1));
      const vn::Isometry3 truth = base * flanges.back() * tool;
      const vn::Isometry3 flipped =
          vn::rigid_motion(vn::exp_so3(vn::Vector3(rng.uniform(0.3, 1), 0, 0)) * truth.linear(), truth.translation());
      right.push_back(rng.uniform() < 0.3 ? 1 : 0);
      candidates.push_back(right.back() == 1 ? std::array{flipped, truth} : std::array{truth, flipped});
    }
    candidates[7] = {drawn(rng, 3), drawn(rng, 3)};  // wrong altogether
    const vn::HandEye found = vn::consistent_hand_eye(flanges, candidates);
    EXPECT_LT(apart(found.base, base), 1e-8) << seed;
    EXPECT_LT(apart(found.tool, tool), 1e-8) << seed;
    for (std::size_t i = 0; i < right.size(); ++i)
      EXPECT_TRUE(i == 7 || found.chosen[i] == right[i]) << seed << ", " << i;
  }
}

}  // namespace
}  // namespace hand_eye_test
