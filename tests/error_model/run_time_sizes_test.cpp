// SPDX-License-Identifier: BSD-3-Clause
// Joint values for fitted arms in vectors whose size is known at run time only: those that fit are taken, others are
// refused in every build, before Eigen converts them.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/identification/calibrated.hpp"
#include "vernier/kinematics/robots.hpp"

namespace error_model_sizes_test {
using namespace vernier;
using vernier_test::complaint;
using Chain = DhChain<6>;
using Model = ErrorModel<Chain>;

const Chain arm = robots::abb_irb120().chain;
const Framed<Chain> framed(arm, FrameParameters(Vector6{0.1, 0.2, 0.3, 0, 0, 0}));
const Calibrated<Chain> calibrated(framed, arm);
const Model model(arm, framed.around(WithJointErrors<Chain>(arm)), framed.around(WithJointErrors<Chain>(arm)),
                  JointCoverage<6>());
const VectorX six = VectorX::LinSpaced(6, 0.1, 0.6), two = VectorX::Constant(2, 0.1);
const JointVector<6> fixed = six;
const std::string refusal = "2 joint values for an arm of 6 joints";

/// Of one station, with one unknown.
FittedErrorModel<Chain> fitted() {
  ErrorModelEstimate estimate{.arm = ArmParameterisation({ArmGeometry(framed)}, {{0, -1, 1e-3, 0}})};
  estimate.covariance = MatrixX::Identity(1, 1);
  FittedErrorModel<Chain> out(std::move(estimate));
  out.stages.push_back({Stage::geometry, true, {model}});
  return out;
}

template <class Arm>
void expect_sizes_checked(const Arm& now) {
  EXPECT_EQ(now.pose(six).matrix(), now.pose(fixed).matrix());
  EXPECT_EQ(now.position(six), now.position(fixed));
  EXPECT_EQ(now.jacobian(six), now.jacobian(fixed));
  EXPECT_EQ(now.pose_and_jacobian(six).jacobian, now.jacobian(fixed));
  EXPECT_EQ(complaint([&] { now.pose(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.position(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.jacobian(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.pose_and_jacobian(six.head(2)); }), refusal);
}

TEST(FittedArmsOfRunTimeSizes, ThoseThatFitAreTakenOthersRefused) {
  expect_sizes_checked(calibrated);
  expect_sizes_checked(model);
  expect_sizes_checked(model.approached_from(fixed));
}

TEST(FittedArmsOfRunTimeSizes, GatesAndMotions) {
  const auto at = model.approached_from(six);
  EXPECT_EQ(at.pose(fixed).matrix(), model.approached_from(fixed).pose(fixed).matrix());
  EXPECT_EQ(model.gate(six), model.gate(fixed));
  EXPECT_EQ(at.gate(six), at.gate(fixed));
  const Isometry3 none = Isometry3::Identity();
  EXPECT_EQ(model.moved(none, six, none).position(fixed), model.moved(none, fixed, none).position(fixed));
  EXPECT_EQ(complaint([&] { model.gate(two); }), refusal);
  EXPECT_EQ(complaint([&] { at.gate(two); }), refusal);
  EXPECT_EQ(complaint([&] { model.moved(none, two, none); }), refusal);
  EXPECT_EQ(complaint([&] { model.approached_from(two); }), refusal);
  EXPECT_EQ(complaint([&] { ApproachedErrorModel<Chain>(model, two); }), refusal);
}

TEST(FittedArmsOfRunTimeSizes, Predictions) {
  const FittedErrorModel<Chain> found = fitted();
  EXPECT_EQ(found.predicted(six).covariance, found.predicted(fixed).covariance);
  EXPECT_EQ(found.predicted_from(six, fixed).pose.matrix(), found.predicted_from(fixed, fixed).pose.matrix());
  EXPECT_EQ(found.predicted_from(fixed, six).covariance, found.predicted_from(fixed, fixed).covariance);
  EXPECT_EQ(complaint([&] { found.predicted(two); }), refusal);
  EXPECT_EQ(complaint([&] { found.predicted_from(two, six); }), refusal);
  EXPECT_EQ(complaint([&] { found.predicted_from(fixed, two); }), refusal);
  EXPECT_EQ(complaint([&] { found.predicted_from(two, fixed); }), refusal);
}

static_assert(noexcept(model.pose(fixed)) && noexcept(model.gate(fixed)) && noexcept(model.approached_from(fixed)));
static_assert(noexcept(calibrated.pose_and_jacobian(fixed)));
static_assert(sizeof(Calibrated<Chain>) == 2 * sizeof(Framed<Chain>), "the base class costs nothing");

}  // namespace error_model_sizes_test
