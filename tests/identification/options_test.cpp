// SPDX-License-Identifier: BSD-3-Clause
// What may be asked of an identification, and of its sensors.

#include "vernier/identification/options.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier::options_test {
namespace {

using vernier_test::complaint;

const double infinity = std::numeric_limits<double>::infinity();

TEST(IdentifyOptions, NamesWhatIsUnusable) {
  const std::vector<std::string> names{"a1", "a2", "d1", "d2"};
  const auto said = [&](const IdentifyOptions& options) { return complaint([&] { options.validate(names); }); };
  EXPECT_EQ(said({.fixed = {"a2", "d2"}, .max_iterations = 1}), "");
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_NE(said({.length_prior_std = bad}).find("length_prior_std is"), std::string::npos) << bad;
    EXPECT_NE(said({.angle_prior_std = bad}).find("angle_prior_std is"), std::string::npos) << bad;
    EXPECT_NE(said({.joint_zero_prior_std = bad}).find("joint_zero_prior_std is"), std::string::npos) << bad;
  }
  EXPECT_EQ(said({.angle_prior_std = -2}), "IdentifyOptions: angle_prior_std is -2, must be positive");
  EXPECT_EQ(said({.max_iterations = 0}), "IdentifyOptions: max_iterations is 0, must be at least 1");
  EXPECT_EQ(said({.fixed = {"a2", "b2"}}),
            "IdentifyOptions: no parameter is called 'b2'; they are called like a1 or d1");
}

TEST(SensorModel, NamesWhatIsUnusable) {
  const auto said = [](const SensorModel& sensors) { return complaint([&] { sensors.validate(); }); };
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({.joint_sigma = 1e-5}), "");
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_NE(said({.position_sigma = bad}).find(": position_sigma is"), std::string::npos) << bad;
    EXPECT_NE(said({.orientation_sigma = bad}).find(": orientation_sigma is"), std::string::npos) << bad;
    EXPECT_NE(said({.distance_sigma = bad}).find(": distance_sigma is"), std::string::npos) << bad;
    EXPECT_NE(said({.contact_sigma = bad}).find(": contact_sigma is"), std::string::npos) << bad;
  }
  for (const double bad : {-1.0, infinity, std::nan("")})
    EXPECT_NE(said({.joint_sigma = bad}).find(": joint_sigma is"), std::string::npos) << bad;
}

// The middle row of three, its angles and the kinds of its joints.
TEST(ParallelRows, ByTwistTiltAndKindOfJoint) {
  const auto middle = [](double alpha, double beta, JointType here = JointType::revolute,
                         JointType next = JointType::revolute) {
    const DhRow across{.a = 0.1, .alpha = 1.5};
    DhRow row{.a = 0.3, .alpha = alpha, .beta = beta, .joint = here};
    DhRow last = across;
    last.joint = next;
    return parallel_rows(DhChain<3>::from_rows({across, row, last})) == std::vector<int>{1};
  };
  constexpr double pi = std::numbers::pi;
  EXPECT_TRUE(middle(0, 0));
  EXPECT_TRUE(middle(pi, 0));  // antiparallel
  EXPECT_TRUE(middle(-0.015, 0.015));
  EXPECT_TRUE(middle(0.0199, -0.0199));  // sines of 0.02 are the limit
  EXPECT_FALSE(middle(-0.0201, 0));
  EXPECT_FALSE(middle(0, 0.0201));
  EXPECT_FALSE(middle(0.05, 0));
  EXPECT_FALSE(middle(pi - 0.05, 0));
  EXPECT_FALSE(middle(0, 0.05));
  EXPECT_FALSE(middle(0, 0, JointType::prismatic));
  EXPECT_FALSE(middle(0, 0, JointType::revolute, JointType::prismatic));
}

}  // namespace
}  // namespace vernier::options_test
