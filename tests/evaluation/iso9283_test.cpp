// Accuracy and repeatability after ISO 9283: cases worked by hand, constants by simulation, what departs from the norm.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/iso9283.hpp"
#include "vernier/evaluation/iso9283_poses.hpp"
#include "vernier/identification/frames.hpp"

namespace iso9283_test {
namespace {

using namespace vernier;
using vernier_test::complaint;
using vernier_test::RealMatrix;

const double nan = std::numeric_limits<double>::quiet_NaN();

Isometry3 pose_of(const Vector3& position, const Vector3& rotation = Vector3::Zero()) {
  return rigid_motion(exp_so3(rotation), position);
}

Vector3 normal3(Rng& rng, double sigma) { return sigma * Vector3(rng.normal(), rng.normal(), rng.normal()); }

/// A pose moved and then turned where it is, in the frame of the base.
Isometry3 moved_by(const Isometry3& pose, const Vector3& shift, const Vector3& turn) {
  return rigid_motion(exp_so3(turn) * rotation(pose), translation(pose) + shift);
}

bool all_nan(const Vector3& a) { return std::isnan(a(0)) && std::isnan(a(1)) && std::isnan(a(2)); }

/// Visits of poses with normal errors of positions [m] and rotation vectors [rad], in the order P5 P4 P3 P2 P1.
std::vector<Iso9283Visit> visits_of(std::span<const Isometry3> poses, int cycles, double sigma, double angle,
                                    std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Iso9283Visit> out;
  for (int cycle = 1; cycle <= cycles; ++cycle)
    for (int k = static_cast<int>(poses.size()); k >= 1; --k) {
      const Vector3 shift = normal3(rng, sigma), turn = normal3(rng, angle);
      const Isometry3 measured = moved_by(poses[static_cast<std::size_t>(k - 1)], shift, turn);
      out.push_back({k, cycle, 0, measured, 2.0 * static_cast<double>(out.size())});
    }
  return out;
}

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

// Of a chi distribution with three degrees of freedom, mean 1.5958 and standard deviation 0.6734: RP of infinitely many
// visits is 3.616 s, AP of a perfect robot 1.5958 s / sqrt(30). The mean of RP at n = 30, 3.537 s, and its 95 %, 2.92 s
// to 4.20 s, are those of an independent simulation.
TEST(Iso9283, ConstantsBySimulation) {
  const double s = 2e-5;
  const std::vector<Isometry3> one{pose_of({0.4, 0, 0.5})};
  EXPECT_NEAR(iso9283(visits_of(one, 100'000, s, 0, 1), one, {.draws = 0}).poses[0].rp / s, 3.616, 0.03);

  const std::vector<Isometry3> tests(4000, pose_of({0.4, 0, 0.5}));
  const Iso9283 result = iso9283(visits_of(tests, 30, s, 0, 2), tests, {.draws = 0});
  double rp = 0, ap = 0, square = 0;
  Index within = 0;
  for (const Iso9283Pose& pose : result.poses) {
    rp += pose.rp / s / 4000;
    ap += pose.ap / s / 4000;
    square += (pose.ap * pose.ap - pose.rp_xyz.squaredNorm() / 9 / 30) / (s * s) / 4000;
    within += pose.rp > 2.92 * s && pose.rp < 4.20 * s ? 1 : 0;
  }
  EXPECT_NEAR(rp, 3.537, 0.02);
  EXPECT_NEAR(ap, 0.2914, 0.008);
  EXPECT_NEAR(square, 0, 0.006);  // what is subtracted is what scatter adds, 0.1
  EXPECT_NEAR(static_cast<double>(within) / 4000, 0.95, 0.015);
}

// 92 % of the intervals contain 3.616 s, in two thousand tests of an independent simulation; percentiles would in 81 %.
TEST(Iso9283, IntervalsContainTheRepeatability) {
  const std::vector<Isometry3> tests(600, pose_of({0.4, 0, 0.5}));
  const Iso9283 result = iso9283(visits_of(tests, 30, 1e-5, 0, 3), tests, {.draws = 400});
  int contain = 0;
  double width = 0;
  for (const Iso9283Pose& pose : result.poses) {
    contain += pose.rp_low < 3.616e-5 && pose.rp_high > 3.616e-5 ? 1 : 0;
    width += (pose.rp_high - pose.rp_low) / 3.616e-5 / 600;
  }
  EXPECT_NEAR(contain / 600.0, 0.92, 0.03);
  EXPECT_NEAR(width, 0.44, 0.05);
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

// Of four visits there are 256 equally probable draws; 40 are of one visit alone or of two twice each, at equal
// distances. Both quantiles of t are shared by several draws: no matter how often a seed makes each.
TEST(Iso9283, IntervalOfFourVisitsByAllDraws) {
  const std::vector<Vector3> points{{0, 0, 0}, {3e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 2e-3}};
  const auto all = drawn_repeatability(points, {1, 1, 1, 1});
  std::vector<double> t;
  for (int draw = 0; draw < 256; ++draw) {
    std::vector<int> times(4, 0);
    for (int k = 0, rest = draw; k < 4; ++k, rest /= 4) ++times[static_cast<std::size_t>(rest % 4)];
    const auto twice = std::count(times.begin(), times.end(), 2), never = std::count(times.begin(), times.end(), 0);
    if (never == 3 || twice == 2) continue;
    const auto one = drawn_repeatability(points, times);
    t.push_back((one.first - all.first) / one.second);
  }
  std::sort(t.begin(), t.end());
  ASSERT_EQ(t.size(), 216u);
  const double low = t[5], high = t[210];  // at 2.5 % and 97.5 % of 215
  for (const std::size_t same_low : {0u, 11u}) ASSERT_NEAR(t[same_low], low, 1e-9);
  for (const std::size_t same_high : {208u, 211u}) ASSERT_NEAR(t[same_high], high, 1e-9);

  const std::vector<Isometry3> commanded(2, pose_of({0, 0, 0}));
  std::vector<Iso9283Visit> visits;
  for (const int pose : {1, 2})
    for (int k = 0; k < 4; ++k) visits.push_back({pose, k + 1, 0, pose_of(points[static_cast<std::size_t>(k)])});
  const Iso9283 found = iso9283(visits, commanded, {.draws = 20'000});
  for (const Iso9283Pose& pose : found.poses) {
    EXPECT_NEAR(pose.rp, all.first, 1e-15);
    EXPECT_NEAR(pose.rp_low, all.first - high * all.second, 1e-12);
    EXPECT_NEAR(pose.rp_high, all.first - low * all.second, 1e-12);
  }
}

// Of five visits there are 3125 draws. Of these the 2.5 % of the smallest t end within several equal ones, and so do
// the 97.5 %; the 3.75 % end farther on.
TEST(Iso9283, IntervalOfFiveVisitsByAllDraws) {
  const std::vector<Vector3> points{{3, 2, 2}, {1, 2, 3}, {0, 0, 1}, {3, 3, 2}, {2, 3, 2}};
  const auto all = drawn_repeatability(points, {1, 1, 1, 1, 1});
  std::vector<double> t;
  for (int draw = 0; draw < 3125; ++draw) {
    std::vector<int> times(5, 0);
    for (int k = 0, rest = draw; k < 5; ++k, rest /= 5) ++times[static_cast<std::size_t>(rest % 5)];
    if (std::count(times.begin(), times.end(), 0) == 4) continue;  // one visit alone
    const auto one = drawn_repeatability(points, times);
    t.push_back((one.first - all.first) / one.second);
  }
  std::sort(t.begin(), t.end());
  ASSERT_EQ(t.size(), 3120u);
  const double low = t[77], high = t[3040];
  for (const std::size_t same_low : {61u, 98u}) ASSERT_NEAR(t[same_low], low, 1e-9);
  for (const std::size_t same_high : {3011u, 3068u}) ASSERT_NEAR(t[same_high], high, 1e-9);
  ASSERT_GT(t[116], low + 1);

  std::vector<Iso9283Visit> visits;
  for (int k = 0; k < 5; ++k) visits.push_back({1, k + 1, 0, pose_of(1e-3 * points[static_cast<std::size_t>(k)])});
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  const Iso9283Pose pose = iso9283(visits, commanded, {.draws = 20'000}).poses[0];
  EXPECT_NEAR(pose.rp_low, 1e-3 * std::max(0.0, all.first - high * all.second), 1e-12);
  EXPECT_NEAR(pose.rp_high, 1e-3 * (all.first - low * all.second), 1e-12);
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

// Four visits on a circle: their distances are equal, RP has no standard error, and its interval is RP alone.
TEST(Iso9283, TheIntervalOfVisitsAtOneDistanceIsOneValue) {
  std::vector<Iso9283Visit> visits;
  for (const Vector3& at : {Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)})
    visits.push_back({1, static_cast<int>(visits.size()) + 1, 0, pose_of(at)});
  const Iso9283Pose pose = iso9283(visits, std::vector<Isometry3>{pose_of({0, 0, 0})}).poses[0];
  EXPECT_EQ(pose.rp, 1);
  EXPECT_EQ(pose.rp_low, 1);
  EXPECT_EQ(pose.rp_high, 1);
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
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0}), pose_of({1, 0, 0}), pose_of({0, 1, 0})};
  std::vector<Iso9283Visit> visits{
      {1, 1, 0, pose_of({1e-3, 0, 0})}, {2, 1, 0, pose_of({1, 0, 0})}, {2, 2, 0, pose_of({1, 2e-3, 0})}};
  for (int cycle = 1; cycle <= 4; ++cycle) visits.push_back({3, cycle, 0, pose_of({0, 1, 1e-3})});
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
  const std::vector<Isometry3> commanded{pose_of({0, 0, 0})};
  std::vector<Iso9283Visit> visits;
  // three groups of two visits, barycentres 1, 4, 2 mm from the command, distances from them 0.1, 0.3, 0.2; a rest
  const std::vector<double> at{1, 4, 2}, off{0.1, 0.3, 0.2};
  for (int k = 0; k < 7; ++k) {
    const auto group = static_cast<std::size_t>(std::min(k / 2, 2));
    const double y = (k % 2 == 0 ? 1 : -1) * off[group];
    visits.push_back({1, k + 1, 0, pose_of(1e-3 * Vector3(at[group], y, 0)), 60.0 * k});
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

// Accuracy of a group is that of its barycentre with respect to the command, wherever that is.
TEST(Iso9283, DriftIsWithRespectToTheCommand) {
  const std::vector<Isometry3> commanded{pose_of({0.5, -0.25, 1})};
  std::vector<Iso9283Visit> visits;
  for (int k = 0; k < 4; ++k)
    visits.push_back({1, k + 1, 0, moved_by(commanded[0], Vector3(0, k < 2 ? 1e-3 : 3e-3, 0), Vector3::Zero())});
  const Iso9283Drift drift = iso9283(visits, commanded, {.drift_visits = 2}).drift.at(0);
  EXPECT_NEAR(drift.groups.at(0).ap, 1e-3, 1e-15);
  EXPECT_NEAR(drift.groups.at(1).ap, 3e-3, 1e-15);
}

// Without options: 2000 draws, groups of ten visits, of which a drift needs two.
TEST(Iso9283, OptionsThatAreNotGiven) {
  const std::vector<Isometry3> one{pose_of({0.4, 0, 0.5})};
  const auto drifts = [&](int cycles) { return iso9283(visits_of(one, cycles, 1e-5, 0, 3), one).drift.size(); };
  EXPECT_EQ(drifts(19), 0u);
  EXPECT_EQ(drifts(20), 1u);
  const auto visits = visits_of(one, 12, 1e-5, 0, 3);
  const Iso9283Pose pose = iso9283(visits, one).poses[0];
  const Iso9283Pose same_pose = iso9283(visits, one, {.draws = 2000, .seed = 1}).poses[0];
  EXPECT_EQ(pose.rp_low, same_pose.rp_low);
  EXPECT_EQ(pose.rp_high, same_pose.rp_high);
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

/// All departures, a line each.
std::string departures_of(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded) {
  std::string out;
  for (const std::string& one : iso9283(visits, commanded, {.draws = 0}).departures) out += one + "\n";
  return out;
}

TEST(Iso9283, Departures) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  const std::vector<Iso9283Visit> norm = visits_of(poses, 30, 1e-5, 1e-5, 11);
  EXPECT_EQ(departures_of(norm, poses), "");
  EXPECT_EQ(departures_of(visits_of(poses, 12, 1e-5, 0, 1), poses),
            "poses 1, 2, 3, 4, 5: 12 cycles, the norm asks for 30\n");
  EXPECT_EQ(departures_of(visits_of(poses, 1, 1e-5, 0, 1), poses),
            "poses 1, 2, 3, 4, 5: one visit only: AP is the error of that visit, and there is no RP\n");
  const std::vector<Isometry3> four(poses.begin(), poses.begin() + 4);
  EXPECT_EQ(departures_of(visits_of(four, 30, 1e-5, 0, 1), four), "4 commanded poses, the norm has 5\n");
  auto squashed = poses;
  squashed[3](2, 3) += 0.03;
  EXPECT_NE(departures_of(visits_of(squashed, 30, 1e-5, 0, 1), squashed).find("are not the centre of a cube"),
            std::string::npos);

  auto visits = norm;
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.pose == 3; });
  EXPECT_NE(departures_of(visits, poses).find("pose 3: commanded, but not visited\n"), std::string::npos);
  visits = norm;
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.pose == 3 && v.cycle > 20; });
  EXPECT_NE(departures_of(visits, poses).find("unequal numbers of cycles: 20 (pose 3) to 30 (pose 1)\n"),
            std::string::npos);
  // pose 2 of the last ten cycles is reached from pose 4
  EXPECT_NE(departures_of(visits, poses)
                .find("pose 2: reached 20 times from pose 3 and 10 times from pose 4, the norm asks for one direction"),
            std::string::npos);
  visits = norm;
  std::swap(visits[2].time_s, visits[7].time_s);  // P3 of cycles 1 and 2
  EXPECT_EQ(departures_of(visits, poses), "pose 3: cycle 1 was measured after cycle 2\n");

  visits = norm;
  for (const int pose : {1, 2})
    for (int direction = 1; direction <= (pose == 1 ? 3 : 2); ++direction)
      for (int cycle = 1; cycle <= 30; ++cycle)
        visits.push_back({pose, cycle, direction, poses[static_cast<std::size_t>(pose - 1)], 1e6 + 100 * cycle});
  EXPECT_EQ(departures_of(visits, poses),
            "pose 2: 2 directions of approach, vAP of the norm needs 3\n"
            "pose 4: 0 directions of approach, vAP of the norm needs 3\n");
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.pose == 1 && (v.direction == 0 || v.cycle == 30); });
  EXPECT_NE(departures_of(visits, poses).find("pose 1: direction 2: 29 cycles, the norm asks for 30\n"),
            std::string::npos);
  EXPECT_NE(departures_of(visits, poses).find("pose 1: AP and RP are those of direction 1\n"), std::string::npos);

  const std::vector<Isometry3> many(8, pose_of({0, 0, 0}));
  EXPECT_NE(departures_of(visits_of(many, 2, 1e-5, 0, 1), many)
                .find("poses 1, 2, 3, 4, 5, ... (8 in all): 2 cycles, the norm asks for 30"),
            std::string::npos);
}

/// Visits of a pose from one direction, after all others.
void visit_from(std::vector<Iso9283Visit>& visits, const std::array<Isometry3, 5>& poses, int pose, int direction,
                int cycles) {
  for (int cycle = 1; cycle <= cycles; ++cycle)
    visits.push_back({pose, cycle, direction, poses[static_cast<std::size_t>(pose - 1)], 1e6 + 100 * cycle});
}

// P1, P2 and P4 need three directions where any pose has some, and each pose that has some needs three.
TEST(Iso9283, DirectionsThatTheNormNeeds) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  const std::vector<Iso9283Visit> norm = visits_of(poses, 30, 1e-5, 1e-5, 11);
  auto visits = norm;
  visit_from(visits, poses, 3, 1, 20);
  EXPECT_EQ(departures_of(visits, poses),
            "poses 1, 2, 4: 0 directions of approach, vAP of the norm needs 3\n"
            "pose 3: direction 1: 20 cycles, the norm asks for 30\n"
            "pose 3: 1 direction of approach, vAP of the norm needs 3\n");
  EXPECT_TRUE(iso9283(visits, poses, {.draws = 0}).variations.empty());  // nothing to compare it with
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.pose == 3 && v.direction == 0; });
  EXPECT_NE(departures_of(visits, poses).find("pose 3: AP and RP are those of direction 1\n"), std::string::npos);
  // three directions without direction 0
  visits = norm;
  for (const int pose : {1, 2, 4})
    for (const int direction : {1, 2, 3}) visit_from(visits, poses, pose, direction, 30);
  EXPECT_EQ(departures_of(visits, poses), "");
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.direction == 0 && v.pose != 3 && v.pose != 5; });
  EXPECT_EQ(departures_of(visits, poses), "poses 1, 2, 4: AP and RP are those of direction 1\n");
}

TEST(Iso9283, DeparturesNameTheFirstOfThePoses) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  auto visits = visits_of(poses, 30, 1e-5, 1e-5, 11);
  std::erase_if(visits, [](const Iso9283Visit& v) { return (v.pose == 3 || v.pose == 4) && v.cycle > 20; });
  EXPECT_NE(departures_of(visits, poses).find("unequal numbers of cycles: 20 (pose 3) to 30 (pose 1)\n"),
            std::string::npos);
  const auto named = [](std::size_t count) {
    const std::vector<Isometry3> many(count, pose_of({0, 0, 0}));
    return departures_of(visits_of(many, 2, 1e-5, 0, 1), many);
  };
  EXPECT_NE(named(6).find("poses 1, 2, 3, 4, 5, ... (6 in all): 2 cycles"), std::string::npos);
  EXPECT_NE(named(5).find("poses 1, 2, 3, 4, 5: 2 cycles"), std::string::npos);
  EXPECT_EQ(named(1), "1 commanded pose, the norm has 5\npose 1: 2 cycles, the norm asks for 30\n");
}

// The first visit counts where cycles are compared, and for the pose that is reached from it.
TEST(Iso9283, TheSequenceBeginsWithTheFirstVisit) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  auto visits = visits_of(poses, 30, 1e-5, 1e-5, 11);
  std::swap(visits[0].time_s, visits[5].time_s);  // P5 of cycles 1 and 2
  EXPECT_EQ(departures_of(visits, poses), "pose 5: cycle 1 was measured after cycle 2\n");
  std::vector<Iso9283Visit> few;
  for (const int pose : {1, 2, 3, 2}) {
    const int cycle = few.size() < 3 ? 1 : 2;
    few.push_back({pose, cycle, 0, poses[static_cast<std::size_t>(pose - 1)], static_cast<double>(few.size())});
  }
  EXPECT_NE(departures_of(few, poses)
                .find("pose 2: reached 1 time from pose 1 and 1 time from pose 3, the norm asks for one direction"),
            std::string::npos);
}

// Visits of one time are in the order in which they are given.
TEST(Iso9283, VisitsOfOneTimeAreInTheirOrder) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  auto visits = visits_of(poses, 30, 1e-5, 1e-5, 11);
  for (Iso9283Visit& visit : visits) visit.time_s = 5;
  EXPECT_EQ(departures_of(visits, poses), "");
  std::reverse(visits.begin(), visits.end());
  EXPECT_EQ(departures_of(visits, poses), "poses 1, 2, 3, 4, 5: cycle 29 was measured after cycle 30\n");
}

/// Whether five commanded poses are those of the norm.
bool on_cube(const std::vector<Vector3>& positions) {
  std::vector<Isometry3> poses;
  for (const Vector3& one : positions) poses.push_back(pose_of(one));
  return departures_of(visits_of(poses, 30, 1e-6, 0, 1), poses).empty();
}

// Diagonals of a diagonal plane cross at 70.5 and 109.5 degrees; whichever of them lies between P2 and P3. Each
// distance and angle may be off by a twentieth, and is told where it is more.
TEST(Iso9283, CommandedPosesWithinTheTolerancesOfACube) {
  const double half = std::atan(std::numbers::sqrt2);  // of the larger angle
  const auto five = [&](double angle, double stretch, double bend_second, double bend_third) {
    const auto at = [](double turned, double radius) {
      return Vector3(0.5 + radius * std::cos(turned), 0.1, radius * std::sin(turned));
    };
    const double pi = std::numbers::pi;
    return std::vector<Vector3>{{0.5, 0.1, 0},
                                at(0, 0.3 * stretch),
                                at(angle, 0.3),
                                at(pi + bend_second, 0.3),
                                at(pi + angle + bend_third, 0.3)};
  };
  EXPECT_TRUE(on_cube(five(2 * half, 1, 0, 0)));
  EXPECT_TRUE(on_cube(five(std::numbers::pi - 2 * half, 1, 0, 0)));
  EXPECT_FALSE(on_cube(five(std::numbers::pi / 2, 1, 0, 0)));
  for (const double within : {-0.045, 0.045}) {
    EXPECT_TRUE(on_cube(five(2 * half + within, 1, 0, 0)));
    EXPECT_TRUE(on_cube(five(2 * half, 1, within, 0)));
    EXPECT_TRUE(on_cube(five(2 * half, 1, 0, within)));
    EXPECT_TRUE(on_cube(five(2 * half, 1 + within, 0, 0)));
  }
  for (const double beyond : {-0.07, 0.07}) {  // a longer arm lengthens the mean, too
    EXPECT_FALSE(on_cube(five(2 * half + beyond, 1, 0, 0)));
    EXPECT_FALSE(on_cube(five(2 * half, 1, beyond, 0)));
    EXPECT_FALSE(on_cube(five(2 * half, 1, 0, beyond)));
    EXPECT_FALSE(on_cube(five(2 * half, 1 + beyond, 0, 0)));
  }
}

// Cycles are in order per pose and direction; a pose out of order is reported once.
TEST(Iso9283, OrderOfCyclesByPoseAndDirection) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  std::vector<Iso9283Visit> visits = visits_of(poses, 30, 1e-5, 1e-5, 11);
  // P3 of cycles 1 and 2, 5 and 6
  std::swap(visits[2].time_s, visits[7].time_s);
  std::swap(visits[22].time_s, visits[27].time_s);
  EXPECT_EQ(departures_of(visits, poses), "pose 3: cycle 1 was measured after cycle 2\n");
  // where one time is not known, none tells an order
  visits[0].time_s = nan;
  EXPECT_EQ(departures_of(visits, poses), "");
  visits[0].time_s = 0;
  visits[149].time_s = nan;
  EXPECT_EQ(departures_of(visits, poses), "");
}

TEST(Iso9283, FourDirectionsAreNotTheThreeOfTheNorm) {
  const auto poses = iso9283_poses({{0.4, 0, 0.5}, 0.4});
  std::vector<Iso9283Visit> visits = visits_of(poses, 30, 1e-5, 1e-5, 11);
  for (const int pose : {1, 2, 4})
    for (int direction = 1; direction <= (pose == 1 ? 4 : 3); ++direction)
      for (int cycle = 1; cycle <= 30; ++cycle)
        visits.push_back({pose, cycle, direction, poses[static_cast<std::size_t>(pose - 1)], 1e6 + 100 * cycle});
  EXPECT_EQ(departures_of(visits, poses), "pose 1: 4 directions of approach, vAP of the norm needs 3\n");
  // the direction of what is reported is its number
  std::erase_if(visits, [](const Iso9283Visit& v) { return v.pose == 2 && v.direction < 2; });
  const Iso9283 result = iso9283(visits, poses, {.draws = 0});
  EXPECT_EQ(result.poses[0].direction, 0);
  EXPECT_EQ(result.poses[1].direction, 2);
  ASSERT_EQ(result.variations.size(), 3u);  // two directions vary, too
  EXPECT_EQ(result.variations[1].pose, 2);
  EXPECT_EQ(result.variations[1].directions, 2);
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

TEST(Iso9283Poses, OnTheDiagonalsOfACube) {
  const Iso9283Cube cube{{0.5, -0.2, 0.7}, 0.6};
  const Matrix3 orientation = exp_so3(Vector3(0, 3, 0.2));
  const double diagonal = 0.6 * std::numbers::sqrt3;
  for (int plane = 1; plane <= 4; ++plane) {
    const auto p = iso9283_poses(cube, orientation, plane);
    EXPECT_EQ(translation(p[0]), cube.centre);
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(RealMatrix(rotation(p[k])), RealMatrix(orientation));
    // 10 % of the diagonal from each corner, so 80 % between opposite ones; the sides of a rectangle 1 to sqrt(2)
    const auto apart = [&](std::size_t i, std::size_t k) { return (translation(p[i]) - translation(p[k])).norm(); };
    EXPECT_NEAR(apart(1, 3), 0.8 * diagonal, 1e-14);
    EXPECT_NEAR(apart(2, 4), 0.8 * diagonal, 1e-14);
    EXPECT_NEAR(apart(1, 2), 0.8 * 0.6, 1e-14);
    EXPECT_NEAR(apart(2, 3), 0.8 * 0.6 * std::numbers::sqrt2, 1e-14);
    EXPECT_GT(p[1](2, 3), 0.7);
    EXPECT_GT(p[2](2, 3), 0.7);
  }
  EXPECT_LT((translation(iso9283_poses(cube)[1]) - (cube.centre + Vector3::Constant(0.24))).norm(), 1e-15);     // at C1
  EXPECT_LT((translation(iso9283_poses(cube)[2]) - (cube.centre + Vector3(-0.24, 0.24, 0.24))).norm(), 1e-15);  // C2
  EXPECT_EQ(complaint([&] { (void)iso9283_poses({{0, 0, 0}, 0}); }), "iso9283_poses: an edge of 0 m, must be positive");
  EXPECT_EQ(complaint([&] { (void)iso9283_poses(cube, orientation, 5); }), "iso9283_poses: plane 5, must be 1 to 4");
  EXPECT_NE(complaint([&] { (void)iso9283_poses(cube, 2 * orientation); }).find("not a rotation"), std::string::npos);
}

TEST(Iso9283Poses, TheLargestCubeWithinReach) {
  // all poses within a ball about the middle of the box: 0.8 x edge x sqrt(3) / 2 = radius
  const Vector3 middle(0.5, 0, 0.5), half(0.4, 0.5, 0.6);
  const auto ball = [&](const Isometry3& pose) { return (translation(pose) - middle).norm() < 0.4; };
  const auto found = largest_iso9283_cube(middle - half, middle + half, ball);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->centre, middle);
  EXPECT_LE(found->edge, 1.0 / std::numbers::sqrt3);
  EXPECT_GT(found->edge, 1.0 / std::numbers::sqrt3 - 0.8 / 50);
  // only in the upper part, which is a place of the search
  const auto above = [&](const Isometry3& pose) { return pose(2, 3) > 0.6; };
  const auto upper = largest_iso9283_cube(middle - half, middle + half, above);
  ASSERT_TRUE(upper);
  for (const Isometry3& pose : iso9283_poses(*upper)) EXPECT_TRUE(above(pose));
  EXPECT_LE(std::abs(upper->centre.z() - middle.z()) + upper->edge / 2, 0.6 + 1e-12);
  EXPECT_GT(upper->edge, 0.5);  // 0.556 fills the box from 0.6 on
  EXPECT_FALSE(largest_iso9283_cube(middle - half, middle + half, [](const Isometry3&) { return false; }));
  EXPECT_NE(complaint([&] { (void)largest_iso9283_cube(middle, middle - half, ball); }).find("must be below"),
            std::string::npos);
  const Vector3 flat(middle.x() + 1, middle.y(), middle.z() + 1);
  EXPECT_NE(complaint([&] { (void)largest_iso9283_cube(middle, flat, ball); }).find("must be below"),
            std::string::npos);
}

// The edges that are tried are fiftieths of the shortest side, from that side itself to one of them.
TEST(Iso9283Poses, EdgesFromTheShortestSideToAFiftieth) {
  const Vector3 lower(1, 2, 3), upper(3, 2.5, 4);
  const auto largest = largest_iso9283_cube(lower, upper, [](const Isometry3&) { return true; });
  ASSERT_TRUE(largest);
  EXPECT_DOUBLE_EQ(largest->edge, 0.5);
  EXPECT_EQ(largest->centre, Vector3(2, 2.25, 3.5));
  // four poses 0.4 x edge x sqrt(3) from the middle
  const auto within = [&](double edge) {
    return largest_iso9283_cube(lower, upper, [&](const Isometry3& pose) {
      return (translation(pose) - Vector3(2, 2.25, 3.5)).norm() <= 0.4 * edge * std::numbers::sqrt3;
    });
  };
  ASSERT_TRUE(within(0.0101));
  EXPECT_DOUBLE_EQ(within(0.0101)->edge, 0.01);
  EXPECT_FALSE(within(0.0099));
}

// Where only the outermost part of the box is within reach, on any side, the cube is at its face.
TEST(Iso9283Poses, TheCubeReachesTheFacesOfTheBox) {
  const Vector3 lower(-1, -1, -1), upper(1, 1, 1);
  for (Index axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto beyond = [&](const Isometry3& pose) { return side * translation(pose)(axis) > 0.6; };
      const auto cube = largest_iso9283_cube(lower, upper, beyond);
      ASSERT_TRUE(cube);
      EXPECT_NEAR(side * cube->centre(axis) + cube->edge / 2, 1, 1e-12) << axis << ' ' << side;
      EXPECT_NEAR(cube->edge, 0.4 / 0.9, 0.04) << axis << ' ' << side;  // nine tenths of it are beyond
    }
}

}  // namespace
}  // namespace iso9283_test
