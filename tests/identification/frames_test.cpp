// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/identification/frames.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/trilaterate.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::frames_test {
namespace {

using vernier_test::complaint;
using vernier_test::difference;

TEST(Trilaterate, FindsThePoint) {
  Rng rng(1);
  PointRows points(20, 3);
  for (Index c = 0; c < 3; ++c)
    for (Index i = 0; i < 20; ++i) points(i, c) = rng.uniform(-1, 1);
  const Vector3 from(3, -2, 0.5);
  const VectorX distances = distances_from(points, from);
  EXPECT_LT((trilaterate(points, distances) - from).norm(), 1e-12);
  for (Index i = 0; i < 20; ++i)
    points(i, 2) = 0;  // on a plane: the point's mirror image is as good, so it is put between the two
  const VectorX flat = distances_from(points, from);
  EXPECT_LT((trilaterate(points, flat) - Vector3(3, -2, 0)).norm(), 1e-12);
  EXPECT_NE(complaint([&] { (void)trilaterate(points, VectorX::Ones(3)); }).find("20 points, 3 distances"),
            std::string::npos);
}

// A single distance leaves all directions open; the point itself is the middle of what it allows.
TEST(Trilaterate, OfOnePointIsThePoint) {
  PointRows point(1, 3), none(0, 3);
  point << 1, 2, 3;
  EXPECT_EQ(trilaterate(point, VectorX::Ones(1)), Vector3(1, 2, 3));
  EXPECT_NE(complaint([&] { (void)trilaterate(none, VectorX()); }).find("0 points, 0 distances"), std::string::npos);
}

TEST(StartingFrames, FindsFramesOfANominalArm) {
  const auto robot = robots::ur10();
  const Framed<DhChain<6>> actual(robot.chain, FrameParameters(Vector6{0.4, -3.2, 0.2, -0.9, -1.3, -0.9}),
                                  FrameParameters(Vector6{0.01, 0.02, 0.109, 0.1, -0.3, 2.0}));
  const auto data = measure(actual, sample_joints(robot.limits, 60, 1));
  const auto found = starting_frames(robot.chain, data, true, true);
  const auto shift = [](const Isometry3& a, const Isometry3& b) { return (translation(a) - translation(b)).norm(); };
  const auto turn = [](const Isometry3& a, const Isometry3& b) {
    return log_so3(rotation(composed(inverse_of(a), b))).norm();
  };
  EXPECT_LT(shift(found.base(), actual.base()), 1e-3);
  EXPECT_LT(turn(found.base(), actual.base()), 1e-3);
  EXPECT_LT(shift(found.tool(), actual.tool()), 1e-3);
  EXPECT_LT(turn(found.tool(), actual.tool()), 2e-3);
}

TEST(StartingFrames, KnownFramesStay) {
  const auto robot = robots::ur5();
  const FrameParameters base(Vector6{1, 2, 3, 0.1, 0.2, 0.3});
  const auto data = measure(Framed<DhChain<6>>(robot.chain, base), sample_joints(robot.limits, 20, 1));
  const auto found = starting_frames(Framed<DhChain<6>>(robot.chain, base), data, false, true);
  EXPECT_EQ(difference(found.base(), base.isometry()), 0);
  EXPECT_LT(translation(found.tool()).norm(), 1e-12);
}

// The mean over all samples: with the base known, and exact positions, the tool is exact.
TEST(StartingFrames, AreExactWithTheOtherFrameKnown) {
  const auto robot = robots::ur5();
  const FrameParameters base(Vector6{1, 2, 3, 0.1, 0.2, 0.3}), tool(Vector6{0.01, -0.02, 0.109, 0.1, -0.3, 2});
  const auto data = measure(Framed<DhChain<6>>(robot.chain, base, tool), sample_joints(robot.limits, 5, 1));
  const auto of_tool = starting_frames(Framed<DhChain<6>>(robot.chain, base), data, false, true);
  EXPECT_LT(difference(of_tool.tool(), tool.isometry()), 1e-12);
  const auto of_base = starting_frames(Framed<DhChain<6>>(robot.chain, {}, tool), data, true, false);
  EXPECT_LT(difference(of_base.base(), base.isometry()), 1e-12);
  EXPECT_EQ(difference(of_base.tool(), tool.isometry()), 0);
}

// A tool that is kept is the base's to live with: points of that tool are registered, and nothing else.
TEST(StartingFrames, ABaseIsRegisteredToPointsOfTheToolThatIsKept) {
  const auto robot = robots::ur5();
  const FrameParameters tool(Vector6{0.01, -0.02, 0.109, 0.1, -0.3, 2}), wrong(Vector6{0.03, 0.01, 0.1, 0, 0, 0});
  const auto data = measure(Framed<DhChain<6>>(robot.chain, {}, tool), sample_joints(robot.limits, 8, 1));
  const Framed<DhChain<6>> start(robot.chain, {}, wrong);
  const auto found = starting_frames(start, data, true, false);
  PointRows points(8, 3);
  for (Index i = 0; i < 8; ++i) set_point(points, i, translation(start.pose(data.joints(i))));
  EXPECT_LT(difference(found.base(), register_points(points, data.positions())), 1e-12);
  EXPECT_GT(difference(found.base(), Isometry3::Identity()), 1e-3);
  EXPECT_EQ(difference(found.tool(), wrong.isometry()), 0);
}

// Of two orientations that differ by a turn, the tool's is in the middle.
TEST(StartingFrames, TheToolsOrientationIsTheMean) {
  const auto robot = robots::ur5();
  const JointRows<6> joints = sample_joints(robot.limits, 2, 1);
  PointRows positions(2, 3), orientations(2, 3);
  const Matrix3 middle = exp_so3(Vector3(0.1, -0.3, 2));
  for (Index i = 0; i < 2; ++i) {
    const Isometry3 flange = robot.chain.pose(configuration(joints, i));
    set_point(positions, i, translation(flange));
    const Matrix3 off = exp_so3(Vector3(0, 0.2, 0) * (i == 0 ? 1 : -1));
    set_point(orientations, i, log_so3(rotation(flange) * middle * off));
  }
  const auto found = starting_frames(robot.chain, Dataset<6>(joints, positions, orientations), false, true);
  EXPECT_LT(difference(rotation(found.tool()), middle), 1e-12);
}

// Distances say where the base is: its origin becomes the fixed point, its orientation and the tool stay.
TEST(StartingFrames, OfDistancesPutTheFixedPointAtTheOrigin) {
  const auto robot = robots::ur10();
  const Framed<DhChain<6>> arm(robot.chain, FrameParameters(Vector6{0.4, -0.2, 0.3, 0.5, -0.7, 1.1}),
                               FrameParameters(Vector6{0.02, 0.03, 0.11, 0.1, 0.2, 0.3}));
  const Vector3 anchor(0.9, -1.2, 0.3);
  const auto data = measure_distances(arm, anchor, sample_joints(robot.limits, 40, 1));
  const MeasuredSet station = vernier_test::set_of(data, {});
  const ArmGeometry start(arm);
  for (const bool tool : {false, true}) {
    const ArmGeometry found = detail::starting_frames(start, station, true, tool);
    EXPECT_EQ(difference(found.tool().values(), arm.tool_frame().values()), 0);
    const PointRows before = start.positions(data.joints()), after = found.positions(data.joints());
    for (Index i = 0; i < 40; ++i) EXPECT_LT((point(after, i) - point(before, i) + anchor).norm(), 1e-10) << i;
    const ArmGeometry known = detail::starting_frames(start, station, false, tool);
    EXPECT_EQ(difference(known.parameters(), start.parameters()), 0);
  }
}

}  // namespace
}  // namespace vernier::frames_test
