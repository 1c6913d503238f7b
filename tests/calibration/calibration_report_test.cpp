// Sentences of the report whose numbers are worked by hand.

#include "vernier/calibration/calibration_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace vernier::calibration_report_test {
namespace {

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
  CalibrationReport report;
  report.stages.push_back({"geometry", "geometry", VectorX::Constant(4, 1e-4), {}});
  report.gates = VectorX::Ones(4);
  report.drift = {drift};
  const std::vector<std::string> said = report.verdict();
  const auto found = std::find_if(said.begin(), said.end(),
                                  [](const std::string& one) { return one.rfind("During the session", 0) == 0; });
  ASSERT_NE(found, said.end());
  EXPECT_EQ(*found,
            "During the session the base moved by up to 0.05 mm and 30 urad, fastest (0.04 mm) between 110 and 120 of "
            "100 .. 120 [row, or time_s]. The zero of joint 2 moved most, by 20 urad [um]. The model that is saved is "
            "without drift.");
}

}  // namespace
}  // namespace vernier::calibration_report_test
