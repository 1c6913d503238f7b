// SPDX-License-Identifier: BSD-3-Clause
// Arms of one joint and of four, whose re-registration is worked by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/registration/recursive_calibration.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier::few_joints_test {
namespace {

using vernier_test::RealMatrix;

constexpr double infinity = std::numeric_limits<double>::infinity();

template <int N>
ErrorModel<DhChain<N>> rigid(const DhChain<N>& chain) {
  return {chain, typename ErrorModel<DhChain<N>>::Arm(WithJointErrors<DhChain<N>>(chain))};
}

/// One joint about z at some angles, and positions measured at a radius of its own for each, at a height of 0.3 m.
Dataset<1> around(const std::vector<double>& radii) {
  const auto n = static_cast<Index>(radii.size());
  JointRows<1> joints(n, 1);
  PointRows positions(n, 3);
  for (Index i = 0; i < n; ++i) {
    const double q = 0.7 * static_cast<double>(i), r = radii[static_cast<std::size_t>(i)];
    joints(i, 0) = q;
    set_point(positions, i, Vector3(r * std::cos(q), r * std::sin(q), 0.3));
  }
  return {joints, positions};
}

// A point on the joint's axis does not see the joint turn: its zero is as uncertain as before, and that is said.
TEST(ReregisterOneJoint, IsLeftToItsPriorWhereNothingTells) {
  const auto model = rigid<1>(DhChain<1>({{.d = 0.3}}));
  const auto found = reregister(model, around({0, 0, 0}), {.base = false, .offsets = true, .offset_prior_std = 2e-3},
                                {.position_sigma = 0.03e-3});
  EXPECT_TRUE(found.determined);
  EXPECT_TRUE(found.converged);
  ASSERT_EQ(found.change_std.size(), 1);
  EXPECT_NEAR(found.change_std(0), 2e-3, 1e-15);
  EXPECT_EQ(found.motion.offsets(0), 0);
  EXPECT_EQ(found.joint_types, std::vector<JointType>{JointType::revolute});
  const std::string remark = "The poses tell little about the zeros of joints 1: held near where they were.";
  EXPECT_EQ(found.remarks(), std::vector<std::string>{remark});
  EXPECT_EQ(found.summary(),
            "Zero of joint 1 moved by +0.0000 +- 2.0000 mrad\nWeighted for residuals of 0.030 mm a component\n" +
                remark + "\n");
}

// Radii that scatter by e about the arm's: the angle does not follow, so n e^2 are left of 3 n values less one.
TEST(ReregisterOneJoint, WeightsAreThoseOfWhatItLeaves) {
  const auto model = rigid<1>(DhChain<1>({{.a = 0.5, .d = 0.3}}));
  const double e = 1e-3;
  const auto found = reregister(model, around({0.5 + e, 0.5 - e, 0.5 + e, 0.5 - e}),
                                {.base = false, .offsets = true, .offset_prior_std = infinity});
  ASSERT_TRUE(found.determined);
  EXPECT_NEAR(found.motion.offsets(0), 0, 1e-12);
  const double sigma = std::sqrt(4 * e * e / (3 * 4 - 1));
  EXPECT_NEAR(found.position_sigma, sigma, 2e-3 * sigma);
  EXPECT_NEAR(found.change_std(0), found.position_sigma / (0.5 * std::sqrt(4.0)), 2e-3 * found.change_std(0));
}

// A level arm whose second link stands across the first, one pose: 6 values for two zeros with a prior and a probe.
// What is left over lies between one value and two, enough to speak of a contradiction.
TEST(ReregisterTwoJoints, BetweenOneAndTwoValuesLeftMayContradict) {
  const auto model = rigid<2>(DhChain<2>({{.a = 0.3}, {.a = 0.2}}));
  const double position = 0.03e-3, orientation = 0.1e-3, prior = 0.17e-3;
  JointRows<2> joints(1, 2);
  set_configuration(joints, 0, JointVector<2>(0, std::numbers::pi / 2));
  const Vector3 probe(0.012, -0.015, 0.009);
  const Matrix3 across = exp_so3(Vector3(0, 0, std::numbers::pi / 2));
  PointRows positions(1, 3), orientations(1, 3);
  set_point(positions, 0, Vector3(0.3, 0.2, 0));
  set_point(orientations, 0, log_so3(across * exp_so3(probe)));
  const auto found =
      reregister(model, Dataset<2>(joints, positions, orientations),
                 {.base = false, .offsets = true, .offset_prior_std = prior, .contradiction_threshold = 1e-3},
                 {.position_sigma = position, .orientation_sigma = orientation});
  ASSERT_TRUE(found.probe_turned);
  RealMatrix effect(6, 5, {-0.2, -0.2, 0, 0,  0,  // z x (p - axis)
                           0.3,  0,    0, 0,  0,  //
                           0,    0,    0, 0,  0,  //
                           0,    0,    0, -1, 0,  // the probe's axes, a quarter turn about z
                           0,    0,    1, 0,  0,  //
                           1,    1,    0, 0,  1});
  for (Index r = 0; r < 6; ++r)
    for (Index c = 0; c < 5; ++c) effect(r, c) /= r < 3 ? position : orientation;
  RealMatrix information = effect.transpose() * effect;
  for (Index k = 0; k < 5; ++k) information(k, k) += k < 2 ? 1 / (prior * prior) : 1;
  const RealMatrix covariance = information.inverse();
  const double redundancy = 6 - (effect * covariance * effect.transpose()).trace();
  EXPECT_GT(redundancy, 1.1);
  EXPECT_LT(redundancy, 1.9);
  const RealMatrix turned(found.motion.probe);
  EXPECT_LT((turned - probe).norm(), 1e-7);
  const double square = turned.dot(covariance.block(2, 2, 3, 3).inverse() * turned);
  EXPECT_NEAR(found.contradiction, redundancy * std::log1p(square / redundancy), 0.01 * found.contradiction);
}

// Base, zeros and tool stand behind each other, whatever the number of joints: lengths and angles of each.
TEST(RecursiveCalibrationFourJoints, BeginsWithTheGivenDeviations) {
  const auto model = rigid<4>(DhChain<4>({{.a = 0.3}, {.a = 0.2}, {.d = 0.1}, {.d = 0.1}}));
  const double length = 2e-3, angle = 5e-3, zero = 7e-3;
  const std::vector<double> frame{length, length, length, angle, angle, angle};
  for (const bool base : {false, true})
    for (const bool offsets : {false, true})
      for (const bool tool : {false, true}) {
        if (!base && !offsets && !tool) continue;
        std::vector<double> wanted;
        if (base) wanted.insert(wanted.end(), frame.begin(), frame.end());
        if (offsets) wanted.insert(wanted.end(), {zero, zero, zero, zero});
        if (tool) wanted.insert(wanted.end(), frame.begin(), frame.end());
        const RecursiveCalibration<DhChain<4>> online(
            model, {.base = base, .tool = tool, .offsets = offsets, .offset_prior_std = zero}, {}, 0.98,
            {length, angle});
        const MatrixX& covariance = online.covariance();
        const auto n = static_cast<Index>(wanted.size());
        ASSERT_EQ(covariance.rows(), n);
        for (Index r = 0; r < n; ++r)
          for (Index c = 0; c < n; ++c) {
            const double deviation = wanted[static_cast<std::size_t>(r)];
            EXPECT_DOUBLE_EQ(covariance(r, c), r == c ? deviation * deviation : 0) << r << ", " << c;
          }
      }
}

}  // namespace
}  // namespace vernier::few_joints_test
