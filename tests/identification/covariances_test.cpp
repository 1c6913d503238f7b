// SPDX-License-Identifier: BSD-3-Clause
// Poses with a covariance of their own: the weighted sum of squares, an identification, and what is kept of them.

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/identification/in_one_frame.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;

namespace covariances_test {
namespace {

/// Poses of an arm with correlated noise that is small in some directions, and its covariances.
struct Measured {
  explicit Measured(std::uint64_t seed) : actual(vn::with_geometric_errors(vn::robots::ur10().chain, {}, seed)) {
    limits = vn::robots::ur10().limits;
    for (int j = 0; j < 6; ++j) {
      limits.lower(j) = -3;
      limits.upper(j) = 3;
    }
    vn::Rng rng(seed + 50);
    const vn::JointRows<6> joints = vn::sample_joints(limits, 60, seed);
    vn::PointRows positions(60, 3), orientations(60, 3);
    for (vn::Index i = 0; i < 60; ++i) {
      const vn::Isometry3 pose = actual.pose(vn::JointVector<6>(joints.row(i).transpose()));
      const vn::Matrix3 turn = vn::exp_so3(vn::Vector3(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)));
      vn::Matrix6 factor = vn::Matrix6::Zero();
      for (vn::Index r = 0; r < 3; ++r)
        for (vn::Index c = 0; c < 3; ++c) {
          factor(r, c) = turn(r, c) * (c == 2 ? 1e-3 : 1e-4);
          factor(3 + r, 3 + c) = turn(r, c) * (c == 2 ? 1e-4 : 1e-3);
          factor(3 + r, c) = 0.5 * factor(r, c);
        }
      vn::Vector6 noise;
      for (double& value : noise) value = rng.normal_pair()[0];
      const vn::Vector6 error = factor * noise;
      covariances.push_back(factor * factor.transpose());
      for (vn::Index k = 0; k < 3; ++k) positions(i, k) = pose(k, 3) + error(k);
      const vn::Matrix3 seen = vn::exp_so3(vn::Vector3(error(3), error(4), error(5))) * pose.linear();
      vn::set_point(orientations, i, vn::log_so3(seen));
    }
    poses = vn::Dataset<6>(joints, positions, orientations);
  }
  vn::DhChain<6> actual;
  vn::JointLimits<6> limits;
  vn::Dataset<6> poses;
  std::vector<vn::Matrix6> covariances;
};

TEST(Covariances, WeightTheSumOfSquares) {
  const Measured measured(1);
  const vn::Measurements<6> sets(measured.poses.with_covariances(measured.covariances));
  const vn::ArmGeometry arm{vn::Framed(vn::robots::ur10().chain)};
  for (const double joint_sigma : {0.0, 1e-4}) {
    const vn::detail::CalibrationProblem problem(vn::ArmParameterisation({arm}, {}), sets.sets(), vn::Loss::squared,
                                                 joint_sigma);
    const vn::VectorX rows = problem.stacked(false).residuals;
    const std::vector<vn::Isometry3> modelled = arm.poses(measured.poses.joints());
    for (vn::Index i = 0; i < 60; ++i) {
      vn::Vector6 residual;
      residual.head<3>() = modelled[static_cast<std::size_t>(i)].translation() - measured.poses.position(i);
      residual.tail<3>() =
          vn::rotation_difference(modelled[static_cast<std::size_t>(i)].linear(), measured.poses.orientation(i));
      vn::Matrix6 covariance = measured.covariances[static_cast<std::size_t>(i)];
      const vn::Jacobian<6> by_joints =
          vn::robots::ur10().chain.jacobian(vn::JointVector<6>(measured.poses.joints().row(i).transpose()));
      vn::Matrix6 jacobian = by_joints;  // of the rotation's residual by the motion: near the identity
      const vn::Matrix3 rate = vn::left_jacobian_inverse_so3(residual.tail<3>());
      jacobian.bottomRows<3>() = rate * by_joints.bottomRows<3>();
      covariance += joint_sigma * joint_sigma * jacobian * jacobian.transpose();
      const double expected = residual.dot(covariance.ldlt().solve(residual));
      EXPECT_NEAR(rows.segment<6>(6 * i).squaredNorm(), expected, 1e-9 * expected) << i << ", " << joint_sigma;
    }
  }
}

TEST(Covariances, OfTheSensorChangeNothing) {
  const Measured measured(2);
  vn::Matrix6 usual = vn::Matrix6::Identity();
  for (vn::Index k = 0; k < 6; ++k) usual(k, k) = k < 3 ? 0.03e-3 * 0.03e-3 : 0.1e-3 * 0.1e-3;
  const vn::IdentifyOptions options{.frames = vn::Frames::base_and_tool};
  const auto identified = [&](const vn::Dataset<6>& poses) {
    return vn::VectorX(
        vn::identify(vn::robots::ur10().chain, poses, options, {.loss = vn::Loss::squared}, vn::own_solver)
            .model.identified()
            .parameters());
  };
  const vn::VectorX without = identified(measured.poses);
  EXPECT_LT((identified(measured.poses.with_covariances(std::vector<vn::Matrix6>(60, usual))) - without).norm(), 1e-9);
}

TEST(Covariances, MakeAnIdentificationMoreAccurate) {
  double without = 0, with = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Measured measured(seed);
    const auto test = vn::measure(measured.actual, vn::sample_joints(measured.limits, 300, 99));
    const auto error = [&](const vn::Dataset<6>& poses) {
      const auto found = vn::identify(vn::robots::ur10().chain, poses, {.frames = vn::Frames::base_and_tool},
                                      {.loss = vn::Loss::squared}, vn::own_solver);
      return vn::prediction_error(found.model, test).mean;
    };
    without += error(measured.poses) / 4;
    with += error(measured.poses.with_covariances(measured.covariances)) / 4;
  }
  EXPECT_LT(with, 0.3 * without);
}

// Links as designed leave residuals of many standard deviations, position and orientation going together. A robust loss
// of whole rows has a minimum, and the iteration comes to its end there.
TEST(Covariances, ARobustLossWeighsRowsAsWholes) {
  const Measured measured(5);
  const auto sets = vn::Measurements<6>(measured.poses.with_covariances(measured.covariances)).sets();
  const vn::ArmGeometry designed{vn::Framed(vn::robots::ur10().chain)};
  std::vector<vn::GeometricUnknown> frames;
  for (vn::Index k = 0; k < 6; ++k) frames.push_back({k, -1, 1e-3, 0});
  for (vn::Index k = 0; k < 6; ++k) frames.push_back({vn::ArmParameters::chain_end(6) + k, -1, 1e-3, 0});
  vn::detail::CalibrationProblem problem(vn::ArmParameterisation({designed}, frames), sets, vn::Loss::huber);
  EXPECT_TRUE(problem.solve(200));
  const double limit = problem.thresholds()[0] * std::sqrt(2.0);
  ASSERT_GT(limit, 10);  // times the standard deviations
  const auto loss = [&](const vn::ArmGeometry& arm) {
    const std::vector<vn::Isometry3> modelled = arm.poses(measured.poses.joints());
    double sum = 0;
    for (vn::Index i = 0; i < 60; ++i) {
      const auto row = static_cast<std::size_t>(i);
      vn::Vector6 residual;
      residual.head<3>() = modelled[row].translation() - measured.poses.position(i);
      residual.tail<3>() = vn::rotation_difference(modelled[row].linear(), measured.poses.orientation(i));
      const double norm = std::sqrt(residual.dot(measured.covariances[row].ldlt().solve(residual)));
      sum += norm <= limit ? norm * norm : 2 * limit * norm - limit * limit;
    }
    return sum;
  };
  const vn::ArmGeometry found = problem.arm.geometry(0);
  for (const vn::GeometricUnknown& unknown : frames) {
    constexpr double step = 1e-5;
    const auto moved = [&](double by) {
      vn::VectorX values = found.parameters();
      values(unknown.parameter) += by;
      return loss(found.with_parameters(values));
    };
    const double slope = (moved(step) - moved(-step)) / (2 * step),
                 curvature = (moved(step) + moved(-step) - 2 * loss(found)) / (step * step);
    EXPECT_GT(curvature, 0) << unknown.parameter;
    EXPECT_LT(std::abs(slope / curvature), 3e-6) << unknown.parameter;  // to the lowest point [m, rad]
  }
}

TEST(Covariances, AreKeptByRowsAndTurnedIntoOneFrame) {
  const Measured measured(3);
  const vn::Dataset<6> poses = measured.poses.with_covariances(measured.covariances);
  const std::vector<vn::Index> some{7, 3};
  EXPECT_EQ(poses.rows(some).covariances().at(1), measured.covariances[3]);
  const vn::Isometry3 turned = vn::rigid_motion(vn::exp_so3(vn::Vector3(0.3, -0.5, 0.2)), {1, 2, 3});
  const auto joined =
      vn::in_one_frame<6>(std::vector<vn::Dataset<6>>{poses, poses}, {vn::Isometry3::Identity(), turned});
  vn::Matrix6 motion = vn::Matrix6::Zero();  // a direction of the second station in the first
  motion.topLeftCorner<3, 3>() = motion.bottomRightCorner<3, 3>() = turned.linear().transpose();
  const vn::Matrix6 expected = motion * measured.covariances[3] * motion.transpose();
  EXPECT_LT((joined.covariances().at(63) - expected).cwiseAbs().maxCoeff(), 1e-18);
}

TEST(Covariances, ThatAreNoneAreRefused) {
  const Measured measured(4);
  std::vector<vn::Matrix6> wrong = measured.covariances;
  wrong[5](0, 0) = -1e-9;
  EXPECT_NE(vernier_test::complaint([&] {
              (void)measured.poses.with_covariances(wrong);
            }).find("the covariance of row 5 is not positive definite"),
            std::string::npos);
  wrong.resize(3);
  EXPECT_NE(vernier_test::complaint([&] { (void)measured.poses.with_covariances(wrong); }).find("3 covariances of 60"),
            std::string::npos);
}

}  // namespace
}  // namespace covariances_test
