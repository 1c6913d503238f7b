// SPDX-License-Identifier: BSD-3-Clause
// What a check of a calibration computes, beside dense formulas of generalised least squares; what it says, by hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "limits.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::verification_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

const Robot<6> robot = robots::abb_irb120();

/// Shifted by a millimetre, and turned by one milliradian where it is.
Isometry3 moved_aside(const Isometry3& pose) {
  const Matrix3 turned = exp_so3(Vector3(0, 0, 1e-3)) * rotation(pose);
  return rigid_motion(turned, translation(pose) + Vector3(0, 0, 1e-3));
}

/// Poses of an arm of which the zero of joint 3 is uncertain, and its change with temperature.
struct Check {
  Dataset<6> data;
  ErrorModelEstimate estimate;
  std::vector<Isometry3> poses, as_fitted;
  MatrixX jacobians;
  VectorX gates;
  std::vector<JointType> types = std::vector<JointType>(6, JointType::revolute);
  SensorModel sensors{.position_sigma = 0.05e-3, .orientation_sigma = 0.1e-3};  // positions worse than when calibrated

  /// @param errors 6 x n, measured less modelled: positions [m], then rotation vectors in front [rad]
  /// @param zeros  changes of the joints' zeros [rad]
  explicit Check(const RealMatrix& errors, const JointVector<6>& zeros = JointVector<6>::Zero())
      : estimate{.arm = ArmParameterisation({ArmGeometry(in_frames(robot.chain))},
                                            {{19, -1, 1e-3, 0}, {19, -1, 1e-5, 0, true}})} {
    const Index n = errors.cols();
    const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, n, 5);
    PointRows positions(n, 3), orientations(n, 3);
    VectorX celsius(n);
    jacobians.resize(6, 6 * n);
    gates = VectorX::Ones(n);
    for (Index i = 0; i < n; ++i) {
      const JointVector<6> q = configuration(joints, i);
      const PoseAndJacobian<6> at = robot.chain.pose_and_jacobian(q);
      const Isometry3 actual = robot.chain.pose(q + zeros);
      poses.push_back(at.pose);
      as_fitted.push_back(moved_aside(at.pose));
      std::copy_n(at.jacobian.data(), 36, jacobians.data() + 36 * i);
      set_point(positions, i, translation(actual) + Vector3(errors(0, i), errors(1, i), errors(2, i)));
      const Matrix3 turned = exp_so3(Vector3(errors(3, i), errors(4, i), errors(5, i))) * rotation(actual);
      set_point(orientations, i, log_so3(turned));
      celsius(i) = 15 + 2 * static_cast<double>(i);
    }
    data = Dataset<6>(joints, positions, orientations).at_temperatures(celsius);
    estimate.covariance = RealMatrix::diagonal(RealMatrix(2, 1, {0.04, 0.25}));
    estimate.position_sigma = 0.03e-3;
    estimate.orientation_sigma = 0.12e-3;
    estimate.fallback_error = 0.16e-3;
    estimate.mean_temperature = 20;
  }

  VerificationReport verified(const VerifyOptions& options) const {
    const MeasuredSet station = vernier_test::set_of(data, options.sensors);
    return detail::verified({station, estimate, poses, jacobians, as_fitted, gates, types, {}}, options);
  }

  /// Columns of changes of all poses, 6 n x 1.
  RealMatrix column(int joint, double (*factor)(double) = nullptr) const {
    RealMatrix out(6 * data.size(), 1);
    for (Index i = 0; i < data.size(); ++i)
      for (Index v = 0; v < 6; ++v)
        out(6 * i + v) = jacobians(v, 6 * i + joint) * (factor != nullptr ? factor(data.joints()(i, joint)) : 1);
    return out;
  }

  /// Covariance of all residuals, by hand.
  RealMatrix covariance() const {
    const Index n = data.size();
    const RealMatrix zero = column(2);
    RealMatrix warm = zero;
    for (Index i = 0; i < n; ++i)
      for (Index v = 0; v < 6; ++v) warm(6 * i + v) *= data.temperatures()(i) - 20;
    RealMatrix out = 0.04e-6 * zero * zero.transpose() + 0.25e-10 * warm * warm.transpose();
    for (Index i = 0; i < n; ++i) {
      const double suppressed = (1 - gates(i)) * 0.1e-3;  // of a mean norm of 0.16 mm
      for (Index v = 0; v < 6; ++v)
        out(6 * i + v, 6 * i + v) += v < 3 ? 0.05e-3 * 0.05e-3 + suppressed * suppressed : 0.12e-3 * 0.12e-3;
    }
    return out;
  }

  /// Modelled less measured.
  RealMatrix residual() const {
    RealMatrix out(6 * data.size(), 1);
    for (Index i = 0; i < data.size(); ++i) {
      const Vector6 apart = pose_difference(poses[static_cast<std::size_t>(i)], data.pose(i));
      for (Index v = 0; v < 6; ++v) out(6 * i + v) = apart(v);
    }
    return out;
  }

  /// Effects of base twists.
  RealMatrix base() const {
    RealMatrix out(6 * data.size(), 6);
    for (Index i = 0; i < data.size(); ++i) {
      const Vector3 p = translation(poses[static_cast<std::size_t>(i)]);
      for (Index v = 0; v < 6; ++v) out(6 * i + v, v) = 1;
      for (Index c = 0; c < 3; ++c) {
        const Vector3 moved = Vector3::Unit(c).cross(p);
        for (Index v = 0; v < 3; ++v) out(6 * i + v, 3 + c) = moved(v);
      }
    }
    return out;
  }
};

/// Normal errors of a visit, in some of their deviations.
RealMatrix noise(Index n, std::uint64_t seed, double size = 1) {
  Rng rng(seed);
  RealMatrix out(6, n);
  for (Index i = 0; i < n; ++i)
    for (Index v = 0; v < 6; ++v) out(v, i) = size * (v < 3 ? 0.05e-3 : 0.12e-3) * rng.normal();
  return out;
}

double cosine(double q) { return std::cos(q); }
double sine(double q) { return std::sin(q); }

// Residuals r of covariance C, base columns B: P = C^-1 - C^-1 B (B' C^-1 B)^-1 B' C^-1. Chi-square is r' P r, a change
// z is -z' P r / z' P z with variance 1 / z' P z, and several are tested by r' P Z (Z' P Z)^-1 Z' P r.
TEST(VerificationWhiteBox, IsGeneralisedLeastSquares) {
  for (const bool registered : {true, false}) {
    Check check(noise(8, 3));
    check.gates(2) = 0.5;
    check.types[3] = JointType::prismatic;
    const VerificationReport found = check.verified({.base = registered, .sensors = check.sensors});
    ASSERT_TRUE(found.consistent);
    const RealMatrix inverse = check.covariance().inverse(), b = check.base(), r = check.residual();
    RealMatrix p = inverse;
    if (registered) p -= inverse * b * (b.transpose() * inverse * b).inverse() * b.transpose() * inverse;
    const double chi_square = r.dot(p * r);
    EXPECT_NEAR(found.chi_square, chi_square, 1e-6 * chi_square);
    EXPECT_EQ(found.dof, registered ? 42 : 48);
    ASSERT_EQ(found.joints.size(), 6u);
    for (int j = 0; j < 6; ++j) {
      const JointCheck& joint = found.joints[static_cast<std::size_t>(j)];
      const RealMatrix z = check.column(j);
      const double information = z.dot(p * z), change = -z.dot(p * r) / information;
      const bool determined = information > 0.02 * 0.02 * z.dot(inverse * z);
      EXPECT_EQ(joint.determined, determined) << j;
      EXPECT_EQ(determined, j > 0 || !registered);  // the first axis is that of the base
      if (determined) {
        EXPECT_NEAR(joint.zero_change, change, 1e-9) << j;
        EXPECT_NEAR(joint.zero_std, 1 / std::sqrt(information), 1e-6 / std::sqrt(information)) << j;
        EXPECT_NEAR(joint.zero_p, std::erfc(std::abs(change) * std::sqrt(information / 2)), 1e-6) << j;
      }
      if (j == 3) {
        EXPECT_EQ(joint.once_p, 1);  // a joint that slides has no turn
        continue;
      }
      RealMatrix once(48, 2);
      once.set_block(0, 0, check.column(j, cosine));
      once.set_block(0, 1, check.column(j, sine));
      const RealMatrix along = once.transpose() * p * r, weight = once.transpose() * p * once;
      EXPECT_NEAR(joint.once_p, std::exp(-0.5 * along.dot(weight.inverse() * along)), 1e-6) << j;
    }
    for (Index i = 0; i < 8; ++i) {
      const RealMatrix error = r.block(6 * i, 0, 3, 1), visit = check.covariance().block(6 * i, 6 * i, 3, 3);
      EXPECT_NEAR(found.errors(i), error.norm(), 1e-12);
      EXPECT_NEAR(found.normalised(i), std::sqrt(error.dot(visit.inverse() * error)), 1e-9);
      EXPECT_NEAR(found.rotations(i), r.block(6 * i + 3, 0, 3, 1).norm(), 1e-12);
      const Isometry3& fitted = check.as_fitted[static_cast<std::size_t>(i)];
      EXPECT_NEAR(found.as_fitted(i), (translation(fitted) - check.data.position(i)).norm(), 1e-12);
      const RealMatrix apart = pose_difference(fitted, check.data.pose(i));
      EXPECT_NEAR(found.rotations_as_fitted(i), apart.block(3, 0, 3, 1).norm(), 1e-12);
    }
    EXPECT_NEAR(found.mean_error, RealMatrix(found.errors).mean(), 1e-12);
    EXPECT_GT(found.mean_upper, found.mean_error);
  }
}

// Orientations of a probe that was found to be turned count as if it were not, less the three values that told so.
TEST(VerificationWhiteBox, ATurnedProbeIsTakenOff) {
  Check check(RealMatrix(6, 8));
  const Vector3 probe(0.01, -0.02, 0.03);
  PointRows turned(8, 3);
  for (Index i = 0; i < 8; ++i) {
    const Matrix3 seen = rotation(check.poses[static_cast<std::size_t>(i)]) * exp_so3(probe);
    set_point(turned, i, log_so3(seen));
  }
  check.data =
      Dataset<6>(check.data.joints(), check.data.positions(), turned).at_temperatures(check.data.temperatures());
  const MeasuredSet station = vernier_test::set_of(check.data, check.sensors);
  ReregistrationReport registration;
  registration.motion.probe = probe;
  registration.probe_turned = true;
  const VerifyOptions options{.sensors = check.sensors};
  const auto found = detail::verified(
      {station, check.estimate, check.poses, check.jacobians, check.as_fitted, check.gates, check.types, registration},
      options);
  EXPECT_LT(RealMatrix(found.rotations).largest(), 1e-9);
  EXPECT_LT(found.chi_square, 1e-6);
  EXPECT_EQ(found.dof, 48 - 6 - 3);
}

// Three positions cannot contradict a base and a tool that were registered to them.
TEST(VerificationWhiteBox, NoDegreesOfFreedomAreNoContradiction) {
  const Check check(noise(3, 3));
  const auto positions = check.data.without_orientations().at_temperatures(check.data.temperatures());
  const MeasuredSet station = vernier_test::set_of(positions, check.sensors);
  const VerifyOptions options{.tool = true, .sensors = check.sensors};
  const auto found = detail::verified({station, check.estimate, check.poses, check.jacobians, check.as_fitted,
                                       check.gates, check.types, ReregistrationReport()},
                                      options);
  EXPECT_EQ(found.dof, 0);
  EXPECT_LT(found.chi_square, 1e-6);
  EXPECT_EQ(found.p_value, 1);
  EXPECT_TRUE(found.consistent);
  for (const JointCheck& joint : found.joints) EXPECT_FALSE(joint.determined);
}

// Half of the significance level is spent on the test of everything together.
TEST(VerificationWhiteBox, EverythingTogetherHasHalfOfTheLevel) {
  const Check check(noise(8, 4, 1.25));
  const double p = check.verified({.level = 1e-9, .sensors = check.sensors}).p_value;
  ASSERT_LT(p, 0.4);
  ASSERT_GT(p, 1e-9);
  EXPECT_TRUE(check.verified({.level = 1.98 * p, .sensors = check.sensors}).consistent);
  EXPECT_FALSE(check.verified({.level = 2.02 * p, .sensors = check.sensors}).consistent);
}

// Where the zeros of two joints moved, both are named, and nothing else.
TEST(VerificationWhiteBox, NamesTwoZerosThatMoved) {
  JointVector<6> zeros = JointVector<6>::Zero();
  zeros(1) = 2e-3;
  zeros(4) = -1.5e-3;
  const Check check(noise(20, 5, 0.5), zeros);
  const VerificationReport found = check.verified({.sensors = check.sensors});
  EXPECT_FALSE(found.consistent);
  EXPECT_TRUE(found.aside.empty());
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_EQ(found.joints[j].zero_changed, j == 1 || j == 4) << j << found.summary();
    EXPECT_FALSE(found.joints[j].transmission_changed) << j << found.summary();
  }
}

// At most a tenth of the rows are set aside: those beyond 4.5 standard deviations and six times the median. Neither the
// tests nor the mean count them.
TEST(VerificationWhiteBox, ATenthOfTheRowsMayBeSetAside) {
  for (const Index bumped : {2, 3}) {
    RealMatrix errors = noise(20, 6);
    for (Index k = 0; k < bumped; ++k) errors(2, 3 + 5 * k) += 5e-3;
    const Check check(errors);
    const VerificationReport found = check.verified({.base = false, .sensors = check.sensors});
    if (bumped == 3) {
      EXPECT_TRUE(found.aside.empty());
      EXPECT_FALSE(found.consistent);
      EXPECT_EQ(found.dof, 120);
      continue;
    }
    EXPECT_EQ(found.aside, (std::vector<Index>{3, 8}));
    EXPECT_TRUE(found.consistent);
    EXPECT_EQ(found.dof, 108);
    EXPECT_LT(found.mean_error, 0.3e-3);
    EXPECT_GT(found.errors(8), 4e-3);
  }
  // six times the median: all are off by 3 deviations, one by 9
  RealMatrix errors(6, 20);
  for (Index i = 0; i < 20; ++i) errors(static_cast<Index>(i % 3), i) = (i % 2 == 0 ? 1 : -1) * 0.15e-3;
  errors(0, 7) = 0.45e-3;
  const Check check(errors);
  const VerificationReport found = check.verified({.base = false, .sensors = check.sensors});
  EXPECT_FALSE(found.consistent);
  EXPECT_TRUE(found.aside.empty());
}

TEST(VerificationReport, VerdictByHand) {
  VerificationReport report;
  report.valid = report.consistent = true;
  report.chi_square = 51.25;
  report.dof = 54;
  report.p_value = 0.25;
  report.poses = 10;
  EXPECT_EQ(report.verdict(),
            "The calibration is still valid: errors are as predicted (chi-square 51.2 of 54 degrees of freedom, p = "
            "0.25).");
  report.options.accept = 0.5e-3;
  report.mean_error = 0.25e-3;
  report.mean_upper = 0.375e-3;
  report.aside = {4};
  EXPECT_EQ(report.verdict(),
            "The calibration is still valid: mean error 0.25 mm, at most 0.375 mm, accepted up to 0.5 mm; errors are "
            "as predicted (chi-square 51.2 of 54 degrees of freedom, p = 0.25), row 4 set aside.");
  report.consistent = report.valid = false;
  report.p_value = 0.5e-4;
  report.aside = {4, 7};
  EXPECT_EQ(report.verdict(),
            "The calibration is no longer valid: mean error 0.25 mm, at most 0.375 mm, accepted up to 0.5 mm; errors "
            "are larger than predicted, of no single joint (chi-square 51.2 of 54 degrees of freedom, p = below "
            "0.0001), rows 4 and 7 set aside.");
  report.consistent = true;
  report.p_value = 1;
  report.aside.clear();
  EXPECT_EQ(report.verdict(),
            "The calibration does not reach the accepted error: mean error 0.25 mm, at most 0.375 mm, accepted up to "
            "0.5 mm; errors are as predicted (chi-square 51.2 of 54 degrees of freedom, p = 1).");
  report.consistent = false;
  report.options.accept.reset();
  report.p_value = 2e-4;
  report.joint_types = {JointType::revolute, JointType::prismatic};
  report.joints = {{.determined = true}, {.determined = true, .zero_change = 0.5e-3, .zero_std = 0.1e-3}};
  report.joints[1].zero_changed = true;
  EXPECT_EQ(report.verdict(),
            "The calibration is no longer valid: the zero of joint 2 moved by 0.5 +- 0.196 mm (chi-square 51.2 of 54 "
            "degrees of freedom, p = 0.0002).");
}

TEST(VerifyOptions, NamesWhatIsUnusable) {
  const auto validate = [](const VerifyOptions& options) { options.validate(); };
  EXPECT_EQ(VerifyOptions{}.level, 0.05);
  vernier_test::expect_limits(validate, VerifyOptions{}, &VerifyOptions::level,
                              {vernier_test::above(0), vernier_test::below(1)}, {0.0, 1.0});
  EXPECT_THROW(VerifyOptions{.accept = 0.0}.validate(), std::invalid_argument);
  EXPECT_THROW(VerifyOptions{.expected_error = -1e-3}.validate(), std::invalid_argument);
  VerifyOptions sensors;
  sensors.sensors.position_sigma = -1;
  EXPECT_THROW(sensors.validate(), std::invalid_argument);
  EXPECT_NO_THROW(VerifyOptions{}.validate());
}

}  // namespace
}  // namespace vernier::verification_test
