// SPDX-License-Identifier: BSD-3-Clause
// Accuracy and repeatability after ISO 9283: cases worked by hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "iso9283_visits.hpp"
#include "real_matrix.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/evaluation/iso9283_poses.hpp"

namespace iso9283_test {
namespace {

using namespace vernier;
using namespace vernier_test;

const double nan = std::numeric_limits<double>::quiet_NaN();

bool all_nan(const Vector3& a) { return std::isnan(a(0)) && std::isnan(a(1)) && std::isnan(a(2)); }

TEST(Iso9283, FiveVisitsByHand) {
  const std::vector<Isometry3> commanded{pose_of({1, 2, 3}, {0.3, 1.2, -0.8})};
  // positions relative to the command [mm], angles about z [mrad]
  const std::vector<Vector3> positions{{1, 0, 0}, {3, 0, 0}, {2, 1, 0}, {2, -1, 0}, {2, 0, 0}};
  const std::vector<double> angles{1, 3, 2, 2, 2};
  std::vector<Iso9283Visit> visits;
  for (int k = 0; k < 5; ++k) {
    const auto i = static_cast<std::size_t>(k);
    visits.push_back({1, k + 1, 0, moved_by(commanded[0], 1e-3 * positions[i], Vector3(0, 0, 1e-3 * angles[i]))});
  }
  const Iso9283 result = iso9283(visits, commanded);
  ASSERT_EQ(result.poses.size(), 1u);
  const Iso9283Pose& pose = result.poses[0];
  EXPECT_EQ(pose.pose, 1);
  EXPECT_EQ(pose.n, 5);
  // barycentre (2, 0, 0)
  EXPECT_NEAR(pose.ap, 2e-3, 1e-15);
  EXPECT_LT((pose.ap_xyz - Vector3(2e-3, 0, 0)).norm(), 1e-15);
  // l = 1 1 1 1 0: mean 0.8, variance (4 x 0.04 + 0.64) / 4 = 0.2
  EXPECT_NEAR(pose.rp, (0.8 + 3 * std::sqrt(0.2)) * 1e-3, 1e-15);
  // variances 2 / 4, 2 / 4, 0; AP^2 - 1 / 5 = 3.8
  EXPECT_LT((pose.rp_xyz - 3e-3 * Vector3(std::sqrt(0.5), std::sqrt(0.5), 0)).norm(), 1e-15);
  EXPECT_NEAR(pose.ap_debiased, std::sqrt(3.8) * 1e-3, 1e-15);
  // angles: mean 2, variance 2 / 4
  EXPECT_LT((pose.ap_abc - Vector3(0, 0, 2e-3)).norm(), 1e-15);
  EXPECT_LT((pose.rp_abc - Vector3(0, 0, 3e-3 * std::sqrt(0.5))).norm(), 1e-15);
  EXPECT_LT((RealMatrix(pose.mean) - moved_by(commanded[0], {2e-3, 0, 0}, {0, 0, 2e-3})).norm(), 1e-14);
  EXPECT_LE(pose.rp_low, pose.rp * (1 + 1e-12));  // equal for these distances
  EXPECT_GT(pose.rp_high, pose.rp);
  EXPECT_TRUE(std::isnan(pose.ap_registered));  // one pose determines no registration
  EXPECT_FALSE(result.registration);
  EXPECT_FALSE(result.distance);
  EXPECT_TRUE(result.variations.empty());
  EXPECT_TRUE(result.drift.empty());
}

TEST(Iso9283, ScatterLargerThanItsErrorLeavesNoAccuracy) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  const std::vector<Iso9283Visit> visits{{1, 1, 0, pose_of({1, 0, 0})}, {1, 2, 0, pose_of({-0.8, 0, 0})}};
  EXPECT_EQ(iso9283(visits, commanded).poses[0].ap_debiased, 0);  // 0.1^2 - 1.62 / 2 < 0
}

/// RP of positions that are drawn some times each, and its standard error by the influence of each: by hand, in one
/// sum.
std::pair<double, double> drawn_repeatability(const std::vector<Vector3>& points, const std::vector<int>& times) {
  double n = 0, mean = 0, squares = 0, influences = 0;
  Vector3 centre = Vector3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    n += times[k];
    centre += times[k] * points[k];
  }
  centre /= n;
  std::vector<double> l;
  for (const Vector3& one : points) l.push_back((one - centre).norm());
  for (std::size_t k = 0; k < points.size(); ++k) mean += times[k] * l[k] / n;
  for (std::size_t k = 0; k < points.size(); ++k) squares += times[k] * (l[k] - mean) * (l[k] - mean);
  const double variance = squares / (n - 1), s = std::sqrt(variance);
  for (std::size_t k = 0; k < points.size(); ++k) {  // of the mean, and of three deviations
    const double off = l[k] - mean, influence = off + 3 * (off * off - variance) / (2 * s);
    influences += times[k] * influence * influence;
  }
  return {mean + 3 * s, std::sqrt(influences) / n};
}

/// All values of t of equally probable draws of visits, rising; those of one visit alone and of visits at equal
/// distances have none.
std::vector<double> all_draws(const std::vector<Vector3>& points) {
  const std::size_t n = points.size();
  const auto all = drawn_repeatability(points, std::vector<int>(n, 1));
  std::vector<double> out;
  for (int draw = 0; draw < std::pow(n, n); ++draw) {
    std::vector<int> times(n, 0);
    for (std::size_t k = 0, rest = static_cast<std::size_t>(draw); k < n; ++k, rest /= n) ++times[rest % n];
    const auto twice = std::count(times.begin(), times.end(), 2), never = std::count(times.begin(), times.end(), 0);
    if (never == static_cast<std::ptrdiff_t>(n) - 1 || (n == 4 && twice == 2)) continue;
    const auto one = drawn_repeatability(points, times);
    out.push_back((one.first - all.first) / one.second);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Expects the interval of visits at some places [mm], from the quantiles of t.
void expect_interval(const std::vector<Vector3>& points, double low, double high) {
  const auto all = drawn_repeatability(points, std::vector<int>(points.size(), 1));
  const std::vector<Isometry3> commanded(2, pose_of({0, 0, 0}));  // equal visits of two poses, with draws of their own
  std::vector<Iso9283Visit> visits;
  for (const int pose : {1, 2})
    for (std::size_t k = 0; k < points.size(); ++k)
      visits.push_back({pose, static_cast<int>(k) + 1, 0, pose_of(1e-3 * points[k])});
  for (const Iso9283Pose& pose : iso9283(visits, commanded, {.draws = 20'000}).poses) {
    EXPECT_NEAR(pose.rp, 1e-3 * all.first, 1e-15);
    EXPECT_NEAR(pose.rp_low, 1e-3 * std::max(0.0, all.first - high * all.second), 1e-12);
    EXPECT_NEAR(pose.rp_high, 1e-3 * (all.first - low * all.second), 1e-12);
  }
}

// Of four visits there are 256 equally probable draws; 40 are of one visit alone or of two twice each, at equal
// distances. Both quantiles of t are shared by several draws: no matter how often a seed makes each.
TEST(Iso9283, IntervalOfFourVisitsByAllDraws) {
  const std::vector<Vector3> points{{0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 2}};
  const std::vector<double> t = all_draws(points);
  ASSERT_EQ(t.size(), 216u);
  const double low = t[5], high = t[210];  // at 2.5 % and 97.5 % of 215
  for (const std::size_t same_low : {0u, 11u}) ASSERT_NEAR(t[same_low], low, 1e-9);
  for (const std::size_t same_high : {208u, 211u}) ASSERT_NEAR(t[same_high], high, 1e-9);
  expect_interval(points, low, high);
}

// Of five visits there are 3125 draws. Of these the 2.5 % of the smallest t end within several equal ones, and so do
// the 97.5 %; the 3.75 % end farther on.
TEST(Iso9283, IntervalOfFiveVisitsByAllDraws) {
  const std::vector<Vector3> points{{3, 2, 2}, {1, 2, 3}, {0, 0, 1}, {3, 3, 2}, {2, 3, 2}};
  const std::vector<double> t = all_draws(points);
  ASSERT_EQ(t.size(), 3120u);
  const double low = t[77], high = t[3040];
  for (const std::size_t same_low : {61u, 98u}) ASSERT_NEAR(t[same_low], low, 1e-9);
  for (const std::size_t same_high : {3011u, 3068u}) ASSERT_NEAR(t[same_high], high, 1e-9);
  ASSERT_GT(t[116], low + 1);
  expect_interval(points, low, high);
}

// Three visits have an interval whatever is drawn; of draws of one visit alone it is RP itself.
TEST(Iso9283, IntervalsOfNoDrawsAndOfOne) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  const std::vector<Iso9283Visit> visits{
      {1, 1, 0, pose_of({0, 0, 0})}, {1, 2, 0, pose_of({3e-3, 0, 0})}, {1, 3, 0, pose_of({0, 1e-3, 0})}};
  const Iso9283Pose none = iso9283(visits, commanded, {.draws = 0}).poses[0];
  EXPECT_TRUE(std::isnan(none.rp_low) && std::isnan(none.rp_high));
  int itself = 0, other = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Iso9283Pose one = iso9283(visits, commanded, {.draws = 1, .seed = seed}).poses[0];
    ASSERT_TRUE(std::isfinite(one.rp_low) && one.rp_low == one.rp_high) << seed;
    ++(std::abs(one.rp_low - one.rp) < 1e-15 ? itself : other);
  }
  EXPECT_GT(itself, 10);  // a third of the draws: one visit alone, or each once
  EXPECT_LT(itself, 60);
  EXPECT_GT(other, 0);
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

TEST(Iso9283, SameSeedSameBitsWhateverTheOrder) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4}, exp_so3(Vector3(0, 3, 0)));
  std::vector<Iso9283Visit> visits = visits_of(poses, 30, 1e-5, 1e-5, 4);
  const Iso9283 first = iso9283(visits, poses), other = iso9283(visits, poses, {.seed = 2});
  std::reverse(visits.begin(), visits.end());
  const Iso9283 again = iso9283(visits, poses);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_TRUE(same(first.poses[k].rp_low, again.poses[k].rp_low) && same(first.poses[k].rp, again.poses[k].rp) &&
                same(first.poses[k].rp_high, again.poses[k].rp_high) && first.poses[k].ap == again.poses[k].ap &&
                first.poses[k].rp_abc == again.poses[k].rp_abc);
    EXPECT_NE(first.poses[k].rp_low, other.poses[k].rp_low);
    EXPECT_NEAR(first.poses[k].rp_low, other.poses[k].rp_low, 0.1 * first.poses[k].rp);
  }
}

// Poses with equal visits have intervals by different draws, so that chance does not favour or spoil all poses alike.
TEST(Iso9283, EveryPoseHasDrawsOfItsOwn) {
  const std::vector<Isometry3> commanded(2, pose_of({0, 0, 0}));
  std::vector<Iso9283Visit> visits = visits_of(std::span(commanded).first(1), 30, 1e-5, 0, 4);
  for (int cycle = 0; cycle < 30; ++cycle) {
    visits.push_back(visits[static_cast<std::size_t>(cycle)]);
    visits.back().pose = 2;
  }
  const Iso9283 result = iso9283(visits, commanded, {.draws = 200});
  EXPECT_EQ(result.poses[0].rp, result.poses[1].rp);
  EXPECT_NE(result.poses[0].rp_high, result.poses[1].rp_high);
}

TEST(Iso9283, IntervalsOfFewOrEqualVisits) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0}), pose_of({1, 0, 0}), pose_of({0, 1, 0}),
                                         pose_of({0, 0, 0})};
  std::vector<Iso9283Visit> visits{
      {1, 1, 0, pose_of({1e-3, 0, 0})}, {2, 1, 0, pose_of({1, 0, 0})}, {2, 2, 0, pose_of({1, 2e-3, 0})}};
  for (int cycle = 1; cycle <= 4; ++cycle) visits.push_back({3, cycle, 0, pose_of({0, 1, 1e-3})});
  for (const Vector3& at : {Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)})
    visits.push_back({4, static_cast<int>(visits.size()), 0, pose_of(at)});  // on a circle: no standard error
  const Iso9283 result = iso9283(visits, commanded);
  EXPECT_EQ(result.poses[0].ap, 1e-3);
  EXPECT_TRUE(std::isnan(result.poses[0].rp) && std::isnan(result.poses[0].rp_abc.x()));
  EXPECT_TRUE(std::isnan(result.poses[0].ap_debiased));
  EXPECT_TRUE(std::isnan(result.poses[0].rp_low));
  EXPECT_NEAR(result.poses[1].rp, 1e-3, 1e-15);  // both distances are 1 mm
  EXPECT_TRUE(std::isnan(result.poses[1].rp_low));
  EXPECT_NEAR(result.poses[2].rp, 0, 1e-15);
  EXPECT_EQ(result.poses[2].rp_low, result.poses[2].rp);
  EXPECT_EQ(result.poses[2].rp_high, result.poses[2].rp);
  for (const double value : {result.poses[3].rp, result.poses[3].rp_low, result.poses[3].rp_high}) EXPECT_EQ(value, 1);
}

// Angles are not differences of Euler angles: at a pitch of 90 degrees those would be without bounds.
TEST(Iso9283, AnglesAtTheSingularityOfEulerAngles) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0}, {0, std::numbers::pi / 2, 0})};
  const Iso9283Pose pose = iso9283(visits_of(commanded, 20'000, 1e-5, 1e-3, 5), commanded, {.draws = 0}).poses[0];
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(pose.rp_abc(k), 3e-3, 5e-5);
    EXPECT_NEAR(pose.ap_abc(k), 0, 3e-5);
  }
}

TEST(Iso9283, MeanRotation) {
  Rng rng(6);
  std::vector<Matrix3> rotations;
  const Matrix3 centre = exp_so3(Vector3(2, -1, 1.5));
  for (int k = 0; k < 20; ++k) rotations.emplace_back(exp_so3(normal3(rng, 0.3)) * centre);
  const Matrix3 mean = detail::karcher_mean(rotations);
  const auto cost = [&](const Matrix3& at) { return detail::rotation_vectors_from(rotations, at).squaredNorm(); };
  for (int k = 0; k < 3; ++k)
    for (const double step : {-1e-3, 1e-3})
      EXPECT_GT(cost(exp_so3(Vector3(step * Vector3::Unit(k))) * mean), cost(mean));
  EXPECT_LT((mean * mean.transpose() - Matrix3::Identity()).norm(), 1e-14);
}

TEST(Iso9283, RegistrationTakesOutTheFrame) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  const Isometry3 frame = pose_of({1e-3, 2e-3, -1e-3}, {1e-3, 0, 2e-3});
  std::vector<Isometry3> moved;
  for (const Isometry3& pose : poses) moved.push_back(composed(frame, pose));
  const Iso9283 exact = iso9283(visits_of(moved, 3, 0, 0, 7), poses);
  ASSERT_TRUE(exact.registration);
  EXPECT_LT((RealMatrix(*exact.registration) - frame).norm(), 1e-14);
  for (const Iso9283Pose& pose : exact.poses) {
    EXPECT_LT(pose.ap_registered, 1e-14);
    EXPECT_GT(pose.ap, 1e-3);
  }
  // with scatter, beside the library's other registration
  const Iso9283 result = iso9283(visits_of(moved, 3, 1e-4, 0, 8), poses);
  PointRows from(5, 3), to(5, 3);
  for (Index k = 0; k < 5; ++k) {
    set_point(from, k, translation(poses[static_cast<std::size_t>(k)]));
    set_point(to, k, translation(result.poses[static_cast<std::size_t>(k)].mean));
  }
  EXPECT_LT((RealMatrix(*result.registration) - register_points(from, to)).norm(), 1e-12);
  const std::vector<Isometry3> line{pose_of({0, 0, 0}), pose_of({1, 1, 0}), pose_of({2, 2, 0})};
  EXPECT_FALSE(iso9283(visits_of(line, 3, 1e-4, 0, 9), line).registration);
}

// Three poses beside one line have a registration; rounding does not take them off it.
TEST(Iso9283, ThreePosesHaveARegistrationUnlessOnALine) {
  const auto three = [](double aside) {
    std::vector<Isometry3> out;
    for (const double k : {1.0, 2.0, 5.0}) out.push_back(pose_of({0.1 * k, 0.7 / 3 * k, 0.3 * k + aside * k * k}));
    return out;
  };
  const auto triangle = three(0.1), line = three(0);
  const Iso9283 found = iso9283(visits_of(triangle, 3, 1e-4, 0, 9), triangle, {.draws = 0});
  EXPECT_TRUE(found.registration);
  for (const Iso9283Pose& pose : found.poses) EXPECT_LT(pose.ap_registered, 1e-3);
  EXPECT_FALSE(iso9283(visits_of(line, 3, 1e-4, 0, 9), line, {.draws = 0}).registration);
}

// Nothing depends on the frame but the components; of them the root of the squares does not.
TEST(Iso9283, TheFrameDoesNotMatter) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4}, exp_so3(Vector3(0, 3, 0)));
  std::vector<Iso9283Visit> visits = visits_of(poses, 30, 1e-5, 1e-4, 12);
  for (int k = 1; k <= 2; ++k)
    for (int cycle = 1; cycle <= 5; ++cycle)
      visits.push_back({1, cycle, k, composed(poses[0], pose_of({1e-4 * k, 1e-5 * cycle, 0})), 1e6 + cycle});
  const Isometry3 frame = pose_of({3, -2, 1}, {1, 2, -0.5});
  std::vector<Isometry3> moved;
  for (const Isometry3& pose : poses) moved.push_back(composed(frame, pose));
  const Iso9283 here = iso9283(visits, poses);
  for (Iso9283Visit& visit : visits) visit.measured = composed(frame, visit.measured);
  const Iso9283 there = iso9283(visits, moved);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(here.poses[k].ap, there.poses[k].ap, 1e-13);
    EXPECT_NEAR(here.poses[k].ap_debiased, there.poses[k].ap_debiased, 1e-13);
    EXPECT_NEAR(here.poses[k].ap_registered, there.poses[k].ap_registered, 1e-13);
    EXPECT_NEAR(here.poses[k].rp, there.poses[k].rp, 1e-13);
    EXPECT_NEAR(here.poses[k].rp_high, there.poses[k].rp_high, 1e-13);
    EXPECT_NEAR(here.poses[k].rp_abc.norm(), there.poses[k].rp_abc.norm(), 1e-13);
    EXPECT_LT((rotation(frame) * here.poses[k].ap_abc - there.poses[k].ap_abc).norm(), 1e-13);
  }
  EXPECT_NEAR(here.distance->ad, there.distance->ad, 1e-13);
  EXPECT_NEAR(here.distance->rd, there.distance->rd, 1e-13);
  EXPECT_NEAR(here.variations.at(0).vap, 1e-4, 1e-13);
  EXPECT_NEAR(there.variations.at(0).vap, 1e-4, 1e-13);
  EXPECT_EQ(here.departures, there.departures);
}

TEST(Iso9283, DistanceByHand) {
  // P2 at the origin, P4 at (3, 4, 0) m, turned about x by 0.1: distance 5 m
  std::vector<Isometry3> commanded(4, pose_of({1, 0, 0}));
  commanded[1] = pose_of({0, 0, 0});
  commanded[3] = pose_of({3, 4, 0}, {0.1, 0, 0});
  const std::vector<Iso9283Visit> visits{
      {2, 1, 0, pose_of({0, 0, 0})},  {4, 1, 0, pose_of({3, 4, 0}, {0.1, 0, 0})},  // 5
      {2, 2, 0, pose_of({-3, 0, 0})}, {4, 2, 0, pose_of({3, 8, 0}, {0.3, 0, 0})},  // (6, 8, 0): 10
      {2, 3, 0, pose_of({0, 4, 0})},  {4, 3, 0, pose_of({3, 0, 0}, {0.2, 0, 0})},  // (3, 4, 0), absolute: 5
      {4, 4, 0, pose_of({9, 9, 9})}};                                              // a cycle without P2
  const Iso9283 result = iso9283(visits, commanded);
  ASSERT_TRUE(result.distance);
  const Iso9283Distance& d = *result.distance;
  EXPECT_EQ(d.first, 2);
  EXPECT_EQ(d.second, 4);
  EXPECT_EQ(d.n, 3);
  // mean 20 / 3; deviations -5/3, 10/3, -5/3: variance 150 / 9 / 2
  EXPECT_NEAR(d.ad, 5.0 / 3, 1e-14);
  EXPECT_NEAR(d.rd, 3 * std::sqrt(75.0 / 9), 1e-13);
  // x: 3 6 3, mean 4; y: 4 8 4, mean 16 / 3
  EXPECT_LT((d.ad_xyz - Vector3(1, 4.0 / 3, 0)).norm(), 1e-14);
  EXPECT_LT((d.rd_xyz - Vector3(3 * std::sqrt(3), 4 * std::sqrt(3), 0)).norm(), 1e-13);
  // a: 0.1 0.3 0.2
  EXPECT_LT((d.ad_abc - Vector3(0.1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((d.rd_abc - Vector3(0.3, 0, 0)).norm(), 1e-14);
}

TEST(Iso9283, DirectionsByHand) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  std::vector<Iso9283Visit> visits;
  const std::vector<Vector3> centres{{0, 0, 0}, {3, 4, 0}, {0, 0, 1}};
  const std::vector<Vector3> angles{{0, 0, 0}, {0.02, 0, 0}, {-0.01, 0, 0}};
  for (int direction = 1; direction <= 3; ++direction)
    for (int cycle = 1; cycle <= 2; ++cycle) {
      const auto k = static_cast<std::size_t>(direction - 1);
      const double sign = cycle == 1 ? 1 : -1;  // barycentres stay
      visits.push_back({1, cycle, direction, pose_of(1e-3 * centres[k] + Vector3(0, sign * 1e-4, 0), angles[k])});
    }
  const Iso9283 result = iso9283(visits, commanded);
  ASSERT_EQ(result.variations.size(), 1u);
  EXPECT_EQ(result.variations[0].directions, 3);
  EXPECT_NEAR(result.variations[0].vap, std::sqrt(26.0) * 1e-3, 1e-15);  // beside 5 and 1
  EXPECT_LT((result.variations[0].vap_abc - Vector3(0.03, 0, 0)).norm(), 1e-14);
  // accuracy and repeatability are those of the first direction
  EXPECT_EQ(result.poses[0].direction, 1);
  EXPECT_EQ(result.poses[0].n, 2);
  EXPECT_NEAR(result.poses[0].ap, 0, 1e-15);
  EXPECT_NEAR(result.poses[0].rp, 1e-4, 1e-15);
}

TEST(Iso9283, DriftByHand) {
  const std::vector<Isometry3> commanded{pose_of({0.5, -0.25, 1})};
  std::vector<Iso9283Visit> visits;
  // three groups of two visits, barycentres 1, 4, 2 mm from the command, distances from them 0.1, 0.3, 0.2; a rest
  const std::vector<double> at{1, 4, 2}, off{0.1, 0.3, 0.2};
  for (int k = 0; k < 7; ++k) {
    const auto group = static_cast<std::size_t>(std::min(k / 2, 2));
    const double y = (k % 2 == 0 ? 1 : -1) * off[group];
    const Vector3 off_command = 1e-3 * Vector3(at[group], y, 0);
    visits.push_back({1, k + 1, 0, moved_by(commanded[0], off_command, Vector3::Zero()), 60.0 * k});
  }
  std::swap(visits[0], visits[5]);
  std::swap(visits[1].cycle, visits[4].cycle);  // times decide
  const Iso9283 result = iso9283(visits, commanded, {.drift_visits = 2});
  ASSERT_EQ(result.drift.size(), 1u);
  const Iso9283Drift& drift = result.drift[0];
  ASSERT_EQ(drift.groups.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(drift.groups[k].ap, 1e-3 * at[k], 1e-15);
    EXPECT_NEAR(drift.groups[k].rp, 1e-3 * off[k], 1e-15);
    EXPECT_DOUBLE_EQ(drift.groups[k].time_s, 30 + 120.0 * static_cast<double>(k));
  }
  EXPECT_NEAR(drift.dap, 3e-3, 1e-15);
  EXPECT_NEAR(drift.drp, 2e-4, 1e-15);
  std::swap(visits[1].cycle, visits[4].cycle);
  for (Iso9283Visit& visit : visits) visit.time_s = nan;
  const Iso9283 untimed = iso9283(visits, commanded, {.drift_visits = 2});
  EXPECT_NEAR(untimed.drift[0].dap, 3e-3, 1e-15);  // by cycles
  EXPECT_TRUE(std::isnan(untimed.drift[0].groups[0].time_s));
}

// Accuracy that gets better drifts, too, and counts from the first group.
TEST(Iso9283, DriftIsTheLargestChangeSinceTheFirstGroup) {
  const std::vector<double> at{5, 3, 6, 4}, off{0.5, 0.1, 0.7, 0.2};
  std::vector<Iso9283Visit> visits;
  for (int k = 0; k < 8; ++k) {
    const auto group = static_cast<std::size_t>(k / 2);
    visits.push_back({1, k + 1, 0, pose_of(1e-3 * Vector3(at[group], (k % 2 == 0 ? 1 : -1) * off[group], 0))});
  }
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  const Iso9283 result = iso9283(visits, commanded, {.drift_visits = 2});
  ASSERT_EQ(result.drift.size(), 1u);
  EXPECT_EQ(result.drift[0].pose, 1);
  EXPECT_NEAR(result.drift[0].dap, 2e-3, 1e-15);  // from group to group it changes by 3
  EXPECT_NEAR(result.drift[0].drp, 0.4e-3, 1e-15);
}

TEST(Iso9283, WithoutOrientations) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  auto visits = visits_of(poses, 30, 1e-5, 1e-3, 10);
  const Iso9283 with = iso9283(visits, poses);
  for (Iso9283Visit& visit : visits) visit.measured = rigid_motion(Matrix3::Constant(nan), translation(visit.measured));
  const Iso9283 without = iso9283(visits, poses, {.orientations = false});
  EXPECT_EQ(with.poses[2].rp, without.poses[2].rp);
  EXPECT_EQ(with.poses[2].rp_low, without.poses[2].rp_low);
  EXPECT_EQ(with.distance->ad, without.distance->ad);
  EXPECT_TRUE(all_nan(without.poses[2].ap_abc) && all_nan(without.poses[2].rp_abc));
  EXPECT_TRUE(all_nan(without.distance->ad_abc) && all_nan(without.distance->rd_abc));
  EXPECT_TRUE(with.departures.empty());
  ASSERT_EQ(without.departures.size(), 1u);
  EXPECT_EQ(without.departures[0], "no orientations were measured: AP, RP, AD, RD and vAP of positions only");
}

// Orientations that were said not to be measured are not evaluated, even where they look like some.
TEST(Iso9283, OrientationsThatWereNotMeasuredAreNotEvaluated) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  auto visits = visits_of(poses, 3, 1e-5, 1e-3, 10);
  for (const int direction : {1, 2})
    for (int cycle = 1; cycle <= 3; ++cycle) visits.push_back({1, cycle, direction, poses[0]});
  const Iso9283 found = iso9283(visits, poses, {.orientations = false, .draws = 0});
  ASSERT_TRUE(found.distance);
  EXPECT_TRUE(all_nan(found.distance->ad_abc) && all_nan(found.distance->rd_abc));
  EXPECT_TRUE(std::isfinite(found.distance->ad_xyz.sum() + found.distance->rd_xyz.sum()));
  ASSERT_EQ(found.variations.size(), 1u);
  EXPECT_TRUE(all_nan(found.variations[0].vap_abc));
  EXPECT_EQ(found.variations[0].vap, 0);
}

// Where one time is unknown, the order of the visits is that of the cycles.
TEST(Iso9283, DriftIsByCyclesWhereATimeIsMissing) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  std::vector<Iso9283Visit> visits;  // 1 mm, then 2 mm, by cycles; mixed by times
  for (int k = 0; k < 4; ++k)
    visits.push_back({1, k + 1, 0, pose_of({(k < 2 ? 1e-3 : 2e-3), 0, 0}), k == 0 ? nan : 100.0 - k});
  const Iso9283 result = iso9283(visits, commanded, {.drift_visits = 2});
  ASSERT_EQ(result.drift.size(), 1u);
  EXPECT_NEAR(result.drift[0].groups[0].ap, 1e-3, 1e-15);
  EXPECT_NEAR(result.drift[0].groups[1].ap, 2e-3, 1e-15);
}

TEST(Iso9283, RefusesWhatCannotBe) {
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  const std::vector<Iso9283Visit> good{{1, 1, 0, commanded[0]}};
  const auto told = [&](const Iso9283Visit& visit) {
    return complaint([&] { (void)iso9283(std::vector<Iso9283Visit>{good[0], visit}, commanded); });
  };
  EXPECT_EQ(complaint([&] { (void)iso9283({}, commanded); }), "iso9283: no visits");
  EXPECT_EQ(told({2, 1, 0, commanded[0]}), "iso9283: a visit of pose 2, the commanded poses are 1 to 1");
  EXPECT_EQ(told({0, 1, 0, commanded[0]}), "iso9283: a visit of pose 0, the commanded poses are 1 to 1");
  EXPECT_EQ(told({1, 1, 0, commanded[0]}), "iso9283: pose 1, cycle 1, direction 0 is there twice");
  EXPECT_EQ(told({1, 2, -1, commanded[0]}), "iso9283: pose 1, cycle 2: direction -1, must be 0 or more");
  EXPECT_EQ(told({1, 2, 0, pose_of({nan, 0, 0})}), "iso9283: pose 1, cycle 2: the position is not finite");
  const Isometry3 scaled = rigid_motion(1.0002 * rotation(commanded[0]), translation(commanded[0]));
  EXPECT_EQ(told({1, 2, 0, scaled}), "iso9283: pose 1, cycle 2: the orientation is not a rotation");
  const Isometry3 mirrored = rigid_motion(-1 * rotation(commanded[0]), translation(commanded[0]));
  EXPECT_EQ(told({1, 2, 0, mirrored}), "iso9283: pose 1, cycle 2: the orientation is not a rotation");
  EXPECT_EQ(complaint([&] { (void)iso9283(good, std::vector<Isometry3>{scaled}); }),
            "iso9283: commanded pose 1: the orientation is not a rotation");
  EXPECT_EQ(complaint([&] { (void)iso9283(good, commanded, {.draws = -1}); }), "iso9283: -1 draws, must be 0 or more");
  EXPECT_EQ(complaint([&] { (void)iso9283(good, commanded, {.drift_visits = 1}); }),
            "iso9283: 1 visits in a group, must be at least 2");
}

}  // namespace
}  // namespace iso9283_test
