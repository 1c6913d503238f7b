// SPDX-License-Identifier: BSD-3-Clause
// What is reported of an arm identified from touches: states and remarks of parameters, uncertainties, objects.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "real_matrix.hpp"
#include "touched_objects.hpp"
#include "vernier/identification/identify_by_contacts.hpp"

namespace vernier::contact_outcome_test {
namespace {

using namespace vernier_test;

const IdentifyOptions without_priors{.frames = Frames::tool, .priors = false};
const IdentifyOptions tool_alone{.frames = Frames::tool, .geometry = false, .priors = false};

const ParameterEstimate& named(const ContactReport& report, const std::string& name) {
  for (const ParameterEstimate& p : report.parameters)
    if (p.name == name) return p;
  ADD_FAILURE() << name;
  return report.parameters.front();
}

// The last row acts on the tool's point as its own coordinates do, the first on the arm as a whole: along its axis a
// horizontal plane moves along, about it vertical ones turn along.
TEST(ContactOutcome, WhatIsNotIdentifiableStaysAndSaysWhy) {
  const auto found = identify_by_contacts(nominal_arm(), three_planes(true), without_priors);
  for (const ParameterEstimate& p : found.parameters) {
    const bool hidden = p.state == ParameterState::not_identifiable;
    EXPECT_EQ(p.remark.empty(), !hidden) << p.name << ": " << p.remark;
    EXPECT_EQ(p.std > 0, p.state == ParameterState::identified) << p.name;
    if (p.state != ParameterState::identified) {
      EXPECT_EQ(p.identified, p.nominal) << p.name;
    }
  }
  using Remark = std::array<const char*, 2>;
  for (const auto& [name, remark] : {Remark{"base_x", "contacts are relative to the arm"},
                                     {"base_rz", "contacts are relative to the arm"},
                                     {"d1", "absorbed by the place of table"},
                                     {"theta1", "absorbed by the place of front, the place of side"},
                                     {"a6", "absorbed by tool_x"},
                                     {"alpha6", "absorbed by tool_y, tool_z"},
                                     {"d6", "absorbed by tool_z"},
                                     {"theta6", "absorbed by tool_x, tool_y"},
                                     {"tool_rx", "no effect on touches"},
                                     {"tool_ry", "no effect on touches"},
                                     {"tool_rz", "no effect on touches"}})
    EXPECT_EQ(named(found, name).remark, remark) << name;
  EXPECT_EQ(found.names(ParameterState::not_identifiable).size(), 6u + 6 + 3);
  EXPECT_EQ(found.message, "60 touches of 3 objects determine 21 parameters of the arm");
  EXPECT_EQ(found.rank, 30);
}

// At most four of the objects that absorb a parameter are named: along the first axis all five move.
TEST(ContactOutcome, NamesFourOfWhatAbsorbsAParameter) {
  std::vector contacts{touched(vernier_test::table, "table", lengths(12), 0, 1)};
  const VectorX radii = VectorX::Constant(8, 0.03);
  std::uint64_t seed = 2;
  for (const char* name : {"a", "b", "c", "d"}) {
    const Vector3 centre(0.3 + 0.03 * static_cast<double>(seed), 0.1, 0.45 - 0.04 * static_cast<double>(seed));
    contacts.push_back(touched({ContactKind::ball, centre, Vector3::UnitZ()}, name, radii, 0, seed++));
  }
  const auto found = identify_by_contacts(nominal_arm(), contacts, without_priors);
  EXPECT_EQ(named(found, "d1").remark,
            "absorbed by the place of table, the place of a, the place of b, the place of c, ...");
}

// Parameters that are dependent where axes are parallel exactly are not so in an arm as it is made, by Hayati's
// parameters and by classical ones.
TEST(ContactOutcome, WhatIsDependentAtNominalMayBeFreeAtTheSolution) {
  const DhChain<6> nominal = robots::ur10().chain;
  const IrbArm actual(with_geometric_errors(nominal, {}, 9), {}, FrameParameters(Vector6{0.06, 0.02, 0.1, 0, 0, 0}));
  JointLimits<6> limits;
  limits.lower.setConstant(-2.5);
  limits.upper.setConstant(2.5);
  const std::vector contacts{
      touch(actual, {ContactKind::plane, {0.7, 0, 0.2}, {0, 0, 1}, 0.6}, "table", lengths(30, 15, 0.2), limits, 0, 1),
      touch(actual, {ContactKind::plane, {0.8, 0, 0.4}, {1, 0, 0}, 0.6}, "front", lengths(30), limits, 0, 2),
      touch(actual, {ContactKind::plane, {0.2, 0.7, 0.4}, {0, 1, 0}, 0.6}, "side", lengths(30), limits, 0, 3)};
  for (const bool hayati : {true, false}) {
    const auto found = identify_by_contacts(IrbArm(nominal, {}, FrameParameters(Vector6{0.05, 0.02, 0.1, 0, 0, 0})),
                                            contacts, {.frames = Frames::tool, .hayati = hayati, .priors = false});
    EXPECT_TRUE(found.converged() || !hayati) << found.summary();
    EXPECT_EQ(found.missing, 0);
    EXPECT_EQ(found.free.size(), 21u);
  }
}

// Touches of an arm that is known say where objects are: of a plane its normal, up from the faces, and the point below
// the middle of the touches; of a ball the centre; of a bar its first socket and where it points.
TEST(ContactOutcome, ObjectsTouchedByAKnownArm) {
  const IrbArm arm = nominal_arm();
  const JointLimits<6> limits = abb_irb120_operating_region().limits;
  const Vector3 down(0.6, 0, -0.8), along(0, -0.6, -0.8);
  const std::vector contacts{
      touch(arm, {ContactKind::plane, {0.35, 0, 0.3}, down, 0.3}, "lid", lengths(12, 6, 0.05), limits, 0, 1),
      touch(arm, {ContactKind::plane, {0.35, 0, 0.25}, Vector3::UnitZ(), 0.3}, "table", lengths(9, 4, 0.1), limits, 0,
            2),
      touch(arm, {ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", VectorX::Constant(7, 0.02), limits, 0,
            3),
      touch(arm, {ContactKind::socket, {0.35, -0.1, 0.4}, Vector3::UnitZ()}, "socket", lengths(5), limits, 0, 4),
      touch(arm, {ContactKind::socket, {0.3, 0.1, 0.45}, along}, "bar", lengths(6, 3, 0.15), limits, 0, 5)};
  const auto found = identify_by_contacts(arm, contacts, {.geometry = false});
  ASSERT_EQ(found.objects.size(), 5u);
  const auto foot = [&](std::size_t k, const Vector3& on_plane, const Vector3& normal) {
    Vector3 middle = Vector3::Zero();
    const Contact& contact = contacts[k];
    for (Index i = 0; i < contact.size(); ++i) {
      JointVector<6> q;
      for (Index j = 0; j < 6; ++j) q(j) = contact.joints()(i, j);
      middle += arm.position(q) / static_cast<double>(contact.size());
    }
    return Vector3(middle - normal.dot(middle - on_plane) * normal);
  };
  const std::array<Vector3, 5> points{foot(0, {0.35, 0, 0.3}, down), foot(1, {0.35, 0, 0.25}, Vector3::UnitZ()),
                                      Vector3(0.4, 0.1, 0.3), Vector3(0.35, -0.1, 0.4), Vector3(0.3, 0.1, 0.45)};
  const std::array<Vector3, 5> directions{down, Vector3::UnitZ(), Vector3::Zero(), Vector3::Zero(), along};
  for (std::size_t k = 0; k < 5; ++k) {
    const TouchedObject& object = found.objects[k];
    EXPECT_LT((object.point - points[k]).norm(), 1e-8) << object.name;
    EXPECT_LT((object.direction - directions[k]).norm(), 1e-8) << object.name;
    EXPECT_EQ(object.touches, contacts[k].size());
    EXPECT_EQ(object.name, contacts[k].name());
    EXPECT_EQ(object.kind, contacts[k].kind());
    EXPECT_LT(object.rms, 1e-10) << object.name;
  }
}

// Of a tool that is off nothing is left once it is registered, with links as they are.
TEST(ContactOutcome, ErrorsBeforeAreThoseOfNominalLinksWithTheirTool) {
  const JointLimits<6> limits = abb_irb120_operating_region().limits;
  const IrbArm start = nominal_arm();
  const IrbArm actual(start.model(), {}, FrameParameters(Vector6{0.045, -0.023, 0.104, 0, 0, 0}));
  const std::vector contacts{touch(actual, vernier_test::table, "table", lengths(20, 10, 0.1), limits, 0, 1),
                             touch(actual, vernier_test::front, "front", lengths(20), limits, 0, 2)};
  EXPECT_LT(identify_by_contacts(start, contacts, tool_alone).rms_before, 1e-10);
  EXPECT_GT(identify_by_contacts(start, contacts, {.geometry = false}).rms_before, 0.5e-3);
}

// A step of Gauss-Newton does not bring a tool back that is off by a decimetre or two; points around it are tried, too.
TEST(ContactOutcome, AToolThatDoesNotFitIsSoughtAroundWhereItShouldBe) {
  const JointLimits<6> limits = abb_irb120_operating_region().limits;
  const Vector6 actual{0.043, -0.021, 0.104, 0, 0, 0};
  const IrbArm arm(nominal_arm().model(), {}, FrameParameters(actual));
  const VectorX radii = VectorX::Constant(12, 0.03);
  const std::vector contacts{
      touch(arm, {ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", radii, limits, 0, 4),
      touch(arm, {ContactKind::ball, {0.3, -0.2, 0.4}, Vector3::UnitZ()}, "other", radii, limits, 0, 5)};
  IdentifyOptions one_step = tool_alone;
  one_step.max_iterations = 1;
  for (const double off : {-0.2, -0.1, 0.1, 0.2})
    for (Index axis = 0; axis < 3; ++axis) {
      Vector6 start = actual;
      start(axis) += off;
      for (Index k = 0; k < 3; ++k) start(k) += 1e-3;  // found by the step from there
      const auto found = identify_by_contacts(IrbArm(arm.model(), {}, FrameParameters(start)), contacts, one_step);
      EXPECT_LT(found.rms_before, 0.25e-3) << axis << ", " << off;
    }
}

/// Estimated lengths of links, nominal, in the order of the covariance; zero for others.
RealMatrix links_of(const ContactReport& report) {
  RealMatrix out(static_cast<Index>(report.free.size()), 1);
  for (Index k = 0; k < out.rows(); ++k) {
    const Index parameter = report.free[static_cast<std::size_t>(k)];
    const ParameterEstimate& p = report.parameters[static_cast<std::size_t>(parameter)];
    if (parameter >= 6 && parameter < 36 && p.kind == ParameterKind::length) out(k) = p.nominal;
  }
  return out;
}

// Touches without a known length say nothing of the scale, so it has the uncertainty by which it is held: a millionth
// of the links' lengths taken together, of unit variance that is scaled as that of the touches. It adds one to the
// degrees of freedom.
TEST(ContactOutcome, AScaleThatIsNotObservedIsKnownAsItIsHeld) {
  const double sigma = 0.03e-3, size = 1e-3;  // of a length
  const auto found = identify_by_contacts(nominal_arm(), three_planes(false, 20, sigma), without_priors);
  ASSERT_FALSE(found.scale_observable);
  ASSERT_EQ(found.free.size(), 21u);
  const double variance = std::pow(found.rms_after / sigma, 2) * 60 / (60 - 30 + 1);
  const RealMatrix links = links_of(found);
  const double held = 1e-6 * links.squared_norm() / size * std::sqrt(variance) * size / size;
  const double deviation = std::sqrt(links.dot(RealMatrix(found.independent_covariance) * links)) / size;
  EXPECT_NEAR(deviation, held, 1e-3 * held);
  for (const Index k : found.free) {
    const ParameterEstimate& p = found.parameters[static_cast<std::size_t>(k)];
    EXPECT_GT(p.std, 1e-6) << p.name;
    EXPECT_LT(p.std, 20e-3) << p.name;
  }
}

// A prior that holds the scale counts as a measured value.
TEST(ContactOutcome, OneTouchMoreThanUnknownsWithTheScaleHeld) {
  const auto planes = [](Index of_table) {
    return std::vector{touched(vernier_test::table, "table", lengths(of_table), 0.03e-3, 1),
                       touched(vernier_test::front, "front", lengths(10), 0.03e-3, 2),
                       touched(vernier_test::side, "side", lengths(10), 0.03e-3, 3)};
  };
  const auto enough = planes(10), few = planes(9);
  const auto found = identify_by_contacts(nominal_arm(), enough);
  EXPECT_EQ(found.missing, 0);
  EXPECT_EQ(found.status, IdentifyStatus::converged) << found.message;
  const auto less = identify_by_contacts(nominal_arm(), few);
  EXPECT_EQ(less.status, IdentifyStatus::underdetermined);
  EXPECT_EQ(less.message, "29 touches give 29 measured values for 30 unknowns of arm and objects");
}

TEST(ContactOutcome, StepsThatDoNotVanishAreReported) {
  IdentifyOptions one_step = without_priors;
  one_step.max_iterations = 1;
  const std::vector contacts = three_planes(true);
  const IrbArm start(nominal_arm().model(), {}, FrameParameters(Vector6{0.03, -0.01, 0.11, 0, 0, 0}));
  IdentifyOptions of_tool = one_step;
  of_tool.geometry = false;
  const auto found = identify_by_contacts(start, contacts, of_tool);
  EXPECT_EQ(found.status, IdentifyStatus::not_converged);
  EXPECT_EQ(found.message, "the steps did not vanish within 1 iterations");
}

// As many touches as unknowns leave nothing over, so uncertainties are those of the sensor as stated.
TEST(ContactOutcome, WithoutRedundancyTheSensorIsBelieved) {
  const auto contacts = three_planes(true, 10);
  const auto stated = identify_by_contacts(nominal_arm(), contacts, without_priors,
                                           {.contact_sigma = 20e-6, .loss = Loss::squared}),
             twice = identify_by_contacts(nominal_arm(), contacts, without_priors,
                                          {.contact_sigma = 40e-6, .loss = Loss::squared});
  ASSERT_EQ(stated.free.size(), 21u);
  for (const Index k : stated.free) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_GT(stated.parameters[at].std, 1e-6) << stated.parameters[at].name;
    EXPECT_NEAR(twice.parameters[at].std, 2 * stated.parameters[at].std, 1e-4 * stated.parameters[at].std);
  }
}

// Errors hundreds of times as large as expected: priors widen to ten expected sizes, and no further.
TEST(ContactOutcome, PriorsAreTenExpectedSizesAtMost) {
  const double sigma = 0.03e-3;
  const auto found = identify_by_contacts(
      nominal_arm(), three_planes(true, 40, sigma),
      {.frames = Frames::tool, .length_prior_std = 1e-6, .angle_prior_std = 1e-6, .joint_zero_prior_std = 1e-6});
  const double variance = variance_of_touches(found, 120, 9, sigma);
  Index chain = 0;
  for (const Index k : found.free) {
    const ParameterEstimate& p = found.parameters[static_cast<std::size_t>(k)];
    if (p.name.starts_with("tool")) continue;
    EXPECT_NEAR(p.prior_std, 10 * p.scale * std::sqrt(variance), 1e-6 * p.prior_std) << p.name;
    ++chain;
  }
  EXPECT_EQ(chain, 18);
}

}  // namespace
}  // namespace vernier::contact_outcome_test
