// SPDX-License-Identifier: BSD-3-Clause
// Training rows whose pose is not that of their joints: named, left out, counted; kept if asked; many stop the run.

#include "vernier/calibration/outlying_row.hpp"

#include <gtest/gtest.h>

#include "ur10_measured.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier::outlying_rows_test {
namespace {

using namespace vernier_test::ur10_measured;

const CalibrateOptions models_alone{.remainder = {.learners = {}}};

/// Measured poses that stand in a file from line 2 on.
Dataset<6> in_a_file(Index poses, std::uint64_t seed) {
  std::vector<Index> lines(static_cast<std::size_t>(poses));
  for (Index i = 0; i < poses; ++i) lines[static_cast<std::size_t>(i)] = i + 2;
  return measure(actual_arm(), joints(poses, seed), noise, seed + 1).from(RowOrigin::of("m.csv", lines));
}

/// The same with some positions moved [m] and orientations turned [rad] about x.
Dataset<6> spoilt(const Dataset<6>& data, const std::vector<Index>& rows, double by, double turn = 0) {
  PointRows positions = data.positions(), orientations = data.orientations();
  for (const Index row : rows) {
    set_point(positions, row, Vector3(point(positions, row) + Vector3(0, by, 0)));
    const Matrix3 turned = exp_so3(Vector3(turn, 0, 0)) * data.orientation(row);
    set_point(orientations, row, log_so3(turned));
  }
  return Dataset<6>(data.joints(), positions, orientations).from(data.origin());
}

double error_of(const Calibration<Chain>& found) {
  return prediction_error(found.model(), measure(actual_arm(), joints(300, 99))).mean;
}

TEST(OutlyingRows, OnePointOfAHundredOffByTwoMetres) {
  const Dataset<6> clean = in_a_file(100, 1);
  const auto without = calibrate(robot.chain, clean, models_alone);
  EXPECT_TRUE(without.outliers.empty());
  const auto found = calibrate(robot.chain, spoilt(clean, {56}, 2), models_alone);
  ASSERT_EQ(found.outliers.size(), 1u);
  EXPECT_EQ(found.outliers[0].row, 56);
  EXPECT_EQ(where(found.outliers), "m.csv, line 58");
  EXPECT_NEAR(found.outliers[0].position, 2, 0.01);
  EXPECT_EQ(found.poses, 99);
  EXPECT_LT(error_of(found), 1.2 * error_of(without));

  const auto report = evaluate(found, spoilt(in_a_file(20, 7), {3}, 0.5));
  EXPECT_EQ(report.test_poses(), 20);  // held-out rows are never removed
  EXPECT_NEAR(report.stage(report.chosen).position.maxCoeff(), 0.5, 0.01);
  ASSERT_EQ(report.remarks().size(), 1u);
  EXPECT_NE(report.remarks()[0].find("1 training row is an outlier and left out: m.csv, line 58 (off by up to 2"),
            std::string::npos)
      << report.remarks()[0];
}

// A few millimetres are no outlier beside the geometry alone, but beside the fitted error model.
TEST(OutlyingRows, SmallOnesAreFoundBesideTheErrorModel) {
  const Dataset<6> clean = in_a_file(200, 3);
  const auto found = calibrate(robot.chain, spoilt(clean, {20, 100, 150}, 1.5e-3), models_alone);
  ASSERT_EQ(found.outliers.size(), 3u);
  EXPECT_EQ(where(found.outliers), "m.csv, lines 22, 102 and 152");
  EXPECT_EQ(found.poses, 197);
}

TEST(OutlyingRows, OrientationsCountAsWell) {
  const auto found = calibrate(robot.chain, spoilt(in_a_file(100, 5), {10}, 0, 0.3), models_alone);
  ASSERT_EQ(found.outliers.size(), 1u);
  EXPECT_EQ(found.outliers[0].line, 12);
  EXPECT_NEAR(found.outliers[0].rotation, 0.3, 0.01);
}

TEST(OutlyingRows, AreKeptIfAsked) {
  CalibrateOptions options = models_alone;
  options.keep_outliers = true;
  const auto found = calibrate(robot.chain, spoilt(in_a_file(100, 1), {56, 70}, 2), options);
  EXPECT_EQ(found.outliers.size(), 2u);
  EXPECT_TRUE(found.outliers_kept);
  EXPECT_EQ(found.poses, 100);
}

TEST(OutlyingRows, ManyStopTheRun) {
  const Dataset<6> clean = in_a_file(100, 1);
  EXPECT_NO_THROW(calibrate(robot.chain, spoilt(clean, {1, 20, 40, 60, 80}, 0.1), models_alone));
  const auto said = [&]() -> std::string {
    try {
      calibrate(robot.chain, spoilt(clean, {1, 20, 40, 60, 80, 90}, 0.1), models_alone);
    } catch (const CalibrationFailure& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said(),
            "m.csv, lines 3, 22, 42, 62, 82 and 92: 6 of 100 training rows are outliers, more than 5 %: check the "
            "entries and the pairing of joints and poses, or keep them (keep-outliers)");
}

TEST(OutlyingRows, NamesByStation) {
  const auto found =
      calibrate(robot.chain, std::vector<Dataset<6>>{Dataset<6>(in_a_file(60, 1)), spoilt(in_a_file(60, 5), {8}, 0.2)},
                models_alone);
  ASSERT_EQ(found.outliers.size(), 1u);
  EXPECT_EQ(found.outliers[0].station, 1u);
  EXPECT_EQ(found.outliers[0].row, 8);
  EXPECT_EQ(where({{.row = 4}, {.row = 7}}), "rows 4 and 7");
  EXPECT_EQ(where({{.file = "a.csv", .line = 4}, {.file = "b.csv", .line = 7}}), "a.csv, line 4 and b.csv, line 7");
}

}  // namespace
}  // namespace vernier::outlying_rows_test
