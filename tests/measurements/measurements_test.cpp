// SPDX-License-Identifier: BSD-3-Clause
// Measurements as one value: what is refused beside what the compiler sees.

#include "vernier/measurements/measurements.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"

namespace vernier::measurements_test {
namespace {

using vernier_test::complaint;

const MatrixX joints = MatrixX::Random(4, 6), narrow = MatrixX::Zero(4, 5);
const JointRows<6> fixed = joints;
const DistanceSensor sensor(VectorX::Ones(4));
const std::string refusal = "5 joint values for an arm of 6 joints";

TEST(Measurements, JointValuesOfARunTimeSizeThatFitsAreTaken) {
  const auto measured = Measurements<6>().add(joints, sensor, "wire").add_between(joints, 2 * fixed, sensor);
  ASSERT_EQ(measured.sets().size(), 2u);
  EXPECT_EQ(measured.sets()[0].name, "wire");
  EXPECT_EQ(measured.sets()[0].joints, joints);
  EXPECT_EQ(measured.sets()[1].joints, 2 * joints);
  EXPECT_EQ(measured.sets()[1].seen_from, joints);
}

TEST(Measurements, OthersAreRefused) {
  EXPECT_EQ(complaint([] { Measurements<6>().add(narrow, sensor); }), refusal);
  EXPECT_EQ(complaint([] { Measurements<6>().add_between(narrow, fixed, sensor); }), refusal);
  EXPECT_EQ(complaint([] { Measurements<6>().add_between(fixed, narrow, sensor); }), refusal);
  EXPECT_EQ(complaint([] { Measurements<6>().add_between(MatrixX(joints.topRows(3)), fixed, sensor); }),
            "distances: 3 first configurations and 4 second");
}

}  // namespace
}  // namespace vernier::measurements_test
