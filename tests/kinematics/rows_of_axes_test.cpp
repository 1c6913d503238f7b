// SPDX-License-Identifier: BSD-3-Clause
// Rows of a chain from the axes of its joints.
#include "vernier/kinematics/detail/rows_of_axes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::rows_of_axes_test {
namespace {

using vernier_test::RealMatrix;

/// Axes of a chain at zero, and where it ends.
template <int N>
std::vector<detail::JointAxis> axes_of(const DhChain<N>& chain) {
  const auto links = chain.links(JointVector<N>::Zero());
  std::vector<detail::JointAxis> out;
  for (int i = 0; i < N; ++i) out.push_back({links.axis.col(i), links.point.col(i), chain.row(i).joint});
  return out;
}

/// The chain of the rows, between the frames that make it end where another does.
template <int N>
Framed<DhChain<N>> same_end(const detail::AxisRows& found, const DhChain<N>& chain) {
  std::array<DhRow, N> rows;
  std::copy(found.rows.begin(), found.rows.end(), rows.begin());
  const Isometry3 tool = found.frames.back().inverse() * chain.pose(JointVector<N>::Zero());
  return Framed<DhChain<N>>(DhChain<N>::from_rows(rows), FrameParameters(found.base), FrameParameters(tool));
}

TEST(RowsOfAxes, AreTheSameArm) {
  Rng rng(1);
  for (int i = 0; i < 300; ++i) {
    auto chain = vernier_test::random_chain<6>(rng);
    if (i % 3 > 0) {  // axes that are nearly parallel, or nearly turned over, at the limits of both rules as well
      auto p = chain.parameters();
      for (int row = 0; row < 5; ++row) {
        p(5 * row + 1) = (i % 2) * std::numbers::pi + rng.uniform(-0.25, 0.25) * std::pow(10.0, -(i % 17));
        p(5 * row + 4) = i % 5 == 0 ? 0 : 0.1 * p(5 * row + 4);
      }
      chain = chain.with_parameters(p);
    }
    const auto arm = same_end(detail::rows_of_axes(axes_of(chain)), chain);
    for (int sample = 0; sample < 10; ++sample) {
      const JointVector<6> q = vernier_test::random_joints<6>(rng);
      EXPECT_LE(vernier_test::difference(arm.pose(q), chain.pose(q)), 5e-14) << i;
    }
  }
}

TEST(RowsOfAxes, OfACatalogueArmAreItsRows) {
  const auto compare = [](const auto& chain) {
    std::vector<double> thetas;
    for (const DhRow& row : chain.rows()) thetas.push_back(row.theta);
    const detail::AxisRows found = detail::rows_of_axes(axes_of(chain), thetas);
    EXPECT_LE((found.base.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-15);
    for (std::size_t i = 0; i + 1 < found.rows.size(); ++i) {
      const DhRow &row = found.rows[i], &design = chain.rows()[i];
      for (const double difference : {row.a - design.a, row.alpha - design.alpha, row.d - design.d,
                                      row.theta - design.theta, row.beta - design.beta})
        EXPECT_NEAR(difference, 0, 1e-14) << i;
    }
    EXPECT_EQ(found.rows.back(), DhRow{});
  };
  compare(robots::ur10().chain);
  compare(robots::abb_irb120().chain);
  compare(robots::barrett_wam().chain);
}

TEST(RowsOfAxes, ThetaIsTheOneNextToTheGivenAngle) {
  for (const double wanted : {0.0, 3.0, 6.0, -100.0}) {
    const std::vector<detail::JointAxis> axes{{Vector3::UnitZ(), Vector3::Zero()},
                                              {Vector3::UnitZ(), Vector3(0.3, 0.1, 0.2)},
                                              {Vector3::UnitX(), Vector3(0.5, 0.5, 0.5)}};
    const auto rows = detail::rows_of_axes(axes, std::vector<double>(3, wanted)).rows;
    for (int i = 0; i < 2; ++i) EXPECT_LE(std::abs(rows[static_cast<std::size_t>(i)].theta - wanted), 1.5708) << i;
  }
  // without a wish: next to zero, and a > 0 where both are as near
  const std::vector<detail::JointAxis> tie{{Vector3::UnitZ(), Vector3::Zero()},
                                           {Vector3::UnitZ(), Vector3(1e-9, -0.3, 0)}};
  EXPECT_NEAR(detail::rows_of_axes(tie).rows[0].a, 0.3, 1e-9);
  const std::vector<detail::JointAxis> other{{Vector3::UnitZ(), Vector3::Zero()},
                                             {Vector3::UnitZ(), Vector3(-1e-9, -0.3, 0)}};
  EXPECT_NEAR(detail::rows_of_axes(other).rows[0].a, 0.3, 1e-9);
}

// The first frame has its origin where the axis is next to the base, and its x next to that of the base, or to y.
TEST(RowsOfAxes, TheFirstFrameIsNextToTheBase) {
  const RealMatrix up = detail::rows_of_axes(std::vector<detail::JointAxis>{{Vector3(0, 0, 1), Vector3(1, 2, 3)}}).base;
  EXPECT_LE(vernier_test::difference(up, RealMatrix(4, 4, {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 0, 0, 0, 0, 1})), 1e-15);
  const RealMatrix along =
      detail::rows_of_axes(std::vector<detail::JointAxis>{{Vector3(1, 0, 0), Vector3(5, 1, 2)}}).base;
  EXPECT_LE(vernier_test::difference(along, RealMatrix(4, 4, {0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 0, 1})), 1e-15);
}

// Up to 0.2 rad from parallel axes have Hayati's row, without d; beyond that the common normal, without beta.
TEST(RowsOfAxes, NearlyParallelAxesHaveBeta) {
  for (const double angle : {0.19, 0.21}) {
    const std::vector<detail::JointAxis> axes{{Vector3(0, 0, 1), Vector3(0, 0, 0)},
                                              {Vector3(std::sin(angle), 0, std::cos(angle)), Vector3(0.3, 0.1, 0.2)}};
    const DhRow row = detail::rows_of_axes(axes).rows[0];
    EXPECT_EQ(row.beta != 0, angle < 0.2);
    EXPECT_EQ(row.d == 0, angle < 0.2);
  }
}

// One frame a joint: z along its axis, its origin on it, x at the common normal, so that (a, 0, d) of the row is a
// point of the next axis.
TEST(RowsOfAxes, FramesStandOnTheirAxes) {
  Rng rng(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto chain = vernier_test::random_chain<6>(rng, {.prismatic = 0});
    const auto axes = axes_of(chain);
    const auto found = detail::rows_of_axes(axes);
    ASSERT_EQ(found.frames.size(), axes.size());
    ASSERT_EQ(found.rows.size(), axes.size());
    const auto off_axis = [&](std::size_t i, const Vector3& point) {
      return axes[i].direction.cross(Vector3(point - axes[i].point)).norm();
    };
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Isometry3& frame = found.frames[i];
      EXPECT_LT((Vector3(frame(0, 2), frame(1, 2), frame(2, 2)) - axes[i].direction).norm(), 1e-13) << i;
      EXPECT_LT(off_axis(i, translation(frame)), 1e-13) << i;
      if (i + 1 == axes.size()) break;
      const DhRow& row = found.rows[i];
      EXPECT_LT(off_axis(i + 1, transformed(frame, Vector3(row.a, 0, row.d))), 1e-12) << i;
    }
  }
}

TEST(RowsOfAxes, MisuseIsNamed) {
  EXPECT_NE(vernier_test::complaint([] { (void)detail::rows_of_axes({}); }).find("no joints"), std::string::npos);
  EXPECT_NE(vernier_test::complaint([] {
              const std::vector<detail::JointAxis> axes(2, {Vector3::UnitZ(), Vector3::Zero()});
              (void)detail::rows_of_axes(axes, std::vector<double>(1));
            }).find("1 angles for 2 joints"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::rows_of_axes_test
