// SPDX-License-Identifier: BSD-3-Clause
// Findings of the audit on single rows and single joints, word by word; residuals of rows that are left out.

#include "vernier/calibration/detail/audit_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/calibration/detail/audit_fit.hpp"
#include "vernier/calibration/detail/audit_hypotheses.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/measurements/position_sensor.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::audit_rows_test {
namespace {

using vernier_test::RealMatrix;

const ArmGeometry arm(in_frames(robots::ur5().chain));

/// Rows that an arm reaches exactly.
detail::AuditRows exact_rows(Index n, std::uint64_t seed, bool oriented = true) {
  JointLimits<6> limits;
  limits.lower.setConstant(-2);
  limits.upper.setConstant(2);
  detail::AuditRows out{sample_joints(limits, n, seed), {}};
  out.positions = arm.positions(out.joints);
  if (!oriented) return out;
  out.rotation_vectors.resize(n, 3);
  const std::vector<Isometry3> poses = arm.poses(out.joints);
  for (Index i = 0; i < n; ++i) {
    out.orientations.push_back(rotation(poses[static_cast<std::size_t>(i)]));
    set_point(out.rotation_vectors, i, log_so3(out.orientations.back()));
  }
  return out;
}

/// The same with normal errors of positions [m] and orientations [rad].
detail::AuditRows noisy_rows(Index n, std::uint64_t seed, bool oriented = true) {
  detail::AuditRows out = exact_rows(n, seed, oriented);
  Rng rng(seed);
  for (Index i = 0; i < n; ++i) {
    const Vector3 shift(rng.normal(), rng.normal(), rng.normal()), turn(rng.normal(), rng.normal(), rng.normal());
    set_point(out.positions, i, point(out.positions, i) + 1e-3 * shift);
    if (!oriented) continue;
    const Matrix3 turned = exp_so3(Vector3(2e-3 * turn)) * out.orientations[static_cast<std::size_t>(i)];
    out.orientations[static_cast<std::size_t>(i)] = turned;
  }
  return out;
}

TEST(AuditRowsWhiteBox, DuplicatesAreNamedByWhatIsTheSame) {
  MatrixX joints(8, 2);
  PointRows positions(8, 3), turns(8, 3);
  for (Index i = 0; i < 8; ++i) {
    const auto value = static_cast<double>(i);
    joints(i, 0) = value;
    joints(i, 1) = -value;
    set_point(positions, i, Vector3(8 - value, value, 1));
    set_point(turns, i, Vector3(0, 0, 0.1));
  }
  for (const Index row : {3, 7}) set_point(positions, row, point(positions, 1));  // 1, 3 and 7: at joints of their own
  positions(4, 0) = -1;                                                           // the smallest coordinate of all
  set_point(positions, 5, point(positions, 4));                                   // 4 and 5: at the same joints
  for (Index j = 0; j < 2; ++j) joints(5, j) = joints(4, j);
  const auto found = [&](const PointRows& rotation_vectors) {
    const MeasuredSet station("poses", joints, PositionSensor(positions));
    std::vector<DataFinding> out;
    detail::audit_duplicates(station, rotation_vectors, out);
    return out;
  };
  for (const PointRows& rotation_vectors : {turns, PointRows(0, 3)}) {
    const auto all = found(rotation_vectors);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].kind, FaultKind::duplicate_rows);
    EXPECT_EQ(all[0].rows, (std::vector<Index>{1, 3, 7}));
    EXPECT_EQ(
        all[0].message,
        "rows 1, 3 and 7: the same pose in all digits at different joints: the sensor was not read again, measure "
        "these rows again or leave them out");
    EXPECT_EQ(all[1].rows, (std::vector<Index>{4, 5}));
    EXPECT_EQ(all[1].message, "rows 4 and 5: joints and pose are the same in all digits: leave out all but one");
  }
  turns(3, 1) = 1e-9;  // another orientation is another pose
  joints(5, 1) += 1e-9;
  const auto fewer = found(turns);
  ASSERT_EQ(fewer.size(), 2u);
  EXPECT_EQ(fewer[0].rows, (std::vector<Index>{1, 7}));
  EXPECT_NE(fewer[1].message.find("at different joints"), std::string::npos) << fewer[1].message;
}

TEST(AuditRowsWhiteBox, AJointThatAlwaysComesFromOneSide) {
  const auto found = [](Index up, Index down, bool known = true) {
    const Index n = up + down + 5;  // in five rows it rests
    const MatrixX joints = MatrixX::Zero(n, 2);
    MatrixX previous = MatrixX::Zero(n, 2);
    for (Index i = 0; i < up + down; ++i) {
      previous(i, 1) = i < up ? -0.1 : 0.1;
      previous(i, 0) = i % 2 == 0 ? 1 : -1;
    }
    std::vector<DataFinding> out;
    MeasuredSet set("poses", joints, PositionSensor(PointRows::Zero(n, 3)));
    if (known) set.previous = previous;
    detail::audit_approaches(set, out);
    return out;
  };
  EXPECT_TRUE(found(24, 0).empty());
  EXPECT_TRUE(found(40, 1).empty());
  EXPECT_TRUE(found(40, 0, false).empty());
  const auto below = found(25, 0), above = found(0, 30);
  ASSERT_EQ(below.size(), 1u);
  EXPECT_EQ(below[0].kind, FaultKind::approach_never_varies);
  EXPECT_EQ(below[0].joint, 1);
  EXPECT_EQ(
      below[0].message,
      "all rows: joint 2 always comes from below: its hysteresis cannot be told from its zero, approach some poses "
      "from the other side if commands will be");
  ASSERT_EQ(above.size(), 1u);
  EXPECT_NE(above[0].message.find("joint 2 always comes from above"), std::string::npos);
}

/// Findings on joints that repeat commands, each read three times over `width`.
std::vector<DataFinding> read_joints(const std::vector<double>& widths, double apart) {
  MatrixX joints(30, static_cast<Index>(widths.size()));
  for (Index i = 0; i < 30; ++i)
    for (Index j = 0; j < joints.cols(); ++j)
      joints(i, j) =
          apart * static_cast<double>(i / 3) + 0.5 * widths[static_cast<std::size_t>(j)] * static_cast<double>(i % 3);
  std::vector<DataFinding> out;
  detail::audit_joint_values(joints, out);
  return out;
}

TEST(AuditRowsWhiteBox, ReadingsOfSeveralJointsAreToldTogether) {
  const auto three = read_joints({2e-3, 6e-3, 4e-3}, 0.5);
  ASSERT_EQ(three.size(), 1u);
  EXPECT_EQ(three[0].joint, -1);
  EXPECT_NEAR(three[0].size, 6e-3, 1e-12);
  EXPECT_EQ(three[0].message,
            "all rows: values of joints 1, 2 and 3 scatter about repeated commands: they were read, not commanded: a "
            "model fitted to them corrects readings, use the commands if commands are to be corrected");
  const auto second = read_joints({0, 6e-3}, 0.5);  // the first was commanded: repeated in all digits
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].joint, 1);
  EXPECT_EQ(second[0].message.rfind("all rows: values of joint 2 scatter", 0), 0u) << second[0].message;
  EXPECT_EQ(read_joints({19e-3}, 0.5).size(), 1u);
  EXPECT_TRUE(read_joints({21e-3}, 0.5).empty());  // wider than readings scatter
  EXPECT_TRUE(read_joints({6e-3}, 0.012).empty());
  EXPECT_TRUE(read_joints({12e-3}, 0.05).empty());  // 12 mrad of 38
  EXPECT_EQ(read_joints({12e-3}, 0.1).size(), 1u);
}

/// What is said of rows of which some have another pose.
std::vector<DataFinding> single_rows(detail::AuditRows rows, const std::vector<std::pair<Index, Vector3>>& shifts,
                                     const std::vector<std::pair<Index, double>>& turns) {
  for (const auto& [row, shift] : shifts) set_point(rows.positions, row, point(rows.positions, row) + shift);
  for (const auto& [row, turn] : turns) {
    const Matrix3 turned = exp_so3(Vector3(0, 0, turn)) * rows.orientations[static_cast<std::size_t>(row)];
    rows.orientations[static_cast<std::size_t>(row)] = turned;
  }
  std::vector<Index> numbers;
  for (Index i = 0; i < rows.size(); ++i) numbers.push_back(i + 100);
  const VectorX stds = detail::audit_frames_std(arm, rows.oriented());
  const detail::AuditFit found = detail::audit_fit(arm, arm.parameters(), stds, rows, 12);
  std::vector<DataFinding> out;
  detail::audit_single_rows(found, stds, rows, numbers, {}, 9, out);
  return out;
}

TEST(AuditRowsWhiteBox, OutliersOfPositionsAndOrientations) {
  const detail::AuditRows rows = noisy_rows(60, 3);
  EXPECT_TRUE(single_rows(rows, {}, {}).empty());
  const auto shifted = single_rows(rows, {{7, {0.2, 0, 0}}, {30, {0, 0.1, 0}}}, {});
  ASSERT_EQ(shifted.size(), 1u);
  EXPECT_EQ(shifted[0].rows, (std::vector<Index>{107, 130}));
  EXPECT_NEAR(shifted[0].size, 0.2, 5e-3);  // the larger one
  EXPECT_EQ(shifted[0].message.rfind("rows 107 and 130: the pose is not that of the joints, off by up to ", 0), 0u);
  EXPECT_NE(shifted[0].message.find(" mm: check the entries, measure again or leave them out"), std::string::npos)
      << shifted[0].message;
  const auto turned = single_rows(rows, {}, {{9, 0.5}});
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned[0].rows, std::vector<Index>{109});
  EXPECT_NEAR(turned[0].size, 0.5, 0.01);
  const std::string& said = turned[0].message;
  const std::string begin = "row 109: the pose is not that of the joints, off by up to ";
  ASSERT_EQ(said.rfind(begin, 0), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(begin.size())), 0.5 * 180 / std::numbers::pi, 0.6) << said;
  EXPECT_NE(said.find(" deg: check"), std::string::npos) << said;
  const auto both = single_rows(rows, {{7, {0.2, 0, 0}}}, {{9, 0.5}});
  ASSERT_EQ(both.size(), 1u);
  EXPECT_NEAR(both[0].size, 0.2, 5e-3);
  EXPECT_NE(both[0].message.find(" mm and "), std::string::npos) << both[0].message;
}

// Poses that are exchanged fit when they are exchanged back, in position and in orientation.
TEST(AuditRowsWhiteBox, ExchangedPoses) {
  for (const bool oriented : {true, false}) {
    detail::AuditRows rows = noisy_rows(60, 5, oriented);
    const Vector3 other = point(rows.positions, 12);
    set_point(rows.positions, 12, point(rows.positions, 40));
    set_point(rows.positions, 40, other);
    if (oriented) {
      // positions alone are exchanged, orientations are not: no poses are
      for (const DataFinding& finding : single_rows(rows, {}, {})) EXPECT_EQ(finding.kind, FaultKind::outlier);
      std::swap(rows.orientations[12], rows.orientations[40]);
    }
    const auto found = single_rows(rows, {}, {});
    ASSERT_EQ(found.size(), 1u) << oriented;
    EXPECT_EQ(found[0].kind, FaultKind::swapped_rows);
    EXPECT_EQ(found[0].rows, (std::vector<Index>{112, 140}));
    EXPECT_EQ(found[0].message, "rows 112 and 140: their poses are exchanged: swap them");
    EXPECT_NEAR(found[0].size, (point(rows.positions, 12) - point(rows.positions, 40)).norm(), 0.01);
  }
}

TEST(AuditFitWhiteBox, ScalesAndFreeParametersByHand) {
  PointRows residuals(5, 3);
  residuals << 3, 0, 0, 0, 1, 0, 0, 0, 2, 0, 7, 0, 0, 0, 0;  // norms 0 1 2 3 7
  EXPECT_NEAR(detail::robust_scale(residuals), 2 / 1.538, 1e-12);
  EXPECT_EQ(detail::robust_scale(PointRows::Zero(5, 3)), 1e-9);
  const detail::AuditResiduals scales{{}, {}, 3e-3, 16e-3};
  EXPECT_NEAR(scales.score(), 5e-3, 1e-15);  // 3 mm, and 16 mrad at 0.25 m
  const double infinity = std::numeric_limits<double>::infinity();
  for (const bool oriented : {true, false}) {
    const VectorX frames = detail::audit_frames_std(arm, oriented),
                  all = detail::audit_geometry_std(arm, oriented, 2e-3, 3e-3);
    ASSERT_EQ(frames.size(), 42);
    for (Index k = 0; k < 42; ++k) {
      const bool chain = k >= 6 && k < 36, length = (k - 6) % 5 == 0 || (k - 6) % 5 == 2;
      const double free = k < 39 || oriented ? infinity : 0;
      EXPECT_EQ(frames(k), chain ? 0 : free) << k;
      EXPECT_EQ(all(k), chain ? (length ? 2e-3 : 3e-3) : free) << k;
    }
  }
  EXPECT_EQ(detail::zero_parameter(arm, 2), 6 + 5 * 2 + 3);
}

// A row left out changes J' W J by its own share; what it then misses by has the covariance of the row and of the fit
// without it.
TEST(LeaveOutRowsWhiteBox, AreThoseOfTheFitWithoutThem) {
  const Index n = 9;
  const detail::AuditRows rows = noisy_rows(n, 6);
  VectorX stds = detail::audit_frames_std(arm, true);
  stds(6) = 1e-3;
  const detail::AuditFit fit{arm, detail::audit_residuals(arm, rows)};
  const auto left = detail::leave_out_rows(fit, stds, rows);
  const double scale[] = {fit.residuals.position_scale, fit.residuals.rotation_scale};
  std::vector<Index> free;
  for (Index k = 0; k < 42; ++k)
    if (stds(k) > 0) free.push_back(k);
  const auto unknowns = static_cast<Index>(free.size());
  ASSERT_EQ(unknowns, 13);
  RealMatrix jacobian(6 * n, unknowns), normal(unknowns, unknowns);
  for (Index c = 0; c < unknowns; ++c) {
    VectorX p = arm.parameters();
    constexpr double h = 1e-6;
    p(free[static_cast<std::size_t>(c)]) += h;
    const auto above = arm.with_parameters(p).poses(rows.joints);
    p(free[static_cast<std::size_t>(c)]) -= 2 * h;
    const auto below = arm.with_parameters(p).poses(rows.joints);
    for (Index i = 0; i < n; ++i) {
      const Vector6 apart = pose_difference(above[static_cast<std::size_t>(i)], below[static_cast<std::size_t>(i)]);
      for (Index v = 0; v < 6; ++v) jacobian(6 * i + v, c) = apart(v) / (2 * h) / scale[v / 3];
    }
    normal(c, c) = free[static_cast<std::size_t>(c)] == 6 ? 1e6 : 1e-4;
  }
  std::vector<double> weights;
  RealMatrix residual(6 * n, 1);
  for (Index i = 0; i < n; ++i)
    for (Index part = 0; part < 2; ++part) {
      const Vector3 r = point(part == 0 ? fit.residuals.position : fit.residuals.rotation, i) / scale[part];
      residual.set_block(6 * i + 3 * part, 0, r);
      weights.push_back(1 / (1 + r.squaredNorm() / 16));
      const RealMatrix own = jacobian.block(6 * i + 3 * part, 0, 3, unknowns);
      normal += weights.back() * own.transpose() * own;
    }
  std::vector<double> factors[2];
  std::vector<RealMatrix> covariances;
  for (Index k = 0; k < 2 * n; ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    const RealMatrix own = jacobian.block(3 * k, 0, 3, unknowns), r = residual.block(3 * k, 0, 3, 1);
    const RealMatrix others = (normal - weight * own.transpose() * own).inverse();
    const RealMatrix spread = own * others * own.transpose();
    const RealMatrix missed = r + weight * spread * r, covariance = RealMatrix::identity(3) + spread;
    const detail::LeftOut& row = left[static_cast<std::size_t>(k / 2)];
    EXPECT_NEAR(k % 2 == 0 ? row.position : row.rotation, missed.norm() * scale[k % 2],
                1e-5 * missed.norm() * scale[k % 2])
        << k;
    factors[k % 2].push_back(std::sqrt(missed.dot(covariance.inverse() * missed)));
    if (k % 2 == 0) covariances.push_back(covariance);
  }
  for (const int part : {0, 1}) {
    std::vector<double> sorted = factors[part];
    std::sort(sorted.begin(), sorted.end());
    const double to_median = 1.538 / sorted[4];
    for (std::size_t i = 0; i < 9; ++i) {
      const double factor = part == 0 ? left[i].position_factor : left[i].rotation_factor;
      EXPECT_NEAR(factor, to_median * factors[part][i], 1e-5 * factor) << i;
      if (part == 1) continue;
      const RealMatrix weight = to_median * to_median / (scale[0] * scale[0]) * covariances[i].inverse();
      EXPECT_LT((RealMatrix(left[i].position_weight) - weight).norm(), 1e-5 * weight.norm()) << i;
    }
  }
}

// Positions and orientations by Cauchy's loss, a length by its prior: at the fit what pulls is zero.
TEST(AuditFitWhiteBox, PriorsAndWeightsBalance) {
  const Index n = 40;
  const detail::AuditRows rows = noisy_rows(n, 7);
  VectorX stds = VectorX::Zero(42), centre = arm.parameters();
  for (const Index k : {0, 1, 2}) stds(k) = std::numeric_limits<double>::infinity();
  stds(11) = 0.2e-3;  // a2
  centre(11) += 1e-3;
  const detail::AuditFit fit = detail::audit_fit(arm, centre, stds, rows, 60);
  const VectorX found = fit.arm.parameters();
  constexpr double square = 4 * 4;  // of the threshold of the loss, in robust scales
  // Lightly curved, so that the derivative of the cost at the scales of the solution is zero.
  const auto cost = [&](const VectorX& p) {
    const detail::AuditResiduals r = detail::audit_residuals(arm.with_parameters(p), rows);
    double sum = std::pow((p(11) - centre(11)) / 0.2e-3, 2);
    for (Index i = 0; i < n; ++i) {
      sum += square * std::log1p(std::pow(point(r.position, i).norm() / fit.residuals.position_scale, 2) / square);
      sum += square * std::log1p(std::pow(point(r.rotation, i).norm() / fit.residuals.rotation_scale, 2) / square);
    }
    return sum;
  };
  for (const Index k : {0, 1, 2, 11}) {
    VectorX above = found, below = found;
    above(k) += 1e-5;
    below(k) -= 1e-5;
    const double slope = (cost(above) - cost(below)) / 2, curvature = cost(above) + cost(below) - 2 * cost(found);
    EXPECT_LT(std::abs(slope / curvature), 3) << k;  // within 0.03 mm of the minimum
  }
  EXPECT_GT(std::abs(found(11) - centre(11)), 0.05e-3);
  EXPECT_GT(std::abs(found(11) - arm.parameters()(11)), 0.05e-3);
}

TEST(AuditHypothesesWhiteBox, SpreadRowsAndScatter) {
  EXPECT_EQ(detail::spread_rows(10, 4), (std::vector<Index>{0, 2, 5, 7}));
  EXPECT_EQ(detail::spread_rows(3, 200), (std::vector<Index>{0, 1, 2}));
  PointRows cross(5, 3);
  cross << 1, 1, 0, -1, 1, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0;  // about (0, 1, 0) at 1, the last at 0
  EXPECT_NEAR(detail::point_scatter(cross), 1 / 1.538, 1e-12);
}

// With orientations it is known which axis was reversed, and whether they were mirrored, too; without them any axis
// does.
TEST(AuditHypothesesWhiteBox, MirroredFramesAreUndone) {
  const detail::AuditRows rows = noisy_rows(60, 3);
  for (int axis = 0; axis < 4; ++axis) {
    detail::AuditRows mirrored = rows;
    for (Index i = 0; i < 60; ++i) mirrored.positions(i, axis % 3) *= -1;
    const Matrix3 reversed = Vector3(-1, 1, 1).asDiagonal();
    for (Matrix3& r : mirrored.orientations)
      if (axis == 3) r = reversed * r * reversed;
    const detail::HypothesisFit found = detail::best_hypothesis(arm, mirrored, 0.01);
    EXPECT_EQ(found.hypothesis.kind, FaultKind::mirrored_frame) << axis;
    EXPECT_EQ(found.hypothesis.convention, axis);
    EXPECT_NEAR(found.fit.residuals.position_scale, 1e-3, 0.2e-3) << axis;
    const detail::AuditRows corrected = found.hypothesis.corrected(mirrored, arm);
    for (Index i = 0; i < 60; ++i) {
      EXPECT_EQ(point(corrected.positions, i), point(rows.positions, i)) << axis << ' ' << i;
      const auto row = static_cast<std::size_t>(i);
      EXPECT_EQ(corrected.orientations[row], rows.orientations[row]) << axis << ' ' << i;
    }
  }
  detail::AuditRows points = noisy_rows(60, 3, false);
  for (Index i = 0; i < 60; ++i) points.positions(i, 2) *= -1;
  const detail::HypothesisFit found = detail::best_hypothesis(arm, points, 0.01);
  EXPECT_EQ(found.hypothesis.kind, FaultKind::mirrored_frame);
  EXPECT_NEAR(found.fit.residuals.position_scale, 1e-3, 0.2e-3);
}

// Where more than a tenth of the rows are outliers, the tails of the distribution are theirs: the limit grows to twice
// its value, 18 standard deviations, and no farther.
TEST(AuditRowsWhiteBox, ManyOutliersDoNotHideEachOther) {
  std::vector<std::pair<Index, Vector3>> shifts;
  for (Index k = 0; k < 12; ++k) shifts.push_back({5 * k, Vector3(0, 0, k % 2 == 0 ? 25e-3 : -25e-3)});
  const auto found = single_rows(noisy_rows(60, 8, false), shifts, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].rows.size(), 12u) << found[0].message;
}

// Rows from the first to the 25th whose poses lie up to three rows off; what lies before the first row has no pose.
TEST(AuditHypothesesWhiteBox, ShiftsAtTheHead) {
  const detail::AuditRows truth = noisy_rows(60, 9);
  for (const Index shift : {-3, -1, 2, 3}) {
    const Index change = 25;
    detail::AuditRows rows = truth;
    if (shift < 0)
      for (Index i = change + shift; i < change; ++i)  // poses of no row
        set_point(rows.positions, i, point(truth.positions, i) + Vector3(0.3, 0, 0));
    std::vector<Index> pose_of(60);  // of each row, -1: lost
    for (Index i = 0; i < 60; ++i) {
      const Index to = i < change ? i + shift : i;
      const bool lost = to < 0 || (i < change && to >= change);  // a later row keeps its own
      pose_of[static_cast<std::size_t>(i)] = lost ? -1 : to;
      if (lost) continue;
      set_point(rows.positions, to, point(truth.positions, i));
      rows.orientations[static_cast<std::size_t>(to)] = truth.orientations[static_cast<std::size_t>(i)];
    }
    const auto found = detail::find_shift(arm, rows, 1);
    ASSERT_TRUE(found) << shift;
    EXPECT_EQ(found->shift, shift);
    EXPECT_EQ(found->first, 0);
    EXPECT_NEAR(static_cast<double>(found->end), change, 3);
    EXPECT_NEAR(found->score, std::hypot(1e-3, 0.25 * 2e-3), 0.3e-3);
    EXPECT_GE(found->fitting.size(), 50u) << shift;
    ASSERT_EQ(found->fitting.size(), found->shifts.size());
    for (std::size_t k = 0; k < found->fitting.size(); ++k)
      EXPECT_EQ(found->fitting[k] + found->shifts[k], pose_of[static_cast<std::size_t>(found->fitting[k])]) << shift;
  }
}

}  // namespace
}  // namespace vernier::audit_rows_test
