// SPDX-License-Identifier: BSD-3-Clause
// What measurements are expected to say: derivatives of the pose, in units of what is known and of the sensor.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "planned_candidates.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier::expected_rows_test {
namespace {

using vernier_test::RealMatrix;
using vernier_test::some_candidates;

// Each column of the rows is the change of the pose by one prior size of one unknown, over the sensor's deviation.
TEST(ExpectedRows, AreDerivativesOfThePose) {
  const auto robot = robots::abb_irb120();
  const MeasurementCandidates<6> at = some_candidates(5, 1);
  detail::PlannedCalibration planned{
      ArmGeometry(in_frames(robot.chain)), {.frames = Frames::base_and_tool}, {.harmonics = 4}, {}, true, 30};
  const RealMatrix rows = detail::expected_rows(planned, at.joints, at.previous);
  const JointTerms terms = detail::allowed_terms(planned.nominal.chain(), planned.errors, 30);
  const VectorX sizes = detail::expected_sizes(terms, planned.errors, detail::spectra_of(planned.errors, 6));
  EXPECT_TRUE(terms.gear_ratio && terms.coupling && terms.gravity && terms.tilt && !terms.hysteresis.empty());
  const Index geometric = rows.cols() - terms.size();
  constexpr double step = 1e-3;  // prior sizes
  for (Index k = 0; k < terms.size(); ++k) {
    std::array<std::vector<Isometry3>, 2> ends;
    for (const int sign : {0, 1}) {
      VectorX coefficients = VectorX::Zero(terms.size());
      coefficients(k) = (sign ? 1 : -1) * step * sizes(k);
      const WithJointErrors<DhChain<6>> arm(robot.chain, JointErrors(terms, coefficients));
      for (Index i = 0; i < 5; ++i) {
        const JointVector<6> from = configuration(at.previous, i);
        ends[static_cast<std::size_t>(sign)].push_back(arm.pose_from(from.data(), configuration(at.joints, i)));
      }
    }
    for (Index i = 0; i < 5; ++i) {
      const auto& low = ends[0][static_cast<std::size_t>(i)];
      const auto& high = ends[1][static_cast<std::size_t>(i)];
      const Vector3 shift = translation(high) - translation(low),
                    turn = log_so3(rotation(composed(high, inverse_of(low))));
      RealMatrix expected(6, 1);
      expected.set_block(0, 0, RealMatrix(shift) / (2 * step * planned.sensors.position_sigma));
      expected.set_block(3, 0, RealMatrix(turn) / (2 * step * planned.sensors.orientation_sigma));
      EXPECT_LT((rows.block(6 * i, geometric + k, 6, 1) - expected).norm(), 1e-5 * (1 + expected.norm()))
          << terms.names()[static_cast<std::size_t>(k)] << ", pose " << i;
    }
  }
  // the first unknown is the base's x, which is known to 30 times 10 mm
  for (Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(rows(6 * i, 0), 0.3 / planned.sensors.position_sigma, 1e-6);
    EXPECT_NEAR(rows.block(6 * i + 1, 0, 5, 1).norm(), 0, 1e-6);
  }
  planned.oriented = false;
  const RealMatrix positions = detail::expected_rows(planned, at.joints, at.previous);
  ASSERT_EQ(positions.rows(), 15);
  for (Index i = 0; i < 5; ++i)
    EXPECT_EQ(positions.block(3 * i, 0, 3, rows.cols()), rows.block(6 * i, 0, 3, rows.cols()));
}

/// The parameters that `identify` estimates of an IRB 120: frames first; its second and third axes are parallel.
std::vector<std::string> estimated_of_irb120() {
  std::vector<std::string> out;
  for (const char* frame : {"base_", "tool_"})
    for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) out.push_back(std::string(frame) + axis);
  for (int row = 1; row <= 6; ++row)
    for (const char* name : {"a", "alpha", row == 2 ? "" : "d", "theta", row == 2 ? "beta" : ""})
      if (*name != 0) out.push_back(name + std::to_string(row));
  return out;
}

// Geometry likewise: of the chain by the expected sizes of its errors, of the frames by 30 times 10 mm and 10 mrad.
TEST(ExpectedRows, OfGeometryAreDerivativesOfThePose) {
  const MeasurementCandidates<6> at = some_candidates(3, 1);
  ErrorModelOptions no_errors{.compliance = false, .harmonics = 0, .hysteresis = false, .tilt = false};
  const SensorModel sensors{.position_sigma = 2e-3, .orientation_sigma = 5e-3};
  IdentifyOptions geometry{.frames = Frames::base_and_tool};
  geometry.length_prior_std = 2e-3;
  geometry.angle_prior_std = 3e-3;
  geometry.joint_zero_prior_std = 7e-3;
  const detail::PlannedCalibration planned{
      ArmGeometry(in_frames(robots::abb_irb120().chain)), geometry, no_errors, sensors, true, 30};
  const RealMatrix rows = detail::expected_rows(planned, at.joints, MatrixX());
  const std::vector<std::string> estimated = estimated_of_irb120(), names = planned.nominal.parameter_names();
  ASSERT_EQ(rows.cols(), static_cast<Index>(estimated.size()));
  constexpr double step = 1e-6;
  for (std::size_t k = 0; k < estimated.size(); ++k) {
    const std::string& name = estimated[k];
    const Index parameter = std::find(names.begin(), names.end(), name) - names.begin();
    VectorX low = planned.nominal.parameters(), high = low;
    low(parameter) -= step;
    high(parameter) += step;
    const auto below = planned.nominal.with_parameters(low).poses(at.joints),
               above = planned.nominal.with_parameters(high).poses(at.joints);
    const double size = k < 12 ? 0.3 : name[0] == 't' ? 7e-3 : name[0] == 'd' || name[1] < 'a' ? 2e-3 : 3e-3;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 shift = translation(above[i]) - translation(below[i]),
                    turn = log_so3(rotation(composed(above[i], inverse_of(below[i]))));
      RealMatrix expected(6, 1);
      expected.set_block(0, 0, RealMatrix(shift) * (size / (2 * step * 2e-3)));
      expected.set_block(3, 0, RealMatrix(turn) * (size / (2 * step * 5e-3)));
      const RealMatrix found = rows.block(6 * static_cast<Index>(i), static_cast<Index>(k), 6, 1);
      EXPECT_LT((found - expected).norm(), 1e-6 * (1 + expected.norm())) << name << ", pose " << i;
    }
  }
}

// Errors of the joint readings move the tool by the Jacobian: what a pose says about the unknowns is A' C^-1 A.
TEST(ExpectedRows, CountErrorsOfTheJointReadings) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> at = some_candidates(1, 1);
  detail::PlannedCalibration planned{
      ArmGeometry(in_frames(chain)), {.frames = Frames::base_and_tool}, {.harmonics = 2}, {}, true, 30};
  const RealMatrix exact = detail::expected_rows(planned, at.joints, at.previous);
  planned.sensors.joint_sigma = 0.2e-3;
  const RealMatrix rows = detail::expected_rows(planned, at.joints, at.previous);
  RealMatrix covariance(6, 6), unwhitened = exact;
  for (Index k = 0; k < 6; ++k) {
    const double sigma = k < 3 ? planned.sensors.position_sigma : planned.sensors.orientation_sigma;
    covariance(k, k) = sigma * sigma;
    for (Index c = 0; c < exact.cols(); ++c) unwhitened(k, c) *= sigma;
  }
  const RealMatrix jacobian = 0.2e-3 * RealMatrix::of(chain.jacobian(configuration(at.joints, 0)));
  covariance += jacobian * jacobian.transpose();
  const RealMatrix expected = unwhitened.transpose() * covariance.inverse() * unwhitened;
  EXPECT_LT((rows.transpose() * rows - expected).norm(), 1e-6 * expected.norm());
}

}  // namespace
}  // namespace vernier::expected_rows_test
