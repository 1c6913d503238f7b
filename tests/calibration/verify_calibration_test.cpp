// SPDX-License-Identifier: BSD-3-Clause
// The yearly check, on simulated arms that have changed in known ways or not at all.

#include "vernier/calibration/verify_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/chi_square.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::verify_test {
namespace {

using vernier_test::complaint;
using Chain = DhChain<6>;
using Arm = Framed<WithJointErrors<Chain>>;

constexpr MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.1e-3};
const Robot<6> robot = robots::abb_irb120();

JointRows<6> poses_of(Index n, std::uint64_t seed) {
  return abb_irb120_operating_region().sample(robot.chain, n, seed);
}

Arm actual() {
  return Arm({with_geometric_errors(robot.chain, {.length_min = 0.2e-3, .angle_min = 0.3e-3, .angle_max = 1e-3}, 4),
              draw_joint_errors(robot.chain, {.gear_ratio = 0, .coupling = 0}, 5)},
             FrameParameters(Vector6{2, -1, 0.5, 0.1, -0.2, 1.5}),
             FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}));
}

/// An arm whose joint zeros have moved, elsewhere perhaps.
Arm changed(const JointVector<6>& zeros, const Isometry3& base = Isometry3::Identity()) {
  const Arm arm = actual();
  auto p = arm.chain().parameters();
  for (int i = 0; i < 6; ++i) p(5 * i + 3) += zeros(i);
  return Arm(WithJointErrors<Chain>(arm.chain().with_parameters(p), arm.model().joint_errors()),
             Isometry3(base * arm.base()), arm.tool());
}

const Calibration<Chain>& calibration() {
  static const auto made = calibrate(robot.chain, measure(actual(), poses_of(250, 1), noise, 2),
                                     {.errors = {.harmonics = 4}, .remainder = {.on_error_model = false}});
  return made;
}

VerificationReport check(const Arm& arm, Index n, std::uint64_t seed, const VerifyOptions& options = {},
                         bool oriented = true) {
  MeasurementNoise of_check = noise;
  of_check.with_orientations = oriented;
  const auto data = measure(arm, poses_of(n, 1000 + seed), of_check, 2000 + seed);
  return verify_calibration(calibration().model(), calibration().errors, data, options);
}

const Isometry3 elsewhere = FrameParameters(Vector6{0.4, 1.3, -0.2, 0.3, -0.1, 2}).isometry();

TEST(VerifyCalibration, AnUnchangedArmIsValid) {
  int valid = 0, registered = 0, elsewhere_valid = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    valid += check(actual(), 20, seed).valid;
    registered += check(actual(), 20, seed, {.base = false}).valid;
    elsewhere_valid += check(changed(JointVector<6>::Zero(), elsewhere), 12, seed, {}, seed % 2 == 0).valid;
  }
  EXPECT_GE(valid, 95);
  EXPECT_GE(registered, 95);
  EXPECT_GE(elsewhere_valid, 95);
}

// Rows that a camera measured: far worse along one direction, in which shift and rotation go together.
TEST(VerifyCalibration, RowsWithCovariancesOfTheirOwnCountAsTheyAre) {
  int valid = 0, as_equal_rows = 0, positions_valid = 0;
  double share = 0, of_plain = 0;
  constexpr int checks = 60;
  for (std::uint64_t seed = 0; seed < checks; ++seed) {
    const auto exact = measure(actual(), poses_of(15, 3000 + seed), noise, 4000 + seed);
    Rng rng(seed);
    PointRows positions = exact.positions(), orientations = exact.orientations();
    std::vector<Matrix6> covariances;
    for (Index i = 0; i < exact.size(); ++i) {
      const Vector3 along = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
      const Vector3 about = along.unitOrthogonal();
      Vector6 direction;
      direction << 0.5e-3 * along, 1e-3 * about;
      const double off = rng.normal();
      const Isometry3 pose = rigid_motion(exp_so3(Vector3(off * direction.tail<3>())) * exact.orientation(i),
                                          exact.position(i) + off * direction.head<3>());
      set_point(positions, i, translation(pose));
      set_point(orientations, i, log_so3(rotation(pose)));
      Matrix6 covariance = direction * direction.transpose();
      for (Index k = 0; k < 6; ++k) covariance(k, k) += std::pow(k < 3 ? noise.position : noise.orientation, 2);
      covariances.push_back(covariance);
    }
    const Dataset<6> rows = Dataset<6>(exact.joints(), positions, orientations).approached_from(exact.previous());
    const auto verified = [&](const Dataset<6>& data) {
      return verify_calibration(calibration().model(), calibration().errors, data, {});
    };
    const VerificationReport own = verified(rows.with_covariances(covariances));
    valid += own.valid;
    share += own.chi_square / static_cast<double>(own.dof) / checks;
    const VerificationReport without = verified(exact);
    ASSERT_EQ(own.dof, 84);  // less the base
    of_plain += without.chi_square / static_cast<double>(without.dof) / checks;
    as_equal_rows += verified(rows).valid;
    positions_valid +=
        verified(Dataset<6>(exact.joints(), positions).approached_from(exact.previous()).with_covariances(covariances))
            .valid;
  }
  EXPECT_GE(valid, 54);
  EXPECT_GE(positions_valid, 54);
  // One direction of each of the 15 rows scatters as stated: its part of the chi-square is one a degree of freedom. The
  // others have the part that they have without that noise. The difference has a standard deviation of
  // sqrt(2 x 15 / 60) / 84 of either, 0.012 of both.
  EXPECT_NEAR(share, (15 + 69 * of_plain) / 84, 0.036);
  EXPECT_LE(as_equal_rows, 6);  // a third of a millimetre that no joint explains
}

TEST(VerifyCalibration, NamesTheJointWhoseZeroMoved) {
  for (int joint = 1; joint < 6; ++joint) {
    int named = 0;
    double sum = 0, squares = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const VerificationReport report = check(changed(0.3e-3 * JointVector<6>::Unit(joint), elsewhere), 25, seed);
      EXPECT_FALSE(report.valid) << joint << ' ' << seed;
      int others = 0;
      for (int j = 0; j < 6; ++j) {
        const JointCheck& one = report.joints[static_cast<std::size_t>(j)];
        others += j != joint && (one.zero_changed || one.transmission_changed);
      }
      const JointCheck& of = report.joints[static_cast<std::size_t>(joint)];
      named += of.zero_changed && others == 0;
      sum += of.zero_change / 10;
      squares += std::pow((of.zero_change - 0.3e-3) / of.zero_std, 2) / 10;
      EXPECT_NE(report.verdict().find(message("the zero of joint ", joint + 1, " moved by")), std::string::npos)
          << report.verdict();
    }
    EXPECT_GE(named, 9) << joint + 1;
    EXPECT_NEAR(sum, 0.3e-3, 0.08e-3) << joint + 1;
    EXPECT_LT(squares, 3.5) << joint + 1;  // a mean of ten squares, that share the calibration's own error
  }
}

// The zero of the last joint and a probe that was turned on its flange look alike.
TEST(VerifyCalibration, ARemountedToolTakesTheZeroOfTheLastJoint) {
  const VerificationReport free = check(changed(0.3e-3 * JointVector<6>::Unit(5)), 25, 3, {.tool = true});
  EXPECT_TRUE(free.valid) << free.verdict();
  EXPECT_FALSE(free.joints[5].determined);
}

TEST(VerifyCalibration, AFreedBaseTakesTheZeroOfTheFirstJoint) {
  const Arm arm = changed(0.3e-3 * JointVector<6>::Unit(0));
  const VerificationReport free = check(arm, 25, 3);
  EXPECT_TRUE(free.valid) << free.verdict();
  EXPECT_FALSE(free.joints[0].determined);
  ASSERT_TRUE(free.registration);
  const VerificationReport held = check(arm, 25, 3, {.base = false});
  EXPECT_FALSE(held.valid);
  EXPECT_TRUE(held.joints[0].zero_changed) << held.summary();
  EXPECT_FALSE(held.registration);
}

TEST(VerifyCalibration, ABaseThatMovedIsNoticedOnlyWhereItIsHeld) {
  const Arm arm = changed(JointVector<6>::Zero(), FrameParameters(Vector6{1e-3, 0, 0, 0, 0, 0}).isometry());
  EXPECT_TRUE(check(arm, 20, 4).valid);
  const VerificationReport held = check(arm, 20, 4, {.base = false});
  EXPECT_FALSE(held.valid);
  EXPECT_NEAR(held.errors.mean(), 1e-3, 0.1e-3);
  EXPECT_EQ(held.errors, held.as_fitted);
}

TEST(VerifyCalibration, NamesATransmissionThatChanged) {
  int named = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Arm arm = changed(JointVector<6>::Zero(), elsewhere);
    const JointRows<6> joints = poses_of(40, 500 + seed);
    JointRows<6> reached = joints;
    reached.col(2).array() += 0.4e-3 * (joints.col(2).array() + 0.7).cos();
    const auto seen = measure(arm, reached, noise, 600 + seed);
    const VerificationReport report = verify_calibration(calibration().model(), calibration().errors,
                                                         Dataset<6>(joints, seen.positions(), seen.orientations()));
    EXPECT_FALSE(report.valid);
    named += report.joints[2].transmission_changed || report.joints[2].zero_changed;
  }
  EXPECT_GE(named, 9);
}

TEST(VerifyCalibration, SetsARowAsideThatContradictsAllOthers) {
  auto data = measure(actual(), poses_of(30, 77), noise, 78);
  PointRows positions = data.positions();
  positions(11, 2) += 4e-3;
  const auto bumped = Dataset<6>(data.joints(), positions, data.orientations());
  const VerificationReport report = verify_calibration(calibration().model(), calibration().errors, bumped);
  EXPECT_EQ(report.aside, std::vector<Index>{11});
  EXPECT_TRUE(report.valid) << report.verdict();
  EXPECT_NE(report.verdict().find("row 11 set aside"), std::string::npos) << report.verdict();
}

// Half of the level is for all changes together, shared out among them: the zeros that are determined, and six
// transmissions.
TEST(VerifyCalibration, AChangeIsNamedWhereItsShareOfTheLevelAllowsIt) {
  const Arm arm = changed(0.1e-3 * JointVector<6>::Unit(2), elsewhere);
  const VerificationReport report = check(arm, 25, 3);
  double least = 1, tests = 6;
  for (const JointCheck& joint : report.joints) {
    least = std::min({least, joint.zero_p, joint.once_p});
    tests += joint.determined ? 1 : 0;
  }
  const double level = 2 * tests * least;
  ASSERT_GT(level, 1e-12);
  ASSERT_LT(level, 0.9);
  const auto named = [&](double at_level) {
    int out = 0;
    for (const JointCheck& joint : check(arm, 25, 3, {.level = at_level}).joints)
      out += joint.zero_changed || joint.transmission_changed ? 1 : 0;
    return out;
  };
  EXPECT_EQ(named(0.99 * level), 0);
  EXPECT_GT(named(1.01 * level), 0);
}

TEST(VerifyCalibration, WithALimitTheErrorDecides) {
  const Arm arm = changed(0.3e-3 * JointVector<6>::Unit(1), elsewhere);
  const VerificationReport loose = check(arm, 25, 1, {.accept = 0.5e-3}),
                           tight = check(arm, 25, 1, {.accept = 0.05e-3});
  EXPECT_TRUE(loose.valid);
  EXPECT_FALSE(loose.consistent);
  EXPECT_FALSE(tight.valid);
  // the upper end of its interval does, not the mean itself
  EXPECT_FALSE(check(arm, 25, 1, {.accept = 0.5 * (loose.mean_error + loose.mean_upper)}).valid);
  EXPECT_TRUE(check(arm, 25, 1, {.accept = 1.001 * loose.mean_upper}).valid);
  EXPECT_NE(loose.verdict().find("accepted up to 0.5 mm"), std::string::npos) << loose.verdict();
}

/// The data as a probe sees them that is turned on its tool.
Dataset<6> seen_by_turned(const Dataset<6>& data, const Vector3& probe) {
  PointRows orientations(data.size(), 3);
  for (Index i = 0; i < data.size(); ++i) {
    const Matrix3 turned = data.orientation(i) * exp_so3(probe);
    set_point(orientations, i, log_so3(turned));
  }
  return Dataset<6>(data.joints(), data.positions(), orientations);
}

// A probe that was mounted another way round, or by a few milliradians, is no change of the arm.
TEST(VerifyCalibration, ATurnedProbeIsTakenOff) {
  for (const Vector3& probe : {Vector3(0, 0, 3.1), Vector3(0.4, -1.1, 2), Vector3(0, 0, 0.05), Vector3(1.5e-3, 0, 2e-3),
                               Vector3(0, -2e-3, 1e-3)}) {
    int valid = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto seen =
          measure(changed(JointVector<6>::Zero(), elsewhere), poses_of(25, 300 + seed), noise, 400 + seed);
      const VerificationReport report =
          verify_calibration(calibration().model(), calibration().errors, seen_by_turned(seen, probe));
      ASSERT_TRUE(report.registration);
      EXPECT_TRUE(report.registration->probe_turned) << probe.transpose();
      EXPECT_LT((report.registration->motion.probe - probe).norm(), 0.3e-3) << probe.transpose();
      EXPECT_FALSE(report.joints[5].zero_changed) << report.summary();
      EXPECT_EQ(report.dof, 6 * 25 - 6 - 3);
      valid += report.valid;
    }
    EXPECT_GE(valid, 9) << probe.transpose();
  }
}

// The same where nothing is registered: sensor and arm stand as they did.
TEST(VerifyCalibration, ATurnedProbeIsTakenOffWhereNothingIsRegistered) {
  const auto checked = [](const Vector3& probe, std::uint64_t seed) {
    const auto seen =
        measure(changed(JointVector<6>::Zero(), Isometry3::Identity()), poses_of(25, 300 + seed), noise, 400 + seed);
    return verify_calibration(calibration().model(), calibration().errors, seen_by_turned(seen, probe),
                              {.base = false});
  };
  for (const Vector3& probe : {Vector3(0, 0, 3.1), Vector3(0, 0, 0.05), Vector3(1.5e-3, 0, 2e-3)}) {
    int valid = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const VerificationReport report = checked(probe, seed);
      ASSERT_TRUE(report.registration);
      EXPECT_LT((report.registration->motion.probe - probe).norm(), 0.3e-3) << probe.transpose();
      EXPECT_EQ(report.dof, 6 * 25 - 3);
      valid += report.valid;
    }
    EXPECT_GE(valid, 9) << probe.transpose();
  }
  EXPECT_FALSE(checked(Vector3::Zero(), 0).registration);  // a probe that stands as it did
}

// The zero of another joint is found behind a turned probe.
TEST(VerifyCalibration, AZeroIsFoundBesideATurnedProbe) {
  const auto seen = measure(changed(0.4e-3 * JointVector<6>::Unit(2), elsewhere), poses_of(30, 310), noise, 410);
  const VerificationReport report =
      verify_calibration(calibration().model(), calibration().errors, seen_by_turned(seen, Vector3(0, 0, 3.1)));
  EXPECT_FALSE(report.valid);
  EXPECT_TRUE(report.joints[2].zero_changed) << report.summary();
  EXPECT_NEAR(report.joints[2].zero_change, 0.4e-3, 0.15e-3);
}

// A calibration that states three times the errors that it has: a change is significant by itself, but all errors
// together are smaller than predicted.
TEST(VerifyCalibration, NoChangeIsNamedWhereErrorsAreSmallerThanPredicted) {
  ErrorModelEstimate modest = calibration().errors;
  modest.position_sigma *= 3;
  modest.orientation_sigma *= 3;
  modest.joint_sigma *= 3;
  const auto data = measure(changed(0.3e-3 * JointVector<6>::Unit(2), elsewhere), poses_of(25, 320), noise, 420);
  const VerificationReport report = verify_calibration(calibration().model(), modest, data);
  EXPECT_LT(report.joints[2].zero_p, 1e-3) << report.summary();
  EXPECT_GT(report.p_value, 0.9);
  EXPECT_TRUE(report.valid) << report.summary();
  EXPECT_FALSE(report.joints[2].zero_changed);
  EXPECT_NE(report.verdict().find("still valid: errors are as predicted"), std::string::npos) << report.verdict();
}

// A residual ten times as large as the calibration's own error at held-out poses.
TEST(VerifyCalibration, RemarksOnAResidualTenTimesTheHeldOutError) {
  const auto advice_of = [&](double factor) {
    VerifyOptions options;
    const double left = check(actual(), 20, 3, options).mean_error;
    options.expected_error = left / factor;
    int said = 0;
    for (const std::string& sentence : check(actual(), 20, 3, options).advice())
      said += sentence.find("times the error of the calibration at held-out poses") != std::string::npos ? 1 : 0;
    return said;
  };
  EXPECT_EQ(advice_of(10.1), 1);
  EXPECT_EQ(advice_of(9.9), 0);
}

/// Rows of two data sets, one behind the other.
Dataset<6> joined(const Dataset<6>& first, const Dataset<6>& second) {
  const auto stacked = [](const auto& above, const auto& below) {
    auto out = above;
    out.conservativeResize(above.rows() + below.rows(), above.cols());
    out.bottomRows(below.rows()) = below;
    return out;
  };
  return Dataset<6>(stacked(first.joints(), second.joints()), stacked(first.positions(), second.positions()),
                    stacked(first.orientations(), second.orientations()))
      .approached_from(stacked(first.previous(), second.previous()));
}

// Poses of the fit among fresh ones are left out, wherever they stand.
TEST(VerifyCalibration, LeavesPosesOfTheFitOut) {
  const auto of_fit = measure(actual(), poses_of(250, 1), noise, 2),
             fresh = measure(actual(), poses_of(20, 1003), noise, 2003);
  VerifyOptions options;
  options.fitted_rows = calibration().fitted_rows;
  const auto checked = [&](const Dataset<6>& data) {
    return verify_calibration(calibration().model(), calibration().errors, data, options);
  };
  const Dataset<6> mixed =
      joined(joined(of_fit.rows(std::vector<Index>{7, 3}), fresh), of_fit.rows(std::vector<Index>{100, 9, 200}));
  const VerificationReport report = checked(mixed), plain = checked(fresh);
  EXPECT_EQ(report.known, 5);
  EXPECT_EQ(report.poses, 20);
  EXPECT_EQ(report.chi_square, plain.chi_square);
  EXPECT_NE(report.verdict().find(" 5 poses that it was fitted to are left out."), std::string::npos);
  EXPECT_EQ(plain.known, 0);
  EXPECT_EQ(plain.verdict().find("fitted to"), std::string::npos);
  // what was learned is of the rows that are left
  PointRows learned = PointRows::Zero(25, 3);
  learned.row(2) << 1e-3, 0, 0;
  const VerificationReport shifted =
      verify_calibration(calibration().model(), calibration().errors, mixed, options, learned);
  EXPECT_GT(shifted.errors(0), 0.7e-3);
  // two others decide nothing
  const VerificationReport two =
      checked(joined(of_fit.rows(std::vector<Index>{7, 3, 20}), fresh.rows(std::vector<Index>{0, 1})));
  EXPECT_EQ(two.poses, 5);
  EXPECT_NE(two.verdict().find("it was fitted to, so that this confirms nothing."), std::string::npos);
  EXPECT_EQ(checked(of_fit).poses, 250);
}

// The poses of the fit tell nothing; that is said where it is known, and asked where residuals are too small.
TEST(VerifyCalibration, SaysThatPosesOfTheFitConfirmNothing) {
  const auto data = measure(actual(), poses_of(250, 1), noise, 2);
  VerifyOptions options;
  options.fitted_poses = true;
  const VerificationReport known = verify_calibration(calibration().model(), calibration().errors, data, options);
  EXPECT_NE(known.verdict().find("it was fitted to, so that this confirms nothing."), std::string::npos);
  EXPECT_EQ(known.advice().front().rfind("Check with fresh poses: ", 0), 0u);
  const VerificationReport unknown = verify_calibration(calibration().model(), calibration().errors, data);
  EXPECT_LT(unknown.closeness, 1e-6);
  EXPECT_EQ(unknown.advice().front().rfind("The joints agree with the calibration more closely than fresh poses", 0),
            0u)
      << unknown.summary();
  // fresh poses do so at random, also where the calibration states three times the errors that it has
  ErrorModelEstimate modest = calibration().errors;
  modest.position_sigma *= 3;
  modest.orientation_sigma *= 3;
  modest.joint_sigma *= 3;
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto fresh = measure(actual(), poses_of(25, 500 + seed), noise, 600 + seed);
    const VerificationReport report = verify_calibration(
        calibration().model(), seed % 2 == 0 ? modest : ErrorModelEstimate(calibration().errors), fresh);
    EXPECT_GT(report.closeness, 1e-4);
    sum += report.closeness / 20;
  }
  EXPECT_GT(sum, 0.25);
}

TEST(VerifyCalibration, SaysThatPosesAreOutsideTheMeasuredRanges) {
  JointRows<6> joints = poses_of(20, 9);
  for (const Index row : {3, 8}) joints(row, 3) += 2.5;
  const auto data = measure(actual(), joints, noise, 10);
  const VerificationReport report = verify_calibration(calibration().model(), calibration().errors, data);
  EXPECT_EQ(report.registration->outside, (std::vector<Index>{3, 8}));
  EXPECT_NE(report.registration->summary().find("2 of 20 poses (rows 3 and 8) lie outside the measured joint ranges"),
            std::string::npos)
      << report.registration->summary();
}

// What is reported equals its definition: errors of the registered model.
TEST(VerifyCalibration, ErrorsAreThoseOfTheRegisteredModel) {
  const auto data = measure(changed(JointVector<6>::Zero(), elsewhere), poses_of(15, 9), noise, 10);
  const VerificationReport report = verify_calibration(calibration().model(), calibration().errors, data);
  const auto registered = reregister(calibration().model(), data);
  EXPECT_EQ(report.errors.size(), 15);
  EXPECT_TRUE(report.errors.isApprox(position_errors(registered.model, data), 1e-12));
  EXPECT_TRUE(report.as_fitted.isApprox(position_errors(calibration().model(), data), 1e-12));
  EXPECT_EQ(report.dof, 6 * 15 - 6);
  const VerificationReport positions =
      verify_calibration(calibration().model(), calibration().errors, data.without_orientations());
  EXPECT_EQ(positions.dof, 3 * 15 - 6);
  EXPECT_EQ(positions.rotations.size(), 0);
  EXPECT_EQ(VectorX(verify_calibration(calibration().model(), calibration().errors, data).errors), report.errors);
}

// What to do follows from what has changed: zeros alone are estimated again, a transmission needs all of it.
TEST(VerificationReport, AdviceByHand) {
  const auto advice = [](std::vector<JointCheck> joints) {
    VerificationReport report;
    for (JointCheck& joint : joints) joint.determined = true;
    report.joints = std::move(joints);
    report.registration.emplace();
    report.options.tool = true;
    const std::vector<std::string> said = report.advice();
    EXPECT_EQ(said.size(), 1u);
    return said.front();
  };
  const JointCheck zero{.zero_changed = true}, transmission{.transmission_changed = true}, kept;
  const std::string zeros =
                        "Estimate the zeros of the joints again: calibrate --model MODEL --free base,offsets; then "
                        "check again.",
                    all = "Calibrate again, with the earlier model as the prior: calibrate --prior MODEL.";
  EXPECT_EQ(advice({kept, zero, kept}), zeros);
  EXPECT_EQ(advice({zero, zero}), zeros);
  EXPECT_EQ(advice({kept, transmission, kept}), all);
  EXPECT_EQ(advice({zero, transmission}), all);
  EXPECT_EQ(advice({transmission, zero}), all);
  EXPECT_EQ(advice({kept, kept}), all);
}

// Each sentence where its reason is given, and not elsewhere.
TEST(VerificationReport, EverySentenceOfAdviceHasItsReason) {
  VerificationReport report;
  report.joints.resize(2, {.determined = true});
  report.joint_types.assign(2, JointType::revolute);
  const auto said = [&](const char* words) {
    int count = 0;
    for (const std::string& sentence : report.advice()) count += sentence.find(words) != std::string::npos ? 1 : 0;
    return count;
  };
  EXPECT_EQ(said("check without --registered"), 1);
  EXPECT_EQ(said("--tool-remounted"), 0);
  report.registration.emplace();
  EXPECT_EQ(said("check without --registered"), 0);
  EXPECT_EQ(said("--tool-remounted"), 1);
  EXPECT_EQ(said("the base as it is now"), 0);
  report.options.tool = true;
  EXPECT_EQ(said("--tool-remounted"), 0);
  EXPECT_EQ(said("Measure the rows again"), 0);
  report.aside = {4};
  EXPECT_EQ(said("Measure the rows again"), 1);
  report.valid = true;
  EXPECT_EQ(said("the base as it is now"), 1);
  EXPECT_EQ(said("Calibrate again"), 0);
  report.options.base = false;
  EXPECT_EQ(said("the base as it is now"), 0);
  report.joints[1].determined = false;
  EXPECT_EQ(said("cannot tell a change of the zero of joint 2 from"), 1);
  EXPECT_EQ(said("cannot tell"), 1);
}

// Changes in mrad and mm, each with 1.96 standard deviations.
TEST(VerificationReport, TableByHand) {
  VerificationReport report;
  report.joint_types = {JointType::revolute, JointType::prismatic, JointType::revolute};
  report.joints = {{.determined = true,
                    .zero_change = 0.5e-3,
                    .zero_std = 0.1e-3,
                    .zero_p = 0.25,
                    .once_p = 0.5,
                    .zero_changed = true},
                   {.determined = true, .zero_change = -2e-3, .zero_std = 1e-3, .zero_p = 0.125, .once_p = 1},
                   {.once_p = 0.03125, .transmission_changed = true}};
  const std::string text = report.summary();
  for (const char* line : {"    1      0.5000 mrad     0.1960      0.25            0.5  changed\n",
                           "    2     -2.0000 mm       1.9600      0.12              1\n",
                           "    3  not determined                             0.031  changed\n",
                           "the zero of joint 1 moved by 0.5 +- 0.196 mrad; the transmission of joint 3 changed ("})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

TEST(VerifyCalibration, RefusesWhatItCannotCheck) {
  const auto refuses = [](const Dataset<6>& data, const VerifyOptions& options, const char* words) {
    const std::string said =
        complaint([&] { (void)verify_calibration(calibration().model(), calibration().errors, data, options); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  const auto data = measure(actual(), poses_of(10, 9), noise, 10);
  refuses(data, {.level = 0}, "level 0 must lie in (0, 1)");
  refuses(data, {.accept = -1.0}, "accept -1 must be positive");
  refuses(data.rows(std::array<Index, 2>{0, 1}), {}, "2 poses, at least 3 are needed");
  refuses(measure(actual(), poses_of(1001, 9), noise, 10), {}, "1001 poses, at most 1000");
  const std::string said = complaint(
      [&] { (void)verify_calibration(calibration().model(), calibration().errors, data, {}, PointRows::Zero(3, 3)); });
  EXPECT_NE(said.find("3 learned errors of 10 poses"), std::string::npos) << said;
}

}  // namespace
}  // namespace vernier::verify_test
