// SPDX-License-Identifier: BSD-3-Clause
// Contacts beside measured poses, in one fit.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "gauss_newton.hpp"
#include "real_matrix.hpp"
#include "touched_objects.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::contacts_beside_poses_test {
namespace {

using vernier_test::actual_arm;
using vernier_test::identify_by_gauss_newton;
using vernier_test::lengths;
using vernier_test::nominal_arm;
using vernier_test::registered_mean;
using vernier_test::three_planes;
using vernier_test::touched;

const ErrorModelOptions geometry_alone{
    .compliance = false, .harmonics = 0, .hysteresis = false, .tilt = false, .drift = false};

Dataset<6> poses(double sigma) {
  return measure(actual_arm(), abb_irb120_operating_region().sample(robots::abb_irb120().chain, 50, 5),
                 {.position = sigma, .with_orientations = false}, 6);
}

double fitted_error(double sigma, const SensorModel& sensors, std::span<const Contact> contacts) {
  const Dataset<6> data = poses(sigma);
  const auto start =
      identify_by_gauss_newton(nominal_arm(), data, {.frames = Frames::base_and_tool}, {.loss = Loss::squared});
  const auto fitted = fit_error_model(start, Measurements<6>(data).add(contacts), geometry_alone, sensors);
  EXPECT_TRUE(fitted.converged);
  EXPECT_EQ(fitted.models().size(), 1 + contacts.size());
  return registered_mean(fitted.models().front());
}

TEST(ContactsBesidePoses, PreciseContactsImproveNoisyPoses) {
  const SensorModel sensors{.position_sigma = 0.5e-3, .contact_sigma = 0.01e-3, .loss = Loss::squared};
  std::vector<Contact> contacts = three_planes(true, 40, 0.01e-3);
  contacts.push_back(
      touched({ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", VectorX::Constant(20, 0.02), 0.01e-3, 9));
  contacts.push_back(
      touched({ContactKind::socket, {0.3, 0.1, 0.4}, Vector3(0.6, 0, -0.8)}, "bar", lengths(20, 10, 0.15), 0.01e-3, 8));
  const double without = fitted_error(0.5e-3, sensors, {}), with = fitted_error(0.5e-3, sensors, contacts);
  EXPECT_GT(without, 0.1e-3);
  EXPECT_LT(with, 0.25 * without);
}

TEST(ContactsBesidePoses, WithoutNoiseTheyAgree) {
  EXPECT_LT(fitted_error(0, {.loss = Loss::squared}, three_planes(false, 10)), 1e-7);
}

TEST(ContactsBesidePoses, NeedPosesOfTheSameArm) {
  const Dataset<6> data = poses(1e-5);
  const auto start =
      identify_by_gauss_newton(nominal_arm(), data, {.frames = Frames::base_and_tool}, {.loss = Loss::squared});
  const vernier_test::RealMatrix joints = three_planes(true)[0].joints();
  const std::vector five{Contact("p", ContactKind::plane, joints.block(0, 0, joints.rows(), 5))};
  EXPECT_EQ(vernier_test::complaint([&] { (void)Measurements<6>(data).add(five); }),
            "contact p: 5 joints, the arm has 6");
  const Distances<6> wire(data.joints(), VectorX::Ones(data.size()));
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)fit_error_model(start, Measurements<6>(wire).add(three_planes(true)[0]), geometry_alone);
            }).rfind("fit_error_model: contact ", 0),
            0u);
}

}  // namespace
}  // namespace vernier::contacts_beside_poses_test
