// SPDX-License-Identifier: BSD-3-Clause
// What cannot belong to an arm is refused, and by how much it is off.

#include "vernier/calibration/detail/plausibility.hpp"

#include <gtest/gtest.h>

#include <string>

#include "set_of.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/touches.hpp"

namespace vernier::plausibility_test {
namespace {

// Touches of two plates taken for one: it lies in the middle between them.
TEST(PlausibilityWhiteBox, ContactsAreOffByTheirRootMeanSquare) {
  const DhChain<6> chain = robots::abb_irb120().chain;
  const ArmGeometry arm(in_frames(chain));
  const JointLimits<6> limits = abb_irb120_operating_region().limits;
  const auto together = [&](double apart) {
    MatrixX joints(80, 6);
    for (const int side : {0, 1}) {
      const VirtualObject plate{ContactKind::plane, Vector3(0.35, 0, 0.25 + side * apart), Vector3::UnitZ(), 0.3};
      joints.middleRows(40 * side, 40) = touch(chain, plate, "plate", VectorX::Zero(40), limits, 0, 1).joints();
    }
    return Contact("table", ContactKind::plane, joints);
  };
  const auto complaint = [&](double apart) -> std::string {
    try {
      detail::require_plausible_set(arm, vernier_test::set_of(together(apart)));
    } catch (const CalibrationFailure& failure) {
      return failure.what();
    }
    return {};
  };
  EXPECT_EQ(complaint(0.038), "");  // off by 19 mm
  const std::string said = complaint(0.06);
  const std::string before = "contact table: the tool point of the poses misses it by ";
  ASSERT_EQ(said.rfind(before, 0), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(before.size())), 30, 1) << said;  // tilted a little towards more of them
}

/// What is said of something; empty where nothing is.
template <class F>
std::string failure(const F& check) {
  try {
    check();
  } catch (const CalibrationFailure& said) {
    return said.what();
  }
  return {};
}

// The limit is a tenth of the spread of the points, at least 1 mm and at most 50 mm.
TEST(PlausibilityWhiteBox, PosesMayBeOffByATenthOfTheirSpread) {
  const ArmGeometry arm(in_frames(robots::abb_irb120().chain));
  JointRows<6> joints(2, 6);
  joints.setConstant(0.3);
  joints(1, 0) = 0.5;  // radii of some tenths of a metre
  PointRows positions(2, 3);
  const auto said = [&](double spread, double off) {
    positions << -spread, 0, 0, spread, 0, 0;
    const MeasuredSet poses("poses.csv", joints, PositionSensor(positions));
    return failure([&] { detail::require_plausible(arm, poses, off, "the IRB"); });
  };
  EXPECT_EQ(said(0.2, 19e-3), "");  // the measured positions spread wider than the arm's
  EXPECT_EQ(said(0.2, 21e-3),
            "poses.csv: with registered frames the model of the IRB is off by 21 mm (rms): wrong robot, units or "
            "columns?");
  EXPECT_EQ(said(3, 49e-3), "");
  EXPECT_NE(said(3, 51e-3), "");
  const PointRows modelled = arm.positions(joints);
  const double of_arm = (point(modelled, 0) - point(modelled, 1)).norm() / 2;
  EXPECT_EQ(said(1e-6, 0.099 * of_arm), "");
  EXPECT_NE(said(1e-6, 0.101 * of_arm), "");
  joints.setConstant(0.3);  // an arm that stands still
  EXPECT_EQ(said(1e-6, 0.9e-3), "");
  EXPECT_NE(said(1e-6, 1.1e-3), "");
}

TEST(PlausibilityWhiteBox, HintsByTheSizesOfJointsAndPositions) {
  const ArmGeometry arm(in_frames(robots::abb_irb120().chain));
  MatrixX joints(2, 6);
  PointRows positions(2, 3);
  const auto hint = [&](double largest, double ratio) {
    joints.setConstant(0.01);
    joints(1, 0) = -largest;
    const PointRows modelled = arm.positions(joints);
    const Vector3 half = 0.5 * ratio * (point(modelled, 1) - point(modelled, 0));
    set_point(positions, 0, half);
    set_point(positions, 1, -half);
    const MeasuredSet poses("data", joints, PositionSensor(positions));
    const std::string said = failure([&] { detail::require_plausible(arm, poses, 1, "arm"); });
    return said.substr(said.find("(rms): ") + 7);
  };
  EXPECT_EQ(hint(15.5, 1), "a joint of 15.5 rad looks like degrees in a _rad column");
  EXPECT_EQ(hint(14.5, 1), "wrong robot, units or columns?");
  EXPECT_EQ(hint(0.14, 1), "no joint exceeds 0.14 rad: radians in a _deg column?");
  EXPECT_EQ(hint(0.16, 1), "wrong robot, units or columns?");
  EXPECT_EQ(hint(1, 310), "the measured positions spread 310 times as wide as the arm's: x, y, z in mm called _m?");
  EXPECT_EQ(hint(1, 290), "wrong robot, units or columns?");
  EXPECT_EQ(hint(1, 1 / 310.0),
            "the arm's positions spread 310 times as wide as the measured ones: x, y, z in m called _mm?");
  EXPECT_EQ(hint(1, 1 / 290.0), "wrong robot, units or columns?");
}

// Distances that are off by as much to either side, from a point that they still agree on.
TEST(PlausibilityWhiteBox, DistancesAreOffByTheirRootMeanSquare) {
  const ArmGeometry arm(in_frames(robots::abb_irb120().chain));
  const Vector3 anchor(3, -2, 1);
  const auto said = [&](double off) {
    const JointRows<6> joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, 400, 3);
    VectorX lengths = distances_from(arm.positions(joints), anchor);
    for (Index i = 0; i < 400; ++i) lengths(i) += i % 2 == 0 ? off : -off;
    const MeasuredSet wire("wire.csv", joints, DistanceSensor(lengths));
    return failure([&] { detail::require_plausible_set(arm, wire); });
  };
  EXPECT_EQ(said(0.045), "");
  const std::string begin = "wire.csv: no fixed point is consistent with these distances, the best one is off by ";
  const std::string found = said(0.06);
  ASSERT_EQ(found.rfind(begin, 0), 0u) << found;
  EXPECT_NEAR(std::stod(found.substr(begin.size())), 60, 6) << found;
  EXPECT_NE(found.find(" mm (rms): wrong units, columns or rows?"), std::string::npos) << found;
}

TEST(PlausibilityWhiteBox, AnIdentificationThatMayNotBeUsed) {
  IdentificationReport report;
  report.message = "of 6 values 3 are known";
  const auto said = [&] { return failure([&] { detail::require_usable(report, "this step"); }); };
  EXPECT_EQ(said(), "");
  report.status = IdentifyStatus::underdetermined;
  EXPECT_EQ(said(), "");  // what is unknown is held and named
  report.too_few = true;
  EXPECT_EQ(said(),
            "this step is underdetermined: of 6 values 3 are known; measure more poses, with every joint moved widely, "
            "or fix parameters");
  report.too_few = false;
  report.status = IdentifyStatus::not_converged;
  EXPECT_EQ(said(),
            "this step did not converge: of 6 values 3 are known; look for outliers, wrong units or a wrong robot");
}

}  // namespace
}  // namespace vernier::plausibility_test
