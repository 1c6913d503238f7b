// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/data/dataset.hpp>

#include "complaint.hpp"
#include "real_matrix.hpp"

namespace dataset_test {
namespace {

using vernier::Dataset;
using vernier::Index;
using vernier::JointRows;
using vernier::PointRows;
using vernier::Vector3;
using vernier_test::complaint;
using vernier_test::RealMatrix;

Dataset<2> five_rows(bool oriented) {
  JointRows<2> q(5, 2);
  PointRows p(5, 3), r(oriented ? 5 : 0, 3);
  for (Index i = 0; i < 5; ++i) {
    const double k = static_cast<double>(i);
    vernier::set_configuration<2>(q, i, {k, -k});
    vernier::set_point(p, i, {10 * k, 10 * k + 1, 10 * k + 2});
    if (oriented) vernier::set_point(r, i, {0.1 * k, 0.2, -0.3});
  }
  return {q, p, r};
}

bool all_nan(const RealMatrix& a) {
  bool out = true;
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j) out = out && std::isnan(a(i, j));
  return out;
}

TEST(Dataset, PoseIsPositionAndOrientation) {
  const auto data = five_rows(true);
  const auto pose = data.pose(4);
  EXPECT_EQ(vernier::translation(pose), data.position(4));
  EXPECT_LT((vernier::log_so3(vernier::rotation(pose)) - Vector3(0.4, 0.2, -0.3)).norm(), 1e-14);
  EXPECT_EQ(RealMatrix(pose).row(3), RealMatrix(1, 4, {0, 0, 0, 1}));
}

TEST(Dataset, KnowsFromWhereEachRowWasApproachedAlsoAfterASplit) {
  const auto data = five_rows(false);
  const RealMatrix joints = RealMatrix::of(data.joints()), previous = RealMatrix::of(data.previous());
  EXPECT_TRUE(all_nan(previous.row(0)));
  EXPECT_EQ(previous.block(1, 0, 4, 2), joints.block(0, 0, 4, 2));
  EXPECT_EQ(RealMatrix(data.times()), vernier_test::vector({0, 1, 2, 3, 4}));
  const auto some = data.rows(std::array<Index, 3>{4, 0, 2});
  const RealMatrix previous_of_some = RealMatrix::of(some.previous());
  EXPECT_EQ(previous_of_some.row(0), joints.row(3));
  EXPECT_TRUE(all_nan(previous_of_some.row(1)));
  EXPECT_EQ(previous_of_some.row(2), joints.row(1));
  EXPECT_EQ(RealMatrix(some.times()), vernier_test::vector({4, 0, 2}));
  EXPECT_TRUE(all_nan(RealMatrix::of(data.without_approach().previous())));
  const auto stated = data.approached_from(data.joints()).measured_at(Eigen::VectorXd::Constant(5, 3.5));
  EXPECT_EQ(RealMatrix::of(stated.previous()), joints);
  EXPECT_EQ(stated.rows(std::array<Index, 1>{1}).times()(0), 3.5);
  EXPECT_EQ(complaint([&] { (void)data.approached_from(JointRows<2>(4, 2)); }),
            "Dataset: 4 previous configurations of 5 rows");
  EXPECT_NE(complaint([&] { (void)data.measured_at(Eigen::VectorXd::Zero(6)); }), "");
  EXPECT_NE(complaint([&] { (void)data.measured_at(Eigen::VectorXd::Constant(5, std::nan(""))); }), "");
}

TEST(Dataset, TemperaturesStayWithTheirRows) {
  const auto data = five_rows(false);
  EXPECT_EQ(data.temperatures().size(), 0);
  EXPECT_EQ(data.rows(std::array<Index, 2>{4, 0}).temperatures().size(), 0);
  const auto warm = data.at_temperatures(vernier_test::vector({20, 21, 22, 23, 24}));
  EXPECT_EQ(RealMatrix(warm.rows(std::array<Index, 2>{4, 0}).temperatures()), vernier_test::vector({24, 20}));
  EXPECT_EQ(warm.at_temperatures({}).temperatures().size(), 0);
  EXPECT_NE(complaint([&] { (void)data.at_temperatures(Eigen::VectorXd::Zero(6)); }), "");
  EXPECT_NE(complaint([&] { (void)data.at_temperatures(Eigen::VectorXd::Constant(5, std::nan(""))); }), "");
}

TEST(Dataset, RowsInTheOrderAskedFor) {
  for (const bool oriented : {false, true}) {
    const auto data = five_rows(oriented);
    const std::array<Index, 4> wanted{4, 0, 2, 2};
    const auto some = data.rows(wanted);
    ASSERT_EQ(some.size(), 4);
    EXPECT_EQ(some.has_orientations(), oriented);
    for (Index i = 0; i < 4; ++i) {
      const Index from = wanted[static_cast<std::size_t>(i)];
      EXPECT_EQ(RealMatrix::of(some.joints(i)), RealMatrix::of(data.joints(from)));
      EXPECT_EQ(some.position(i), data.position(from));
      if (oriented) {
        EXPECT_EQ(vernier::point(some.orientations(), i), vernier::point(data.orientations(), from));
      }
    }
    EXPECT_EQ(data.rows({}).size(), 0);
    EXPECT_NE(complaint([&] { (void)data.rows(std::array<Index, 1>{5}); }).find("row 5 of 5"), std::string::npos);
    EXPECT_NE(complaint([&] { (void)data.rows(std::array<Index, 1>{-1}); }).find("row -1 of 5"), std::string::npos);
  }
}

TEST(Dataset, RefusesRowsThatDoNotMatch) {
  const auto said = complaint([] { (void)Dataset<2>(JointRows<2>::Zero(4, 2), PointRows::Zero(5, 3)); });
  EXPECT_NE(said.find("4 rows of joints, but 5 rows of positions"), std::string::npos) << said;
  const auto turned =
      complaint([] { (void)Dataset<2>(JointRows<2>::Zero(4, 2), PointRows::Zero(4, 3), PointRows::Zero(3, 3)); });
  EXPECT_NE(turned.find("4 rows of joints, but 3 rows of orientations"), std::string::npos) << turned;
}

TEST(Dataset, RefusesWhatIsNotFiniteAndNamesTheRow) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf})
    for (const int part : {0, 1, 2}) {
      JointRows<2> q = JointRows<2>::Zero(4, 2);
      PointRows p = PointRows::Zero(4, 3), r = PointRows::Zero(4, 3);
      (part == 0 ? q(2, 1) : part == 1 ? p(2, 1) : r(2, 1)) = bad;
      const auto said = complaint([&] { (void)Dataset<2>(q, p, r); });
      EXPECT_NE(said.find("row 2"), std::string::npos) << said;
    }
}

}  // namespace
}  // namespace dataset_test
