// SPDX-License-Identifier: BSD-3-Clause
// What a re-registration says of itself, by hand.

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "registrations.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier::reregistration_report_test {
namespace {

using vernier_test::another_tool;
using vernier_test::frame;
using vernier_test::mentions;

TEST(ReregistrationReport, AToolIsFarBeyondThreeOfItsExpectedSizes) {
  ReregistrationReport report;
  report.estimated.tool = true;
  report.motion.tool = frame(Vector6{0, 8.9e-3, 0, 0, 0, 14.9e-3});
  EXPECT_TRUE(report.remarks().empty());
  report.motion.tool = frame(Vector6{0, 9.1e-3, 0, 0, 0, 15.1e-3});
  ASSERT_EQ(report.remarks().size(), 2u);
  EXPECT_TRUE(mentions(report.remarks()[0], "The tool has moved by 9.10 mm, where 3.00 are expected"));
  EXPECT_TRUE(mentions(report.remarks()[1], "The tool has turned by 15.10 mrad, where 5.00 are expected"));
}

TEST(ReregistrationReport, AResidualTenTimesTheHeldOutErrorIsSaid) {
  ReregistrationReport report;
  report.estimated.expected_error = 0.1e-3;
  report.rms_after = 0.99e-3;
  EXPECT_TRUE(report.remarks().empty());
  report.rms_after = 2.5e-3;
  EXPECT_EQ(report.remarks(),
            std::vector<std::string>{
                "After registration 2.500 mm are left, 25 times the error of the calibration at held-out poses (0.100 "
                "mm): are these poses of this arm, with joints in its order and units?"});
  report.estimated.expected_error = 0;  // unknown
  EXPECT_TRUE(report.remarks().empty());
  ReregisterOptions wrong;
  wrong.expected_error = -1;
  EXPECT_THROW(wrong.validate(), std::invalid_argument);
}

TEST(ReregistrationReport, PosesOutsideTheMeasuredRangesAreSaid) {
  ReregistrationReport report;
  report.poses = 12;
  report.outside = {2, 5};
  EXPECT_EQ(report.remarks(), std::vector<std::string>{
                                  "2 of 12 poses (rows 2 and 5) lie outside the measured joint ranges, where the model "
                                  "knows less: register by poses inside."});
}

TEST(ReregistrationReport, TheLeastCertainDirectionOfAToolIsSaid) {
  for (Index axis = 0; axis < 3; ++axis) {
    ReregistrationReport report;
    report.estimated = another_tool();
    report.change_std = VectorX::Constant(12, 0.1e-3);
    report.change_std(6 + axis) = 2e-3;
    report.change_std(9 + axis) = 4e-3;
    EXPECT_EQ(report.remarks(),
              (std::vector<std::string>{"The poses determine the position of the tool to 2.0 mm only.",
                                        "The poses determine the rotation of the tool to 4.0 mrad only."}))
        << axis;
  }
}

/// A report of an arm with a revolute and a sliding joint, of which everything was estimated.
ReregistrationReport of_two_joints() {
  ReregistrationReport report;
  report.estimated = {.base = true, .tool = true, .offsets = true};
  report.joint_types = {JointType::revolute, JointType::prismatic};
  report.motion.base = frame(Vector6{1e-3, -2e-3, 3e-3, 4e-3, -5e-3, 6e-3});
  report.motion.offsets = VectorX{{0.125e-3, -0.25e-3}};
  report.motion.tool = frame(Vector6{0.5e-3, 0.25e-3, -0.75e-3, 1.5e-3, 1.25e-3, -1.75e-3});
  report.change_std.resize(14);
  for (Index k = 0; k < 14; ++k) report.change_std(k) = 0.01e-3 * static_cast<double>(k + 1);
  report.position_sigma = 0.05e-3;
  report.orientation_sigma = 0.2e-3;
  return report;
}

TEST(ReregistrationReport, SummaryByHand) {
  ReregistrationReport report = of_two_joints();
  EXPECT_EQ(report.summary(),
            "Base moved by (1.000, -2.000, 3.000) +- (0.010, 0.020, 0.030) mm, turned by (4.000, -5.000, 6.000) +- "
            "(0.040, 0.050, 0.060) mrad\n"
            "Zero of joint 1 moved by +0.1250 +- 0.0700 mrad\n"
            "Zero of joint 2 moved by -0.2500 +- 0.0800 mm\n"
            "Tool moved by (0.500, 0.250, -0.750) +- (0.090, 0.100, 0.110) mm, turned by (1.500, 1.250, -1.750) +- "
            "(0.120, 0.130, 0.140) mrad\n"
            "Weighted for residuals of 0.050 mm and 0.200 mrad a component\n");
  report.change_std.resize(0);  // not determined
  report.orientation_sigma = 0;
  report.estimated.offsets = false;
  EXPECT_EQ(report.summary(),
            "Base moved by (1.000, -2.000, 3.000) mm, turned by (4.000, -5.000, 6.000) mrad\n"
            "Tool moved by (0.500, 0.250, -0.750) mm, turned by (1.500, 1.250, -1.750) mrad\n"
            "Weighted for residuals of 0.050 mm a component\n");
  report.held = {"the position of the tool"};  // remarks end it
  EXPECT_TRUE(mentions(report.summary(),
                       "component\nThe poses do not determine the position of the tool: held where it was.\n"));
}

TEST(ReregistrationReport, AProbeThatTurnedIsSaidInNumbers) {
  ReregistrationReport report;
  report.probe_turned = true;
  report.motion.probe = Vector3(1.2e-3, 0.25e-3, -0.9e-3);
  report.probe_std = Vector3(0.1e-3, 0.2e-3, 0.3e-3);
  report.contradiction = 52.4;
  EXPECT_EQ(report.remarks(),
            std::vector<std::string>{
                "Measured orientations are turned by 1.52 mrad against the tool, (1.20, 0.25, -0.90) +- (0.10, 0.20, "
                "0.30) in its frame (statistic 52, by chance up to 16.3): was the probe remounted? The rotation is "
                "taken off the orientations; the model's tool is kept."});
}

// A zero is little known where more than half of its prior is left, wherever the zeros stand among what is estimated.
TEST(ReregistrationReport, ZerosOfWhichMoreThanHalfThePriorIsLeft) {
  for (const bool base : {false, true}) {
    ReregistrationReport report;
    report.estimated = {.base = base, .offsets = true, .offset_prior_std = 2e-3};
    report.motion.offsets = VectorX::Zero(3);
    report.change_std = VectorX::Constant(base ? 9 : 3, 5e-3);
    const Index zeros = base ? 6 : 0;
    report.change_std(zeros) = 0.9e-3;
    report.change_std(zeros + 1) = 1.1e-3;
    report.change_std(zeros + 2) = 0.95e-3;
    EXPECT_EQ(report.remarks(), std::vector<std::string>{"The poses tell little about the zeros of joints 2: held near "
                                                         "where they were."})
        << base;
  }
}

// Another tool is known to a millimetre and a milliradian, or that is said; one with a prior is known as well as that.
TEST(ReregistrationReport, AToolIsVagueBeyondAThousandthWithoutItsPrior) {
  const double infinity = std::numeric_limits<double>::infinity();
  ReregistrationReport report;
  report.estimated = {.base = false, .tool = true};
  report.change_std = VectorX::Constant(6, 1.1e-3);
  EXPECT_TRUE(report.remarks().empty());
  report.estimated.tool_position_prior_std = infinity;
  EXPECT_EQ(report.remarks(), std::vector<std::string>{"The poses determine the position of the tool to 1.1 mm only."});
  report.estimated.tool_position_prior_std = 3e-3;
  report.estimated.tool_rotation_prior_std = infinity;
  EXPECT_EQ(report.remarks(),
            std::vector<std::string>{"The poses determine the rotation of the tool to 1.1 mrad only."});
  report.change_std.setConstant(0.9e-3);
  EXPECT_TRUE(report.remarks().empty());
}

}  // namespace
}  // namespace vernier::reregistration_report_test
