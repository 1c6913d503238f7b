// SPDX-License-Identifier: BSD-3-Clause
// A model from text is the model of the file.
#include "vernier/io/model_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "vernier/core/data_error.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::model_text_test {
namespace {

CalibratedRobot<6> example() {
  const auto robot = robots::abb_irb120();
  using Model = CalibratedRobot<6>::Model;
  const Isometry3 base(Eigen::Translation3d(1.2, -0.4, 0.05));
  return {"an arm", Model(robot.chain, Model::Arm(robot.chain, base, {})), robot.limits, Provenance{.rows = 12}};
}

TEST(ModelText, HasTheBitsOfTheModel) {
  const CalibratedRobot<6> robot = example();
  const std::string text = to_json(robot).dump(1);
  const SavedModel read = parse_model(text, "a text");
  EXPECT_EQ(read.name(), "an arm");
  EXPECT_EQ(read.hash(), sha256(text));
  EXPECT_EQ(to_json(read.as<6>()).dump(1), text);
  const JointVector<6> q = JointVector<6>::LinSpaced(-1, 1);
  EXPECT_EQ(read.as<6>().pose(q).matrix(), robot.pose(q).matrix());
}

TEST(ModelText, IsNamedInMessages) {
  try {
    parse_model("{}", "row 7 of the database");
    FAIL() << "was read";
  } catch (const DataError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("row 7 of the database")) << error.what();
  }
}

}  // namespace
}  // namespace vernier::model_text_test
