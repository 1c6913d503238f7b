// SPDX-License-Identifier: BSD-3-Clause
// Measurements in matrices whose size is known at run time only: those that fit are taken, others are refused in every
// build, before Eigen converts them.

#include <gtest/gtest.h>

#include <type_traits>

#include "complaint.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/data/joint_coverage.hpp"

namespace data_sizes_test {
using namespace vernier;
using vernier_test::complaint;

const MatrixX joints = MatrixX::Random(4, 6), points = MatrixX::Random(4, 3);
const MatrixX narrow = MatrixX::Zero(4, 5), flat = MatrixX::Zero(4, 2);
const VectorX lengths = VectorX::Ones(4), two = VectorX::Ones(2);
const JointRows<6> fixed_joints = joints;
const PointRows fixed_points = points;
const std::string five = "5 joint values for an arm of 6 joints", pair = "2 coordinates for a point in space";

TEST(DataOfRunTimeSizes, ThoseThatFitAreTaken) {
  const Dataset<6> fixed(fixed_joints, fixed_points, fixed_points);
  for (const Dataset<6>& data :
       {Dataset<6>(joints, points, points), Dataset<6>(joints, fixed_points, points.leftCols(3)),
        Dataset<6>(fixed_joints, points, fixed_points), Dataset<6>(fixed_joints, fixed_points, points)}) {
    EXPECT_EQ(data.joints(), fixed.joints());
    EXPECT_EQ(data.positions(), fixed.positions());
    EXPECT_EQ(data.orientations(), fixed.orientations());
  }
  EXPECT_FALSE(Dataset<6>(joints, points).has_orientations());
  EXPECT_EQ(fixed.approached_from(2 * joints).previous(), fixed.approached_from(2 * fixed_joints).previous());
  EXPECT_EQ(Distances<6>(joints, lengths).joints(), fixed_joints);

  const auto coverage = JointCoverage<6>::covering(joints);
  EXPECT_EQ(coverage.ranges, JointCoverage<6>::covering(fixed_joints).ranges);
  const VectorX q = joints.row(1).transpose() + VectorX::Constant(6, 0.05);
  EXPECT_EQ(coverage(q), coverage(JointVector<6>(q)));
  EXPECT_EQ(coverage.derivative(q), coverage.derivative(JointVector<6>(q)));
}

TEST(DataOfRunTimeSizes, OthersAreRefused) {
  EXPECT_EQ(complaint([] { Dataset<6>(narrow, points); }), five);
  EXPECT_EQ(complaint([] { Dataset<6>(narrow, fixed_points); }), five);
  EXPECT_EQ(complaint([] { Dataset<6>(joints, flat); }), pair);
  EXPECT_EQ(complaint([] { Dataset<6>(fixed_joints, flat.leftCols(1)); }), "1 coordinate for a point in space");
  EXPECT_EQ(complaint([] { Dataset<6>(fixed_joints, fixed_points, flat); }), pair);
  EXPECT_EQ(complaint([] { Dataset<6>(joints, points).approached_from(narrow); }), five);
  EXPECT_EQ(complaint([] { Distances<6>(narrow, lengths); }), five);

  const auto coverage = JointCoverage<6>::covering(fixed_joints);
  const std::string refusal = "2 joint values for an arm of 6 joints";
  EXPECT_EQ(complaint([] { JointCoverage<6>::covering(narrow); }), five);
  EXPECT_EQ(complaint([&] { coverage(two); }), refusal);
  EXPECT_EQ(complaint([&] { coverage.derivative(two); }), refusal);
  const std::vector<std::vector<JointRange>> others(6), of_two(2);
  EXPECT_EQ(complaint([&] { coverage.joined(others, two); }),
            "JointCoverage: ranges of 6 joints and margins of 2 for an arm of 6 joints");
  EXPECT_EQ(complaint([&] { coverage.joined(of_two, VectorX::Ones(6)); }),
            "JointCoverage: ranges of 2 joints and margins of 6 for an arm of 6 joints");
}

static_assert(noexcept(std::declval<JointCoverage<6>>()(std::declval<const JointVector<6>&>())));
static_assert(std::is_aggregate_v<JointCoverage<6>>);

}  // namespace data_sizes_test
