#include "vernier/identification/frames.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::frames_test {
namespace {

using vernier_test::complaint;

TEST(RegisterPoints, FindsTheMotionExactly) {
  Rng rng(1);
  PointRows from(20, 3);
  for (auto& x : from.reshaped()) x = rng.normal();
  Isometry3 motion = Isometry3::Identity();
  motion.linear() = exp_so3(Vector3(2.0, -1.5, 1.0));
  motion.translation() = Vector3(3, -2, 5);
  PointRows to(20, 3);
  for (Index i = 0; i < 20; ++i) to.row(i) = (motion * Vector3(from.row(i).transpose())).transpose();
  EXPECT_TRUE(register_points(from, to).isApprox(motion, 1e-13));
}

TEST(RegisterPoints, NeverReflects) {
  PointRows from(4, 3), to(4, 3);
  from << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  to << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1;  // a mirror image
  EXPECT_NEAR(register_points(from, to).linear().determinant(), 1, 1e-12);
}

TEST(Trilaterate, FindsThePoint) {
  Rng rng(1);
  PointRows points(20, 3);
  for (auto& x : points.reshaped()) x = rng.uniform(-1, 1);
  const Vector3 from(3, -2, 0.5);
  const VectorX distances = (points.rowwise() - from.transpose()).rowwise().norm();
  EXPECT_LT((trilaterate(points, distances) - from).norm(), 1e-12);
  points.col(2).setZero();  // on a plane: the point's mirror image is as good, so it is put between the two
  const VectorX flat = (points.rowwise() - from.transpose()).rowwise().norm();
  EXPECT_LT((trilaterate(points, flat) - Vector3(3, -2, 0)).norm(), 1e-12);
  EXPECT_NE(complaint([&] { (void)trilaterate(points, VectorX::Ones(3)); }).find("20 points, 3 distances"),
            std::string::npos);
}

TEST(StartingFrames, FindsFramesOfANominalArm) {
  const auto robot = robots::ur10();
  const Framed<DhChain<6>> actual(robot.chain, FrameParameters(Vector6{0.4, -3.2, 0.2, -0.9, -1.3, -0.9}),
                                  FrameParameters(Vector6{0.01, 0.02, 0.109, 0.1, -0.3, 2.0}));
  const auto data = measure(actual, sample_joints(robot.limits, 60, 1));
  const auto found = starting_frames(robot.chain, data, true, true);
  EXPECT_LT((found.base().translation() - actual.base().translation()).norm(), 1e-3);
  EXPECT_LT(log_so3(found.base().linear().transpose() * actual.base().linear()).norm(), 1e-3);
  EXPECT_LT((found.tool().translation() - actual.tool().translation()).norm(), 1e-3);
  EXPECT_LT(log_so3(found.tool().linear().transpose() * actual.tool().linear()).norm(), 2e-3);
}

TEST(StartingFrames, KnownFramesStay) {
  const auto robot = robots::ur5();
  const FrameParameters base(Vector6{1, 2, 3, 0.1, 0.2, 0.3});
  const auto data = measure(Framed<DhChain<6>>(robot.chain, base), sample_joints(robot.limits, 20, 1));
  const auto found = starting_frames(Framed<DhChain<6>>(robot.chain, base), data, false, true);
  EXPECT_TRUE(found.base().matrix() == base.isometry().matrix());
  EXPECT_LT(found.tool().translation().norm(), 1e-12);
}

}  // namespace
}  // namespace vernier::frames_test
