// SPDX-License-Identifier: BSD-3-Clause
// The audit of data: every kind of fault planted in simulated files and, where VERNIER_DATA_DIR names them, in measured
// ones; clean files; what frames absorb.

#include "vernier/calibration/data_audit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include "planted_faults.hpp"
#include "vernier/calibration/detail/audit_fit.hpp"
#include "vernier/calibration/detail/audit_rows.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::data_audit_test {
namespace {

using Chain = DhChain<6>;
const Chain ur5 = robots::ur5().chain;

constexpr FaultKind every_kind[] = {
    FaultKind::length_unit,   FaultKind::joint_unit,     FaultKind::joint_sign,
    FaultKind::joint_zero,    FaultKind::mirrored_frame, FaultKind::orientation_convention,
    FaultKind::shifted_rows,  FaultKind::swapped_rows,   FaultKind::duplicate_rows,
    FaultKind::outlier,       FaultKind::joints_read,    FaultKind::approach_never_varies,
    FaultKind::session_drift, FaultKind::joint_coupling};

/// An arm with geometric and joint errors, measured with noise.
Dataset<6> clean_file(Index n, std::uint64_t seed, bool oriented = true) {
  JointLimits<6> limits;
  limits.lower.setConstant(-2);
  limits.upper.setConstant(2);
  const Chain off = with_geometric_errors(ur5, {.length_max = 1e-3, .angle_max = 2e-3}, seed);
  const Framed actual(WithJointErrors<Chain>(off, draw_joint_errors(ur5, {}, seed + 1)),
                      FrameParameters(Vector6{2, -1, 0.5, 0.3, -0.2, 1.5}).isometry(),
                      FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}).isometry());
  return measure(actual, sample_joints(limits, n, seed + 2),
                 {.position = 0.03e-3, .orientation = 0.1e-3, .with_orientations = oriented}, seed + 3);
}

std::string words(const DataAudit& audit) { return audit.summary(); }

/// The fault is named, and nothing else but an outlier that follows from it.
template <int N>
void expect_named(const Planted<N>& planted, const DataAudit& audit) {
  bool named = false;
  for (const DataFinding& finding : audit.findings) {
    const bool is = planted.is(finding);
    named = named || is;
    const bool follows = planted.kind == FaultKind::duplicate_rows && finding.kind == FaultKind::outlier;
    EXPECT_TRUE(is || follows) << fault_name(planted.kind) << ": " << finding.message;
  }
  EXPECT_TRUE(named) << fault_name(planted.kind) << " of joint " << planted.joint << ", size " << planted.size << '\n'
                     << words(audit);
}

TEST(DataAudit, NamesEveryPlantedFault) {
  for (const bool oriented : {true, false}) {
    Rng rng(3);
    for (const FaultKind kind : every_kind)
      for (std::uint64_t k = 0; k < 3; ++k) {
        const auto planted = plant(ur5, clean_file(60 + 60 * static_cast<Index>(k), 10 * k, oriented), kind, {}, rng);
        if (planted) expect_named(*planted, audit_data(ur5, planted->data));
      }
  }
}

TEST(DataAudit, FindsNothingInCleanFiles) {
  for (std::uint64_t k = 0; k < 40; ++k) {
    const DataAudit audit = audit_data(ur5, clean_file(40 + 10 * static_cast<Index>(k), 100 + 10 * k, k % 2 == 0));
    EXPECT_TRUE(audit.findings.empty()) << k << words(audit);
    EXPECT_NE(words(audit).find("nothing found"), std::string::npos);
    EXPECT_LT(audit.registered.median, 6e-3);
    EXPECT_EQ(audit.registered.n, 40 + 10 * static_cast<Index>(k));
  }
}

TEST(DataAudit, FramesAbsorbTheZeroOfTheFirstAndTheLastJoint) {
  const Dataset<6> data = clean_file(80, 5);
  for (const int joint : {0, 5}) {
    JointRows<6> joints = data.joints();
    joints.col(joint).array() += 0.7;
    const DataAudit audit = audit_data(ur5, Dataset<6>(joints, data.positions(), data.orientations()));
    EXPECT_TRUE(audit.findings.empty()) << words(audit);
  }
}

// Orientations by other conventions, written out by hand; each is named.
TEST(DataAudit, NamesTheConventionOfOrientations) {
  const Dataset<6> data = clean_file(30, 13);
  constexpr double degrees = 180 / std::numbers::pi;
  const char* names[] = {"rotation vectors of the inverse rotation",
                         "rotation vectors in degrees",
                         "roll, pitch and yaw angles in radians",
                         "roll, pitch and yaw angles in degrees",
                         "Euler angles in radians",
                         "Euler angles in degrees"};
  for (int convention = 1; convention <= 6; ++convention) {
    PointRows orientations(30, 3);
    for (Index i = 0; i < 30; ++i) {
      const Matrix3 r = data.orientation(i);
      Vector3 v = log_so3(r);
      if (convention == 1) v *= -1;
      if (convention == 3 || convention == 4)  // r = z(c) y(b) x(a)
        v = Vector3(std::atan2(r(2, 1), r(2, 2)), -std::asin(r(2, 0)), std::atan2(r(1, 0), r(0, 0)));
      if (convention >= 5)  // r = x(a) y(b) z(c)
        v = Vector3(std::atan2(-r(1, 2), r(2, 2)), std::asin(r(0, 2)), std::atan2(-r(0, 1), r(0, 0)));
      if (convention % 2 == 0) v *= degrees;
      set_point(orientations, i, v);
    }
    const DataAudit audit = audit_data(ur5, Dataset<6>(data.joints(), data.positions(), orientations));
    ASSERT_EQ(audit.findings.size(), 1u) << words(audit);
    EXPECT_EQ(audit.findings[0].kind, FaultKind::orientation_convention) << words(audit);
    EXPECT_EQ(audit.findings[0].size, convention) << words(audit);
    EXPECT_NE(audit.findings[0].message.find(names[convention - 1]), std::string::npos) << words(audit);
    EXPECT_LT(audit.registered.median, 6e-3);
  }
}

// Zero errors up to half a turn; whole turns have no effect. Once the zero is corrected, no drift of the base is
// reported, and the row that is off by 50 mm is found.
TEST(DataAudit, StatesTheSizeOfALargeZero) {
  for (const std::uint64_t seed : {14, 20}) {
    const Dataset<6> data = clean_file(60, seed);
    PointRows positions = data.positions();
    positions(7, 0) += 0.05;
    for (const auto& [joint, zero] : {std::pair<int, double>{1, 1.2}, {2, -2.0}, {4, 2.8}, {3, 4.5}}) {
      JointRows<6> joints = data.joints();
      for (Index i = 0; i < 60; ++i) joints(i, joint) -= zero;
      const DataAudit audit = audit_data(ur5, Dataset<6>(joints, positions, data.orientations()));
      ASSERT_EQ(audit.findings.size(), 2u) << joint << words(audit);
      EXPECT_EQ(audit.findings[0].kind, FaultKind::joint_zero) << words(audit);
      EXPECT_EQ(audit.findings[0].joint, joint) << words(audit);
      EXPECT_NEAR(audit.findings[0].size, std::remainder(zero, 2 * std::numbers::pi), 6e-3) << words(audit);
      EXPECT_EQ(audit.findings[1].rows, std::vector<Index>{7}) << words(audit);
      EXPECT_LT(audit.registered.median, 6e-3);
    }
  }
}

TEST(DataAudit, KeepsAZeroThatArmsHaveToItself) {
  const Dataset<6> data = clean_file(100, 6);
  JointRows<6> joints = data.joints();
  joints.col(2).array() -= 0.008;
  EXPECT_FALSE(audit_data(ur5, Dataset<6>(joints, data.positions())).has(FaultKind::joint_zero));
  const DataAudit audit = audit_data(ur5, Dataset<6>(joints, data.positions()),
                                     {.smallest_zero = 0.004, .length_std = 1e-3, .angle_std = 1e-3});
  EXPECT_TRUE(audit.has(FaultKind::joint_zero)) << words(audit);
}

TEST(DataAudit, AnswersInTheRowsOfTheFileBehindALostRow) {
  // a lost row and, further down, an outlier: rows are named as they are in the file
  const Dataset<6> data = clean_file(120, 7);
  PointRows positions(119, 3);
  positions << data.positions().topRows(30), data.positions().bottomRows(89);
  positions.row(80) += Eigen::RowVector3d(0, 0.05, 0);
  const DataAudit audit = audit_data(ur5, Dataset<6>(data.joints().topRows(119), positions));
  ASSERT_TRUE(audit.has(FaultKind::shifted_rows)) << words(audit);
  ASSERT_TRUE(audit.has(FaultKind::outlier)) << words(audit);
  for (const DataFinding& finding : audit.findings) {
    if (finding.kind == FaultKind::shifted_rows) {
      EXPECT_EQ(finding.rows.front(), 30);
      EXPECT_EQ(finding.rows.back(), 118);
      EXPECT_EQ(finding.size, -1);
      EXPECT_EQ(finding.message,
                "rows 30 to 118: the pose of a row lies 1 row above its joints: pair them again, a row was lost or "
                "added");
    }
    // the pose of row 80 belongs to the joints of row 81
    if (finding.kind == FaultKind::outlier) {
      EXPECT_EQ(finding.rows, std::vector<Index>{81});
    }
  }
}

TEST(DataAudit, ToleratesManyOutliers) {
  const auto spoilt = with_outliers(clean_file(100, 8), 0.2, 0.1, 1);
  const DataAudit audit = audit_data(ur5, spoilt.data);
  ASSERT_EQ(audit.findings.size(), 1u) << words(audit);
  EXPECT_EQ(audit.findings[0].kind, FaultKind::outlier);
  EXPECT_EQ(audit.findings[0].rows, spoilt.rows);
  EXPECT_NEAR(audit.findings[0].size, 0.1, 0.01);
}

TEST(DataAudit, DoesNotDependOnTheGuessOfTheFrames) {
  const Dataset<6> data = clean_file(80, 9);
  const Framed<Chain> guessed(ur5, FrameParameters(Vector6{1, 2, 3, 1, 0, 2}).isometry(),
                              FrameParameters(Vector6{0, 0, 0.3, 0, 1, 0}).isometry());
  EXPECT_TRUE(audit_data(guessed, data).findings.empty());
  EXPECT_NEAR(audit_data(guessed, data).registered.median, audit_data(ur5, data).registered.median, 2e-5);
}

// A sentence names what is wrong and what to do about it, and no other fault.
TEST(DataAudit, EveryFaultOfAllRowsHasItsOwnSentence) {
  const Dataset<6> data = clean_file(30, 12);
  Rng rng(8);
  const auto said = [&](FaultKind kind) -> std::string {
    for (int drawn = 0; drawn < 10; ++drawn) {  // small faults are not found
      const auto planted = plant(ur5, data, kind, {}, rng);
      for (const DataFinding& finding : audit_data(ur5, planted->data).findings)
        if (finding.kind == kind && finding.joint == planted->joint) return finding.message;
    }
    return "not found";
  };
  const std::pair<FaultKind, const char*> sentences[] = {
      {FaultKind::length_unit, "times as large as the arm's: correct the unit of x, y, z"},
      {FaultKind::joint_unit, ": correct their unit"},
      {FaultKind::joint_sign, "counts in the other direction: reverse the sign of its column"},
      {FaultKind::joint_zero, "counts from a zero that is off by"},
      {FaultKind::mirrored_frame, "measured coordinates are left-handed: reverse one axis or exchange two"},
      {FaultKind::orientation_convention, ": convert them to rotation vectors in radians"}};
  for (const auto& [kind, words] : sentences) {
    const std::string sentence = said(kind);
    EXPECT_EQ(sentence.rfind("all rows: ", 0), 0u) << sentence;
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
  }
}

/// The only finding.
DataFinding only(const DataAudit& audit) {
  EXPECT_EQ(audit.findings.size(), 1u) << words(audit);
  return audit.findings.empty() ? DataFinding{FaultKind::outlier} : audit.findings[0];
}

/// The data with other joint values.
Dataset<6> at_joints(const Dataset<6>& data, const JointRows<6>& joints) {
  return data.has_orientations() ? Dataset<6>(joints, data.positions(), data.orientations())
                                 : Dataset<6>(joints, data.positions());
}

// Every pattern of the signs of six joints is told from all others.
TEST(DataAudit, NamesAllJointsThatAreReversed) {
  const std::vector<int> patterns[] = {{1, 2}, {0, 4}, {3, 5}, {1, 2, 4}, {0, 2, 3}, {2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}};
  for (const bool oriented : {true, false}) {
    const Dataset<6> data = clean_file(80, 31, oriented);
    for (const std::vector<int>& reversed : patterns) {
      JointRows<6> joints = data.joints();
      for (const int j : reversed) joints.col(j) *= -1;
      const DataAudit audit = audit_data(ur5, at_joints(data, joints));
      std::vector<int> named;
      for (const DataFinding& finding : audit.findings) {
        EXPECT_EQ(finding.kind, FaultKind::joint_sign) << words(audit);
        named.push_back(finding.joint);
      }
      EXPECT_EQ(named, reversed) << words(audit);
      EXPECT_LT(audit.registered.median, 6e-3);
    }
  }
}

// A third joint that counts from the horizontal contains the second one; its sign may be reversed as well.
TEST(DataAudit, NamesAJointThatContainsTheOneBefore) {
  const Chain irb120 = robots::abb_irb120().chain;
  for (const bool oriented : {true, false})
    for (const double factor : {1.0, -1.0})
      for (const bool reversed : {false, true}) {
        const Dataset<6> data = clean_file(80, 33, oriented);
        const Dataset<6> small =
            measure(irb120, data.joints(), {.position = 0.03e-3, .with_orientations = oriented}, 1);
        JointRows<6> joints = data.joints();
        if (reversed) joints.col(2) *= -1;
        joints.col(2) += factor * joints.col(1);
        for (const DataAudit& audit :
             {audit_data(ur5, at_joints(data, joints)), audit_data(irb120, at_joints(small, joints))}) {
          ASSERT_EQ(audit.findings.size(), reversed ? 2u : 1u) << words(audit);
          EXPECT_EQ(audit.findings[0].kind, FaultKind::joint_coupling) << words(audit);
          EXPECT_EQ(audit.findings[0].joint, 2) << words(audit);
          EXPECT_EQ(audit.findings[0].size, factor) << words(audit);
          if (reversed) {
            EXPECT_EQ(audit.findings[1].kind, FaultKind::joint_sign) << words(audit);
            EXPECT_EQ(audit.findings[1].joint, 2) << words(audit);
          }
          EXPECT_LT(audit.registered.median, 6e-3);
        }
      }
}

// Where nothing helps, that is said, and nothing is advised: joints of other poses, two columns exchanged, two faults.
TEST(DataAudit, SaysThatNothingMakesTheDataPlausible) {
  for (const bool oriented : {true, false}) {
    const Dataset<6> data = clean_file(80, 35, oriented);
    JointRows<6> exchanged = data.joints(), twice = data.joints();
    exchanged.col(1) = data.joints().col(2);
    exchanged.col(2) = data.joints().col(1);
    twice.col(1).array() += 0.6;
    twice.col(3) *= -1;
    twice.col(4) *= 0.5;
    for (const JointRows<6>& joints : {clean_file(80, 36).joints(), exchanged, twice}) {
      const DataAudit audit = audit_data(ur5, at_joints(data, joints));
      const DataFinding found = only(audit);
      EXPECT_EQ(found.kind, FaultKind::unexplained) << words(audit);
      EXPECT_NEAR(found.size, audit.registered.median, 1e-12);
      EXPECT_GT(found.size, 0.03);
      EXPECT_EQ(found.message.rfind("all rows: nothing makes the data plausible, the nominal arm misses them by ", 0),
                0u)
          << found.message;
    }
  }
}

TEST(DataAudit, OrientationsOfNoKnownConventionLeaveThePositions) {
  const Dataset<6> data = clean_file(80, 37);
  PointRows orientations = data.orientations();
  Rng rng(3);
  for (double& value : orientations.reshaped()) value = 2 * rng.uniform();
  const DataAudit audit = audit_data(ur5, Dataset<6>(data.joints(), data.positions(), orientations));
  EXPECT_EQ(only(audit).kind, FaultKind::orientation_convention) << words(audit);
  EXPECT_NE(only(audit).message.find("positions are: convert the orientations, or leave them out"), std::string::npos);
  EXPECT_LT(audit.registered.median, 6e-3);
}

// Poses of nearly one orientation hardly tell the wrist's zeros and signs; a correct arm has no fault.
TEST(DataAudit, FindsNothingInPosesOfNearlyOneOrientation) {
  const JointVector<6> home{0.3, -1.2, 1.4, -1.1, -1.5, 0.4};
  const Isometry3 at = ur5.pose(home);
  for (const double tilt : {0.0, 0.01, 0.05})
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      Rng rng(seed);
      JointRows<6> joints(80, 6);
      for (Index i = 0; i < 80;) {
        Vector3 position = at.translation(), turn;
        for (Index k = 0; k < 3; ++k) {
          position(k) += 0.25 * (2 * rng.uniform() - 1);
          turn(k) = tilt * rng.normal();
        }
        const Matrix3 turned = at.linear() * exp_so3(turn);
        const auto found = inverse_kinematics(ur5, rigid_motion(turned, position), home);
        if (found.status == IkStatus::converged) set_configuration(joints, i++, found.joints);
      }
      const Chain off = with_geometric_errors(ur5, {.length_max = 1e-3, .angle_max = 2e-3}, 10 * seed);
      const Framed actual(WithJointErrors<Chain>(off, draw_joint_errors(ur5, {}, 10 * seed + 1)),
                          FrameParameters(Vector6{2, -1, 0.5, 0.3, -0.2, 1.5}).isometry(),
                          FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}).isometry());
      for (const bool oriented : {true, false}) {
        const DataAudit audit = audit_data(
            ur5, measure(actual, joints, {.position = 0.03e-3, .orientation = 0.1e-3, .with_orientations = oriented},
                         10 * seed + 3));
        EXPECT_TRUE(audit.findings.empty()) << tilt << ' ' << seed << oriented << words(audit);
      }
    }
}

// Metres, decimetres, centimetres, millimetres and inches, one taken for another.
TEST(DataAudit, UnitsOfLength) {
  const Dataset<6> data = clean_file(40, 21);
  for (const double factor : {1000.0, 100.0, 1000 / 25.4, 25.4, 10.0, 0.1, 1 / 25.4, 25.4 / 1000, 0.01, 0.001}) {
    const DataFinding finding = only(audit_data(ur5, Dataset<6>(data.joints(), data.positions() * factor)));
    EXPECT_EQ(finding.kind, FaultKind::length_unit) << factor;
    EXPECT_NEAR(finding.size / factor, 1, 1e-12) << factor;
  }
}

/// The number behind some words.
double number_behind(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  EXPECT_NE(at, std::string::npos) << text;
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + words.size()));
}

TEST(DataAudit, UnitsOfJointsAreNamedByTheirDirection) {
  const Dataset<6> data = clean_file(30, 12);
  const double degrees = 180 / std::numbers::pi;
  const DataFinding large = only(audit_data(ur5, Dataset<6>(degrees * data.joints(), data.positions())));
  EXPECT_EQ(large.message, "all rows: joint angles look like degrees taken as radians: correct their unit");
  EXPECT_NEAR(large.size, degrees, 1e-9);
  const DataFinding small = only(audit_data(ur5, Dataset<6>(data.joints() / degrees, data.positions())));
  EXPECT_EQ(small.message, "all rows: joint angles look like radians taken as degrees: correct their unit");
  EXPECT_NEAR(small.size, 1 / degrees, 1e-9);
}

// A zero in degrees or millimetres, to be added to the column.
TEST(DataAudit, ZerosAreStatedInTheUnitOfTheirJoint) {
  const Dataset<6> data = clean_file(60, 6);
  JointRows<6> joints = data.joints();
  for (Index i = 0; i < 60; ++i) joints(i, 2) -= 0.35;
  const DataFinding angle = only(audit_data(ur5, Dataset<6>(joints, data.positions(), data.orientations())));
  EXPECT_EQ(angle.joint, 2);
  EXPECT_NEAR(number_behind(angle.message, "all rows: joint 3 counts from a zero that is off by "), 20.05, 0.5);
  EXPECT_NE(angle.message.find(" deg: add that to its column, or correct the nominal theta"), std::string::npos);

  std::array<DhRow, 6> rows;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i)] = ur5.row(i);
  rows[2] = {.a = 0.1, .alpha = 1.5, .d = 0.2, .theta = 0.3, .joint = JointType::prismatic};
  const Chain sliding = Chain::from_rows(rows);
  joints = data.joints();
  joints.col(2) *= 0.1;  // within 0.2 m
  const Dataset<6> seen = measure(sliding, joints, {.position = 0.03e-3, .orientation = 0.1e-3}, 1);
  for (Index i = 0; i < 60; ++i) joints(i, 2) += 0.03;
  const DataFinding length = only(audit_data(sliding, Dataset<6>(joints, seen.positions(), seen.orientations())));
  EXPECT_EQ(length.joint, 2);
  EXPECT_NEAR(length.size, -0.03, 0.5e-3);
  EXPECT_NEAR(number_behind(length.message, "joint 3 counts from a zero that is off by "), -30, 0.5);
  EXPECT_NE(length.message.find(" mm: add that to its column, or correct the nominal d"), std::string::npos);
}

// A row of joints was lost: the pose of a row is farther down.
TEST(DataAudit, PosesBelowTheirJoints) {
  const Dataset<6> data = clean_file(100, 7);
  JointRows<6> joints(99, 6);
  for (Index i = 0; i < 99; ++i) set_configuration(joints, i, data.joints(i < 40 ? i : i + 1));
  const DataFinding found = only(audit_data(ur5, Dataset<6>(joints, data.positions().topRows(99))));
  EXPECT_EQ(found.kind, FaultKind::shifted_rows);
  EXPECT_EQ(found.size, 1);
  EXPECT_EQ(found.message,
            "rows 40 to 98: the pose of a row lies 1 row below its joints: pair them again, a row was lost or added");
}

// Drift from the first row to the last, and how far the arm is off beside it.
TEST(DataAudit, DriftAndRegisteredErrorsAreStated) {
  const Dataset<6> data = clean_file(100, 15);
  PointRows positions = data.positions();
  for (Index i = 0; i < 100; ++i) positions(i, 1) += 8e-3 * static_cast<double>(i) / 99;
  const DataAudit audit = audit_data(ur5, Dataset<6>(data.joints(), positions, data.orientations()));
  const DataFinding found = only(audit);
  EXPECT_EQ(found.kind, FaultKind::session_drift);
  EXPECT_NEAR(found.size, 8e-3, 1e-3);
  EXPECT_NEAR(number_behind(found.message, "all rows: base and sensor move against each other by "), 8, 1);
  EXPECT_NE(found.message.find(" mm from the first row to the last"), std::string::npos);
  const std::string text = audit.summary();
  EXPECT_NEAR(number_behind(text, "with registered frames the nominal arm is off by "), audit.registered.median * 1e3,
              6e-3 * audit.registered.median * 1e3);
  EXPECT_NEAR(number_behind(text, "mm (median), "), audit.registered.max * 1e3, 6e-3 * audit.registered.max * 1e3);
  EXPECT_NE(text.find(" mm (largest), 100 rows"), std::string::npos) << text;
}

// Zeros that other parameters hide, in an arm whose own are off by 2 mrad: of each joint whose zero frames do not
// absorb.
TEST(DataAudit, FindsSmallZerosOfShoulderAndElbow) {
  const Dataset<6> data = clean_file(100, 6);
  for (const int joint : {1, 2}) {
    JointRows<6> joints = data.joints();
    for (Index i = 0; i < data.size(); ++i) joints(i, joint) += 0.007;
    const DataAudit audit = audit_data(ur5, Dataset<6>(joints, data.positions(), data.orientations()),
                                       {.smallest_zero = 0.003, .length_std = 1e-3, .angle_std = 1e-3});
    ASSERT_EQ(audit.findings.size(), 1u) << joint << words(audit);
    EXPECT_EQ(audit.findings[0].kind, FaultKind::joint_zero) << words(audit);
    EXPECT_EQ(audit.findings[0].joint, joint) << words(audit);
    EXPECT_NEAR(audit.findings[0].size, -0.007, 3e-3) << words(audit);  // parallel joints share their own zeros
  }
}

// Where the geometry is known almost exactly, it is the residuals of the poses that tell a zero from none.
TEST(DataAudit, FindsASmallZeroOfAnArmWhoseGeometryIsKnown) {
  JointLimits<6> limits;
  limits.lower.setConstant(-2);
  limits.upper.setConstant(2);
  for (const bool oriented : {true, false}) {
    const Dataset<6> data = measure(ur5, sample_joints(limits, 100, 5),
                                    {.position = 0.1e-3, .orientation = 0.3e-3, .with_orientations = oriented}, 6);
    JointRows<6> joints = data.joints();
    for (Index i = 0; i < data.size(); ++i) joints(i, 2) += 0.5e-3;
    const DataAuditOptions exact{.smallest_zero = 0.2e-3, .length_std = 1e-6, .angle_std = 1e-6};
    const DataAudit audit = audit_data(
        ur5,
        oriented ? Dataset<6>(joints, data.positions(), data.orientations()) : Dataset<6>(joints, data.positions()),
        exact);
    ASSERT_EQ(audit.findings.size(), 1u) << words(audit);
    EXPECT_EQ(audit.findings[0].kind, FaultKind::joint_zero) << words(audit);
    EXPECT_EQ(audit.findings[0].joint, 2) << words(audit);
    EXPECT_NEAR(audit.findings[0].size, -0.5e-3, 0.1e-3);
    EXPECT_TRUE(audit_data(ur5, data, exact).findings.empty());
  }
}

TEST(DataAudit, EveryKindHasAName) {
  for (const FaultKind kind : every_kind) EXPECT_FALSE(fault_name(kind).empty());
  EXPECT_EQ(fault_name(FaultKind::joint_sign), "joint_sign");
  EXPECT_EQ(fault_name(FaultKind::joint_coupling), "joint_coupling");
  EXPECT_EQ(fault_name(FaultKind::unexplained), "unexplained");
}

TEST(DataAudit, RefusesWhatItCannotAssess) {
  EXPECT_THROW(audit_data(ur5, clean_file(9, 1)), std::invalid_argument);
  EXPECT_THROW(audit_data(ur5, Dataset<6>()), std::invalid_argument);
  const Dataset<6> data = clean_file(40, 1);
  EXPECT_NO_THROW(audit_data(ur5, clean_file(10, 1)));
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(audit_data(ur5, data, {.smallest_zero = bad}), std::invalid_argument);
    EXPECT_THROW(audit_data(ur5, data, {.outlier_factor = bad}), std::invalid_argument);
    EXPECT_THROW(audit_data(ur5, data, {.length_std = bad}), std::invalid_argument);
    EXPECT_THROW(audit_data(ur5, data, {.angle_std = bad}), std::invalid_argument);
  }
}

TEST(DataAudit, AnArmThatDoesNotMoveIsNoFault) {
  // poses of one configuration determine nothing, and nothing may be invented
  const Dataset<6> one = clean_file(1, 1);
  JointRows<6> joints = one.joints().replicate(20, 1);
  PointRows positions = one.positions().replicate(20, 1);
  Rng rng(1);
  for (Index i = 0; i < 20; ++i)
    for (Index c = 0; c < 3; ++c) positions(i, c) += 1e-5 * rng.normal();
  const DataAudit audit = audit_data(ur5, Dataset<6>(joints, positions));
  for (const DataFinding& finding : audit.findings) EXPECT_EQ(finding.kind, FaultKind::outlier) << finding.message;
}

// ---------------------------------------------------------------------------------------------- measured robots

const char* measured_folder() {
  const char* folder = std::getenv("VERNIER_DATA_DIR");
  return folder != nullptr && *folder != '\0' ? folder : nullptr;
}

/// One fault of each kind in 150 rows of a measured file.
template <class AnyChain>
void audit_measured(const AnyChain& chain, const std::string& file, const PlantedSizes& sizes) {
  constexpr int N = AnyChain::dof;
  const Dataset<N> data = read_dataset<N>(std::string(measured_folder()) + "/" + file);
  Rng rng(5);
  int planted_files = 0, named_files = 0;
  for (const FaultKind kind : every_kind) {
    std::vector<Index> rows = rng.permutation(data.size());
    rows.resize(150);
    std::sort(rows.begin(), rows.end());
    for (const DataFinding& finding : audit_data(chain, data.rows(rows)).findings)
      EXPECT_EQ(finding.kind, FaultKind::session_drift) << finding.message;  // the session of the UR5 has a trend
    const auto planted = plant(chain, data.rows(rows), kind, sizes, rng);
    if (!planted) continue;
    const DataAudit audit = audit_data(chain, planted->data);
    ++planted_files;
    named_files += std::any_of(audit.findings.begin(), audit.findings.end(),
                               [&](const DataFinding& finding) { return planted->is(finding); });
  }
  EXPECT_GE(planted_files, 12);
  EXPECT_GE(named_files, planted_files - 1);
}

TEST(DataAuditOfMeasuredPoses, Ur10) {
  if (measured_folder() == nullptr) GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  audit_measured(robots::ur10().chain, "ur10_random_poses.csv", {});
}

TEST(DataAuditOfMeasuredPoses, Ur5) {
  if (measured_folder() == nullptr) GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  audit_measured(robots::ur5().chain, "ur5_grid.csv", {});
}

TEST(DataAuditOfMeasuredPoses, Wam) {
  if (measured_folder() == nullptr) GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  audit_measured(robots::barrett_wam().chain, "wam_grid.csv",
                 {.effect = 20e-3,
                  .zero_min = 0.07,
                  .outlier_min = 25e-3,
                  .outlier_max = 0.2,
                  .drift_min = 20e-3,
                  .drift_max = 60e-3});
}

// A turn about z of 0.2 rad and a shift along z of 10 mm, half of both from the middle of the session to its end.
TEST(BaseTrendWhiteBox, IsTakenOffTheRows) {
  detail::BaseTrend trend;
  trend.motion = Vector6{0, 0, 0.01, 0, 0, 0.2};
  trend.centre = Vector3(1, 0, 0);
  const Vector3 arm(0.5, 0.2, 0);
  const Matrix3 orientation = exp_so3(Vector3(0.3, -0.2, 0.5));
  detail::AuditRows rows{MatrixX::Zero(3, 6), PointRows(3, 3)};
  for (Index i = 0; i < 3; ++i) {
    const double share = 0.5 * static_cast<double>(i - 1);
    const Matrix3 turn = exp_so3(Vector3(0, 0, 0.2 * share));
    set_point(rows.positions, i, trend.centre + turn * arm + Vector3(0, 0, 0.01 * share));
    rows.orientations.push_back(turn * orientation);
  }
  const detail::AuditRows found = detail::without_trend(rows, trend, Vector3(100, 110, 120));
  for (Index i = 0; i < 3; ++i) {
    EXPECT_LT((point(found.positions, i) - trend.centre - arm).norm(), 1e-15);
    EXPECT_LT((found.orientations[static_cast<std::size_t>(i)] - orientation).norm(), 1e-15);
  }
}

/// The trend of poses whose joints have errors and whose base moves evenly; `displacement` is how far that moved the
/// positions, root mean square.
template <class Error>
detail::BaseTrend trend_of(const Error& error, const Vector6& motion, double& displacement, Index n = 120) {
  const Dataset<6> file = clean_file(n, 21);
  const ArmGeometry arm(
      Framed<Chain>(ur5, rigid_motion(Matrix3::Identity(), Vector3(2, -1, 0.5)), Isometry3::Identity()));
  detail::AuditRows rows{file.joints(), PointRows(n, 3)};
  MatrixX actually = rows.joints;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < 6; ++j) actually(i, j) += error(rows.joints(i, j), j);
  const std::vector<Isometry3> poses = arm.poses(actually);
  const PointRows modelled = arm.positions(actually);
  const Vector3 centre = centroid(modelled);
  Rng rng(6);
  for (Index i = 0; i < n; ++i) {
    const Vector6 moved = (static_cast<double>(i) / static_cast<double>(n - 1) - 0.5) * motion;
    const Matrix3 turn = exp_so3(Vector3(moved(3), moved(4), moved(5)));
    const Vector3 lever = turn * (point(modelled, i) - centre), shift(moved(0), moved(1), moved(2)),
                  noise(rng.normal(), rng.normal(), rng.normal()), tilt(rng.normal(), rng.normal(), rng.normal());
    set_point(rows.positions, i, centre + lever + shift + 0.05e-3 * noise);
    const Matrix3 off = exp_so3(Vector3(0.1e-3 * tilt)) * turn;
    rows.orientations.push_back(off * rotation(poses[static_cast<std::size_t>(i)]));
  }
  displacement = 0;
  for (Index i = 0; i < n; ++i) {
    const Vector3 turn(motion(3), motion(4), motion(5)), by = turn.cross(point(modelled, i) - centre);
    displacement = std::hypot(displacement, (by + Vector3(motion(0), motion(1), motion(2))).norm() / std::sqrt(n));
  }
  VectorX times(n);
  for (Index i = 0; i < n; ++i) times(i) = 1000 + 7 * static_cast<double>(i);
  const VectorX stds = detail::audit_geometry_std(arm, true, 2e-3, 3e-3);
  const detail::AuditFit fit = detail::audit_fit(arm, arm.parameters(), stds, rows, 12);
  return detail::base_trend(fit, stds, rows, times);
}

// Joint errors of orders 1 to 3 are estimated beside the trend: what is left is the noise, and the motion is found.
TEST(BaseTrendWhiteBox, IsFoundBesideJointErrors) {
  const Vector6 none = Vector6::Zero(), motion{0.2e-3, -0.1e-3, 0.3e-3, 0.2e-3, 0.3e-3, -0.4e-3};
  double displacement = 0;
  for (const int order : {1, 2, 3})
    for (const double phase : {0.0, 0.5 * std::numbers::pi})
      for (const Vector6& moved : {none, motion}) {
        const auto error = [&](double q, Index j) { return j == 2 || j == 4 ? 1e-3 * std::cos(order * q - phase) : 0; };
        const detail::BaseTrend trend = trend_of(error, moved, displacement);
        EXPECT_GT(trend.scale, 0.042e-3) << order << ' ' << phase;
        EXPECT_LT(trend.scale, 0.055e-3) << order << ' ' << phase;
        for (Index k = 0; k < 6; ++k)
          EXPECT_NEAR(trend.motion(k), moved(k), 0.06e-3) << order << ' ' << phase << ' ' << k;
        EXPECT_NEAR(trend.displacement, displacement, 0.06e-3) << order << ' ' << phase;
        EXPECT_EQ(trend.chi_square > 28, moved(0) > 0) << trend.chi_square;  // 99.99 % of six degrees of freedom
      }
}

// The unknowns are the motion, the geometry and, per joint and order, two harmonics; two values are needed for each.
TEST(BaseTrendWhiteBox, OfFewPosesIsEstimatedWithoutHarmonics) {
  const auto none = [](double, Index) { return 0.0; };
  const Vector6 motion{2e-3, -1e-3, 3e-3, 2e-3, 3e-3, -4e-3};
  double displacement = 0;
  EXPECT_EQ(trend_of(none, motion, displacement, 15).chi_square, 0);  // 90 values, 48 unknowns
  for (const Index n : {16, 19, 20}) {
    const detail::BaseTrend trend = trend_of(none, motion, displacement, n);
    EXPECT_GT(trend.chi_square, 28) << n;
    EXPECT_NEAR(trend.displacement, displacement, 0.15 * displacement) << n;
  }
}

}  // namespace
}  // namespace vernier::data_audit_test
