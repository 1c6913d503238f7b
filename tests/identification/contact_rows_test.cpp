// SPDX-License-Identifier: BSD-3-Clause
// Rows of touches: their residuals, and derivatives against finite differences.

#include <gtest/gtest.h>

#include <algorithm>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "touched_objects.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::contact_rows_test {
namespace {

using detail::CalibrationProblem;
using vernier_test::difference;
using vernier_test::lengths;
using vernier_test::RealMatrix;
using vernier_test::touched;

std::vector<Contact> every_kind() {
  VectorX faces = lengths(8, 4, 0.1), bar = lengths(6, 3, 0.15), radii = VectorX::Constant(7, 0.02);
  return {touched({ContactKind::plane, {0.35, 0, 0.3}, Vector3(0.6, 0, -0.8), 0.3}, "tilted plane", faces),
          touched({ContactKind::plane, {0.35, 0, 0.3}, Vector3(0, 0.6, 0.8), 0.3}, "other plane", faces),
          touched({ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", radii),
          touched({ContactKind::socket, {0.35, -0.1, 0.4}, Vector3::UnitZ()}, "socket", lengths(5)),
          touched({ContactKind::socket, {0.3, 0.1, 0.4}, Vector3(0.6, 0, -0.8)}, "bar", bar)};
}

/// The arm in the frame of every object.
CalibrationProblem problem_of(const std::vector<Contact>& contacts, const vernier_test::IrbArm& arm) {
  std::vector<MeasuredSet> stations;
  std::vector<ArmGeometry> arms;
  std::vector<GeometricUnknown> unknowns;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    stations.push_back(vernier_test::set_of(contacts[c], {.contact_sigma = 0.05e-3}));
    arms.push_back(detail::placed(ArmGeometry(arm), stations.back()));
    for (const Index k : detail::frame_unknowns(stations.back()))
      unknowns.push_back({k, static_cast<int>(c), 10e-3, 0});
  }
  for (Index k = 6; k < 6 + 30 + 3; ++k) unknowns.push_back({k, -1, 1e-3, 0});
  return {ArmParameterisation(std::move(arms), std::move(unknowns)), std::move(stations), Loss::squared};
}

TEST(ContactRows, StationsOfContacts) {
  const auto contacts = every_kind();
  const SensorModel sensors{.position_sigma = 1, .distance_sigma = 2, .contact_sigma = 3e-5};
  for (const Contact& contact : contacts) {
    const MeasuredSet set = vernier_test::set_of(contact, sensors);
    const bool socket = contact.kind() == ContactKind::socket;
    EXPECT_EQ(set.sigma().length, 3e-5);
    EXPECT_EQ(set.kind(), contact.kind() == ContactKind::plane  ? "plane"
                          : contact.kind() == ContactKind::ball ? "ball"
                          : contact.has_length()                ? "bar"
                                                                : "socket");
    EXPECT_EQ(set.name, "contact " + contact.name());
    EXPECT_EQ(set.values(), socket ? 3 : 1);
    EXPECT_FALSE(set.locates());
    EXPECT_EQ(difference(set.joints, contact.joints()), 0);
  }
}

TEST(ContactRows, NumberOfUnknownsAndValues) {
  const auto contacts = every_kind();
  const CalibrationProblem problem = problem_of(contacts, vernier_test::actual_arm());
  EXPECT_EQ(problem.arm.size(), 3 + 3 + 3 + 3 + 5 + 33);
  EXPECT_EQ(problem.measured_values(), 8 + 8 + 7 + 3 * 5 + 3 * 6);
}

TEST(ContactRows, TouchesOfTheRightArmLieOnTheirObjects) {
  const auto contacts = every_kind();
  const CalibrationProblem problem = problem_of(contacts, vernier_test::actual_arm());
  const detail::StackedRows rows = problem.stacked(false);
  for (Index i = 0; i < rows.residuals.size(); ++i) {
    // the closed form of a ball's centre is exact, too
    EXPECT_NEAR(rows.residuals(i) * 0.05e-3, 0, 1e-9)
        << contacts[static_cast<std::size_t>(problem.station_index(rows.block[static_cast<std::size_t>(i)]))].name();
  }
}

TEST(ContactRows, JacobianIsTheDerivativeOfTheResiduals) {
  const auto contacts = every_kind();
  CalibrationProblem problem = problem_of(contacts, vernier_test::nominal_arm());
  const RealMatrix jacobian = problem.stacked(true).jacobian;
  const ArmParameterisation at = problem.arm;
  const auto residuals = [&](Index k, double by) {
    RealMatrix step(at.size(), 1);
    step(k) = by;
    problem.arm = at;
    problem.arm.move(step);
    return RealMatrix(problem.stacked(false).residuals);
  };
  double largest = 0;
  for (Index k = 0; k < at.size(); ++k) {
    const double h = 1e-3;
    const RealMatrix slope = (residuals(k, h) - residuals(k, -h)) / (2 * h), column = jacobian.col(k);
    EXPECT_LT((slope - column).norm(), 1e-5 * (1 + column.norm())) << at.names()[static_cast<std::size_t>(k)];
    largest = std::max(largest, column.norm());
  }
  EXPECT_GT(largest, 1);
}

// Two lines of touches side by side: too narrow below a millimetre, and below a fiftieth of their length.
TEST(ContactRows, PlanesNeedTouchesAcrossAndAlong) {
  const auto said = [](double apart, double half_width) {
    MatrixX joints(20, 6);
    for (Index i = 0; i < 20; ++i) {
      const Vector3 point(0.3 + (i < 10 ? 1 : -1) * half_width, apart * (static_cast<double>(i % 10) - 4.5), 0.25);
      const Contact one = touched({ContactKind::socket, point, Vector3::UnitZ()}, "point", lengths(2), 0, 20);
      for (Index j = 0; j < 6; ++j) joints(i, j) = one.joints()(0, j);
    }
    const Contact strip("strip", ContactKind::plane, joints);
    MeasuredSet set = vernier_test::set_of(strip);
    const ArmGeometry arm = detail::placed(ArmGeometry(vernier_test::actual_arm()), set);
    return vernier_test::complaint([&] { detail::require_spread(arm, set); });
  };
  // 40 mm apart, ten touches have a deviation of 114.9 mm along their line
  EXPECT_EQ(said(0.04, 1.5e-3),
            "contact strip: all touches of the plane are along a line (1.5 mm across, 114.9 mm along), which does not "
            "determine its normal; spread them over the plane");
  EXPECT_EQ(said(0.04, 3e-3), "");
  EXPECT_NE(said(0.005, 0.7e-3), "");  // a twentieth of 14.4 mm
  EXPECT_EQ(said(0.005, 1.3e-3), "");
}

TEST(ContactRows, FramesTurnByARightAngleAtMost) {
  const auto contacts = every_kind();
  for (const Contact& contact : contacts) {
    MeasuredSet set = vernier_test::set_of(contact);
    const ArmGeometry arm = detail::placed(ArmGeometry(vernier_test::nominal_arm()), set);
    const Vector6& base = arm.base().values();
    EXPECT_LT(Vector3(base(3), base(4), base(5)).norm(), 1.6) << contact.name();
  }
}

TEST(ContactRows, TouchingJointsAreOnTheObjectAndNear) {
  const auto contacts = every_kind();
  const CalibrationProblem problem = problem_of(contacts, vernier_test::nominal_arm());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    MeasuredSet set = problem.sets()[c];
    set.joints = detail::touching_joints(problem.arm.geometry(static_cast<int>(c)), set);
    EXPECT_LT(difference(set.joints, contacts[c].joints()), 0.1) << contacts[c].name();
    const CalibrationProblem touching(ArmParameterisation({problem.arm.geometry(static_cast<int>(c))}, {}), {set},
                                      Loss::squared);
    EXPECT_LT(touching.stacked(false).residuals.norm() * 0.05e-3, 1e-12) << contacts[c].name();
  }
}

}  // namespace
}  // namespace vernier::contact_rows_test
