// Sentences of the report whose numbers are worked by hand.

#include "vernier/calibration/calibration_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace vernier::calibration_report_test {
namespace {

/// Whether a verdict has a sentence.
bool says(const std::vector<std::string>& verdict, const std::string& sentence) {
  return std::find(verdict.begin(), verdict.end(), sentence) != verdict.end();
}

/// A report of four held-out poses.
CalibrationReport report_of_four() {
  CalibrationReport out;
  out.stages.push_back({"geometry", "geometry", VectorX::Constant(4, 1e-4), {}});
  out.gates = VectorX::Ones(4);
  return out;
}

TEST(CalibrationReport, DriftByHand) {
  SessionDrift drift{.begin = 100, .spacing = 10};
  drift.knots = MatrixX::Zero(9, 3);
  drift.knots(0, 1) = 0.01e-3;  // x: 0, 0.01 and 0.05 mm
  drift.knots(0, 2) = 0.05e-3;
  drift.knots(5, 2) = 30e-6;
  for (Index k = 0; k < 3; ++k) {
    drift.knots(7, k) = 10e-6 * static_cast<double>(1 + k);      // joint 2: 10 to 30 urad
    drift.knots(8, k) = 7.5e-6 * static_cast<double>(k) - 5e-6;  // joint 3: -5 to 10 urad
  }
  CalibrationReport report = report_of_four();
  report.drift = {drift};
  report.joints.resize(3);
  for (const bool revolute : {true, false}) {
    report.joints[1].revolute = revolute;
    EXPECT_TRUE(says(report.verdict(),
                     "During the session the base moved by up to 0.05 mm and 30 urad, fastest (0.04 mm) between 110 "
                     "and 120 of 100 .. 120 [row, or time_s]. The zero of joint 2 moved most, by 20 " +
                         std::string(revolute ? "urad" : "um") + ". The model that is saved is without drift."));
  }
}

TEST(CalibrationReport, CountsPosesAndParameters) {
  CalibrationReport report = report_of_four();
  const std::string outside = " outside those ranges; there the learned functions of the joints fade out.";
  const std::string weak = " weakly determined and regularised around nominal.";
  report.gates(2) = 0.5;
  report.identification.parameters.resize(3);
  report.identification.parameters[1].state = ParameterState::weak;
  EXPECT_EQ(report.extrapolated(), 1);
  EXPECT_TRUE(says(report.verdict(), "1 held-out pose lies" + outside));
  EXPECT_TRUE(says(report.verdict(), "1 parameter is" + weak));
  report.gates(3) = 0;
  report.identification.parameters[2].state = ParameterState::weak;
  EXPECT_TRUE(says(report.verdict(), "2 held-out poses lie" + outside));
  EXPECT_TRUE(says(report.verdict(), "2 parameters are" + weak));
  report.advice.resize(1);
  EXPECT_TRUE(says(report.verdict(), "1 more parameter is" + weak));
}

}  // namespace
}  // namespace vernier::calibration_report_test
