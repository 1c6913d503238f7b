// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/identification/in_one_frame.hpp"

#include <gtest/gtest.h>

#include <string>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::stations_test {
namespace {

using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::RealMatrix;
using Data = Dataset<6>;

Isometry3 frame(const Vector6& values) { return FrameParameters(values).isometry(); }

const Robot<6> robot = robots::abb_irb120();
const std::vector<Isometry3> bases{frame(Vector6{0.5, -2, 0.3, 0.1, -0.4, 2.5}),
                                   frame(Vector6{-3, 1, 0.7, 1.2, 0.3, -0.9}),
                                   frame(Vector6{0.1, 0.2, -4, -0.2, 2.0, 0.6})};

/// The same arm as seen from one place.
Data seen_from(std::size_t station, Index n, std::uint64_t seed, bool oriented = true) {
  const Framed<DhChain<6>> arm(robot.chain, bases[station], frame(Vector6{0.01, 0.02, 0.1, 0.3, -0.2, 0.5}));
  return measure(arm, sample_joints(robot.limits, n, seed), {.with_orientations = oriented});
}

TEST(InOneFrame, IsWhatTheFirstStationWouldHaveSeen) {
  const std::vector<Data> stations{seen_from(0, 20, 1), seen_from(1, 30, 2), seen_from(2, 10, 3)};
  const Data all = in_one_frame<6>(stations, bases);
  ASSERT_EQ(all.size(), 60);
  ASSERT_TRUE(all.has_orientations());
  Index at = 0;
  for (const auto& [n, seed] : {std::pair<Index, std::uint64_t>{20, 1}, {30, 2}, {10, 3}}) {
    const Data wanted = seen_from(0, n, seed);
    EXPECT_EQ(RealMatrix(all.joints()).block(at, 0, n, 6), RealMatrix(wanted.joints()));
    EXPECT_LT(difference(RealMatrix(all.positions()).block(at, 0, n, 3), wanted.positions()), 1e-12);
    for (Index i = 0; i < n; ++i)  // rotation vectors may differ by a turn
      EXPECT_LT(difference(all.orientation(at + i), wanted.orientation(i)), 1e-12);
    at += n;
  }
}

// When samples were measured, and from where they were approached, stays with them.
TEST(InOneFrame, KeepsTimesAndApproaches) {
  const std::vector<Isometry3> two(bases.begin(), bases.begin() + 2);
  const JointRows<6> before_first = sample_joints(robot.limits, 3, 5),
                     before_second = sample_joints(robot.limits, 2, 6);
  const std::vector<Data> stations{seen_from(0, 3, 1).approached_from(before_first).measured_at(VectorX{{1, 4, 9}}),
                                   seen_from(1, 2, 2).approached_from(before_second).measured_at(VectorX{{16, 25}})};
  const Data all = in_one_frame<6>(stations, two);
  EXPECT_EQ(RealMatrix(all.times()), vernier_test::vector({1, 4, 9, 16, 25}));
  EXPECT_EQ(RealMatrix(all.previous()).block(0, 0, 3, 6), RealMatrix(before_first));
  EXPECT_EQ(RealMatrix(all.previous()).block(3, 0, 2, 6), RealMatrix(before_second));
}

TEST(InOneFrame, KeepsTemperaturesThatAllStationsHave) {
  const std::vector<Isometry3> two(bases.begin(), bases.begin() + 2);
  std::vector<Data> stations{seen_from(0, 3, 1).at_temperatures(VectorX{{18, 20, 22}}),
                             seen_from(1, 2, 2).at_temperatures(VectorX{{31, 30}})};
  EXPECT_EQ(RealMatrix(in_one_frame<6>(stations, two).temperatures()), vernier_test::vector({18, 20, 22, 31, 30}));
  stations[1] = seen_from(1, 2, 2);
  EXPECT_EQ(in_one_frame<6>(stations, two).temperatures().size(), 0);
}

TEST(InOneFrame, ASingleStationIsGivenBack) {
  const std::vector<Data> one{seen_from(1, 15, 4)};
  const Data all = in_one_frame<6>(one, {});
  EXPECT_EQ(difference(all.joints(), one[0].joints()), 0);
  EXPECT_EQ(difference(all.positions(), one[0].positions()), 0);
  EXPECT_EQ(difference(all.orientations(), one[0].orientations()), 0);
}

TEST(InOneFrame, OrientationsNeedAllStations) {
  const std::vector<Data> mixed{seen_from(0, 5, 1), seen_from(1, 6, 2, false)};
  const std::vector<Isometry3> two(bases.begin(), bases.begin() + 2);
  const Data all = in_one_frame<6>(mixed, two);
  EXPECT_FALSE(all.has_orientations());
  EXPECT_EQ(all.size(), 11);
  EXPECT_LT(difference(RealMatrix(all.positions()).block(5, 0, 6, 3), seen_from(0, 6, 2).positions()), 1e-12);

  const std::vector<Data> oriented{seen_from(0, 5, 1), seen_from(1, 6, 2)};
  EXPECT_TRUE(in_one_frame<6>(oriented, two).has_orientations());
  EXPECT_FALSE(in_one_frame<6>(oriented, two, false).has_orientations());
}

TEST(InOneFrame, EmptyStationsAddNothing) {
  const std::vector<Data> stations{seen_from(0, 5, 1), seen_from(1, 0, 2), seen_from(2, 4, 3)};
  const Data all = in_one_frame<6>(stations, bases, false);
  EXPECT_EQ(all.size(), 9);
  EXPECT_LT(difference(RealMatrix(all.positions()).block(5, 0, 4, 3), seen_from(0, 4, 3).positions()), 1e-12);
}

TEST(InOneFrame, MisuseThrows) {
  EXPECT_NE(complaint([] { in_one_frame<6>(std::vector<Data>{}, {}); }).find("no stations"), std::string::npos);
  const std::vector<Data> stations{seen_from(0, 5, 1), seen_from(1, 6, 2)};
  EXPECT_NE(complaint([&] { in_one_frame<6>(stations, bases); }).find("3 bases for 2 stations"), std::string::npos);
  EXPECT_NE(complaint([&] { in_one_frame<6>(stations, {}); }).find("0 bases for 2 stations"), std::string::npos);
}

}  // namespace
}  // namespace vernier::stations_test
