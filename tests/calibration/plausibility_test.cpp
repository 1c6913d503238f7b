// What cannot belong to an arm is refused, and by how much it is off.

#include "vernier/calibration/detail/plausibility.hpp"

#include <gtest/gtest.h>

#include <string>

#include "vernier/kinematics/robots.hpp"
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
      detail::require_plausible_contact(arm, together(apart));
    } catch (const CalibrationFailure& failure) {
      return failure.what();
    }
    return {};
  };
  EXPECT_EQ(complaint(0.03), "");
  const std::string said = complaint(0.06);
  const std::string before = "contact table: the tool point of the poses misses it by ";
  ASSERT_EQ(said.rfind(before, 0), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(before.size())), 30, 1) << said;  // tilted a little towards more of them
}

}  // namespace
}  // namespace vernier::plausibility_test
