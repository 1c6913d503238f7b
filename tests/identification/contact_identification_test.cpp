// SPDX-License-Identifier: BSD-3-Clause
// Identification from touches: what is recovered, what cannot be observed, and what is refused.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "complaint.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "touched_objects.hpp"
#include "vernier/error_model/known_geometry.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/identification/object_errors.hpp"

namespace vernier::contact_identification_test {
namespace {

using vernier_test::actual_arm;
using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::IrbArm;
using vernier_test::lengths;
using vernier_test::nominal_arm;
using vernier_test::RealMatrix;
using vernier_test::three_planes;
using vernier_test::touched;
using vernier_test::variance_of_touches;

const IdentifyOptions exact{.frames = Frames::tool, .priors = false};

/// Positions of an arm at fresh joint values.
template <class Arm>
PointRows at_fresh_joints(const Arm& arm) {
  const JointRows<6> joints = sample_joints(abb_irb120_operating_region().limits, 50, 77);
  PointRows out(joints.rows(), 3);
  for (Index i = 0; i < joints.rows(); ++i) set_point(out, i, arm.position(configuration(joints, i)));
  return out;
}

/// Largest error at fresh joints, the base registered, points scaled by a factor first.
template <class Arm>
double registered_error(const Arm& arm, double factor = 1) {
  const PointRows actual = at_fresh_joints(actual_arm());
  PointRows points = at_fresh_joints(arm);
  points *= factor;
  const Isometry3 base = register_points(points, actual);
  double out = 0;
  for (Index i = 0; i < points.rows(); ++i)
    out = vernier_test::larger(out, (transformed(base, point(points, i)) - point(actual, i)).norm());
  return out;
}

double spread(const PointRows& points) { return RealMatrix(distances_from(points, centroid(points))).norm(); }

TEST(Contacts, AKnownLengthRecoversTheArmExactly) {
  const auto contacts = three_planes(true);
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_TRUE(found.scale_observable);
  EXPECT_EQ(found.missing, 0);
  EXPECT_GT(registered_error(nominal_arm()), 1e-3);
  EXPECT_LT(registered_error(found.model), 1e-8);
  EXPECT_LT(found.rms_after, 1e-10);
}

TEST(Contacts, WithoutALengthTheScaleStaysNominal) {
  const auto contacts = three_planes(false);
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_FALSE(found.scale_observable);
  EXPECT_GT(registered_error(found.model), 1e-4);
  const double factor = spread(at_fresh_joints(actual_arm())) / spread(at_fresh_joints(found.model));
  EXPECT_GT(std::abs(factor - 1), 1e-4);
  EXPECT_LT(registered_error(found.model, factor), 1e-8);
  double change = 0;  // of the lengths of the links along themselves
  for (const ParameterEstimate& p : found.parameters)
    if (p.kind == ParameterKind::length && p.name[0] != 'b' && p.name[0] != 't' &&
        p.state != ParameterState::not_identifiable)
      change += p.nominal * (p.identified - p.nominal);
  EXPECT_NEAR(change, 0, 1e-8);
}

TEST(Contacts, UnobservableDirectionsAreThoseOfTheory) {
  // Positions determine 4 R + 6 - 3 = 27 parameters of an arm of six revolute joints, six of them the base's; the
  // orientation of the tool has no effect. Of 6 base, 6 tool and 24 chain parameters 27 - 6 = 21 are left, less the
  // scale.
  for (const bool with_length : {true, false}) {
    const auto contacts = three_planes(with_length);
    const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
    EXPECT_EQ(found.singular_values.size(), 6 + 9 + 6 + 24);
    EXPECT_EQ(found.unobservable, 6 + 3 + (24 + 3 - 21) + (with_length ? 0 : 1));
    // a gap of orders of magnitude tells them from weak ones
    const Index seen = found.singular_values.size() - found.unobservable;
    EXPECT_GT(found.singular_values(seen - 1), 1e-6 * found.singular_values(0));
    EXPECT_LT(found.singular_values(seen), 1e-10 * found.singular_values(0));
    const auto unobserved = found.unobserved();
    EXPECT_NE(unobserved.front().find("base frame (6 directions)"), std::string::npos);
    EXPECT_EQ(unobserved[1].find("the scale of the arm") == 0, !with_length);
    EXPECT_EQ(found.parameters[0].state, ParameterState::not_identifiable);
    EXPECT_EQ(difference(found.model.identified().base(), nominal_arm().base()), 0);
  }
}

TEST(Contacts, BallsAndABarOfSocketsRecoverTheArm) {
  const VectorX radii = VectorX::Constant(15, 0.03);
  std::vector<Contact> contacts{
      touched({ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", radii, 0, 4),
      touched({ContactKind::ball, {0.3, -0.2, 0.4}, Vector3::UnitZ()}, "second ball", radii, 0, 5),
      touched({ContactKind::socket, {0.35, -0.1, 0.35}, Vector3(0.6, 0.8, 0)}, "bar", lengths(16, 8, 0.15), 0, 6)};
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_TRUE(found.scale_observable);
  EXPECT_LT(registered_error(found.model), 1e-7);
  // the objects are where they were, up to the base
  const double distance = (found.objects[0].point - found.objects[1].point).norm();
  EXPECT_NEAR(distance, Vector3(0.1, 0.3, -0.1).norm(), 1e-7);
  EXPECT_NEAR(found.objects[2].direction.norm(), 1, 1e-12);
}

TEST(Contacts, ObjectsAreReportedInTheFrameOfTheBase) {
  const std::vector<Contact> contacts = three_planes(true);
  const FrameParameters base(Vector6{0.5, -1, 0.2, 0.3, -0.8, 1.5});
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
  const auto moved = identify_by_contacts(
      vernier_test::IrbArm(nominal_arm().model(), base, FrameParameters(nominal_arm().tool())), contacts, exact);
  ASSERT_EQ(moved.objects.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT((moved.objects[k].point - base.isometry() * found.objects[k].point).norm(), 1e-7) << k;
    EXPECT_LT((moved.objects[k].direction - base.isometry().linear() * found.objects[k].direction).norm(), 1e-7) << k;
  }
}

TEST(Contacts, SocketsWithoutALengthDoNotDetermineTheScale) {
  const std::vector contacts{
      touched({ContactKind::socket, {0.35, -0.1, 0.35}, Vector3::UnitZ()}, "one", lengths(12), 0, 7),
      touched({ContactKind::socket, {0.3, 0.2, 0.4}, Vector3::UnitZ()}, "two", lengths(12), 0, 8)};
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
  EXPECT_FALSE(found.scale_observable);
  EXPECT_EQ(found.missing, 0) << found.summary();
}

TEST(Contacts, AJointThatSlidesIsALength) {
  std::array<DhRow, 6> rows;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i)] = robots::abb_irb120().chain.row(i);
  rows[2] = {.a = 0.1, .alpha = 1.5, .d = 0.2, .theta = 0.3, .joint = JointType::prismatic};
  const Framed<DhChain<6>> actual(DhChain<6>::from_rows(rows), {}, FrameParameters(Vector6{0.04, -0.02, 0.1, 0, 0, 0}));
  JointLimits<6> limits = abb_irb120_operating_region().limits;
  limits.lower(2) = -0.1;
  limits.upper(2) = 0.3;
  const JointVector<6> middle = (limits.lower + limits.upper) / 2, aside = 0.7 * limits.lower + 0.3 * limits.upper;
  const std::vector contacts{
      touch(actual, {ContactKind::socket, actual.position(middle), {0, 0, 1}}, "one", lengths(20), limits, 0, 1),
      touch(actual, {ContactKind::socket, actual.position(aside), {0, 0, 1}}, "two", lengths(20), limits, 0, 2)};
  EXPECT_TRUE(identify_by_contacts(actual, contacts).scale_observable);
}

TEST(Contacts, StandardDeviationsAreThoseOfTheErrors) {
  // normalised errors of the scale-free products, over several drawings of noise: those of independent touches are of
  // unit size, where touches share no error; the stated ones allow for errors that touches share, so they are larger
  double sum = 0, count = 0, with_shared = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const std::vector contacts{touched(vernier_test::table, "table", lengths(40, 20, 0.1), 0.03e-3, 3 * seed + 10),
                               touched(vernier_test::front, "front", lengths(40), 0.03e-3, 3 * seed + 11),
                               touched(vernier_test::side, "side", lengths(40), 0.03e-3, 3 * seed + 12)};
    const auto found = identify_by_contacts(nominal_arm(), contacts, exact);
    for (const char* name : {"a2", "a3", "theta3", "alpha2"})
      for (const ParameterEstimate& p : found.parameters)
        if (p.name == name) {
          const auto actual = ArmGeometry(actual_arm()).parameters();
          const Index k = &p - found.parameters.data();
          const auto free = std::find(found.free.begin(), found.free.end(), k) - found.free.begin();
          const double error = p.identified - actual(k), independent = found.independent_covariance(free, free);
          EXPECT_GT(p.std * p.std, 0.9 * independent);  // what shared errors explain is no noise
          sum += error * error / independent;
          with_shared += std::pow(error / p.std, 2);
          ++count;
        }
  }
  EXPECT_EQ(count, 48);
  EXPECT_GT(sum / count, 0.5);
  EXPECT_LT(sum / count, 1.8);
  EXPECT_GT(with_shared / count, 0.25);  // standard deviations of at most twice the errors
}

/// Covariance of estimates, symmetric, and their deviations the roots of its diagonal.
void expect_consistent_covariance(const ContactReport& found) {
  const auto p = static_cast<Index>(found.free.size());
  const RealMatrix covariance = found.covariance;
  ASSERT_EQ(covariance.rows(), p);
  EXPECT_LT(difference(covariance, covariance.transpose()), 1e-12 * covariance.largest());
  EXPECT_NEAR(found.condition * found.observability.o2, 1, 1e-9);
  for (Index i = 0; i < p; ++i) {
    const auto k = static_cast<std::size_t>(found.free[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(found.parameters[k].std, std::sqrt(covariance(i, i)), 1e-12 * found.parameters[k].std);
    for (Index j = 0; j < p; ++j)
      EXPECT_LE(covariance(i, j) * covariance(i, j), (1 + 1e-9) * covariance(i, i) * covariance(j, j));
  }
}

// Priors of the chain are as wide as its errors, in units of the expected sizes of 1 mm and 3 mrad: the common width of
// most evidence.
TEST(Contacts, PriorsAreAsWideAsTheErrors) {
  for (const double size : {0.1, 1.0}) {
    const IrbArm actual(with_geometric_errors(nominal_arm().model(),
                                              {.length_min = 0.5e-3 * size,
                                               .length_max = 1e-3 * size,
                                               .angle_min = 1e-3 * size,
                                               .angle_max = 3e-3 * size},
                                              5),
                        {}, FrameParameters(Vector6{0.043, -0.021, 0.104, 0, 0, 0}));
    const JointLimits<6> limits = abb_irb120_operating_region().limits;
    const std::vector contacts{touch(actual, vernier_test::table, "table", lengths(40, 20, 0.1), limits, 20e-6, 1),
                               touch(actual, vernier_test::front, "front", lengths(40), limits, 20e-6, 2),
                               touch(actual, vernier_test::side, "side", lengths(40), limits, 20e-6, 3)};
    const auto found = identify_by_contacts(nominal_arm(), contacts, {.frames = Frames::tool},
                                            {.contact_sigma = 20e-6, .loss = Loss::squared});
    expect_consistent_covariance(found);
    double squares = 0, count = 0, width = 0;
    const VectorX truth = ArmGeometry(actual).parameters();
    for (const Index k : found.free) {
      const ParameterEstimate& p = found.parameters[static_cast<std::size_t>(k)];
      if (p.name.starts_with("tool")) {  // 0.1 m where touches are as exact as stated
        const double variance = variance_of_touches(found, 120, 9, 20e-6);
        EXPECT_NEAR(p.prior_std, 0.1 * std::sqrt(variance), 1e-6 * p.prior_std) << p.name;
        continue;
      }
      squares += std::pow((truth(k) - p.nominal) / p.scale, 2);
      width = p.prior_std / p.scale;
      ++count;
    }
    const double ratio = width / std::sqrt(squares / count);
    EXPECT_GT(ratio, 0.4) << size;
    EXPECT_LT(ratio, 2.5) << size;
  }
}

TEST(Contacts, TooFewTouchesAreUnderdetermined) {
  const auto contacts = three_planes(true, 6, 0.03e-3);
  const auto few = identify_by_contacts(nominal_arm(), contacts);
  EXPECT_EQ(few.status, IdentifyStatus::underdetermined);
  EXPECT_EQ(few.missing, 21 - (18 - 9)) << few.summary();  // 18 touches, 9 unknowns of the planes
  EXPECT_NE(few.message.find("measured positions at the same joints would determine 12 more"), std::string::npos)
      << few.message;
  const auto as_many = three_planes(true, 10, 0.03e-3);  // 30 touches, 30 unknowns
  const auto found = identify_by_contacts(nominal_arm(), as_many);
  EXPECT_EQ(found.status, IdentifyStatus::underdetermined);
  EXPECT_EQ(found.message, "30 touches give 30 measured values for 30 unknowns of arm and objects");
  EXPECT_LT(registered_error(found.model), 2e-3);  // by its priors; nominal it is 6e-3
}

TEST(Contacts, OneHorizontalPlaneDoesNotSeeWhatMovesTheArmAlongIt) {
  const std::vector contacts{touched(vernier_test::table, "table", lengths(60, 30, 0.1), 0.03e-3)};
  const auto found = identify_by_contacts(nominal_arm(), contacts);
  // the first axis is vertical: lengths across it have no effect on heights
  EXPECT_EQ(found.names(ParameterState::weak), (std::vector<std::string>{"a1", "d3"}));
}

TEST(Contacts, RobustLossToleratesATouchThatSlipped) {
  auto contacts = three_planes(true, 24, 0.02e-3);
  MatrixX joints = contacts[1].joints();
  joints(3, 1) += 0.01;  // 4 mm
  contacts[1] = Contact("front", ContactKind::plane, joints);
  const auto squared = identify_by_contacts(nominal_arm(), contacts);
  const auto robust = identify_by_contacts(nominal_arm(), contacts, {.frames = Frames::tool}, {.loss = Loss::huber});
  EXPECT_LT(registered_error(robust.model), 0.6 * registered_error(squared.model));
}

// A tool that is known stays, however badly it fits.
TEST(Contacts, AKnownToolIsNotSought) {
  const auto contacts = three_planes(true);
  const IrbArm off(nominal_arm().model(), {}, FrameParameters(Vector6{0.1, 0.03, -0.02, 0, 0, 0}));
  const auto found = identify_by_contacts(off, contacts, {.frames = Frames::none});
  EXPECT_EQ(difference(found.model.identified().tool(), off.tool()), 0);
  EXPECT_GT(found.rms_before, 5e-3);
}

// A gauge of half a millimetre says little of the scale, but more than nothing.
TEST(Contacts, AShortLengthIsALength) {
  const std::vector contacts{touched(vernier_test::table, "table", lengths(20, 10, 0.5e-3)),
                             touched(vernier_test::front, "front", lengths(20)),
                             touched(vernier_test::side, "side", lengths(20))};
  IdentifyOptions few = exact;
  few.max_iterations = 3;
  EXPECT_TRUE(identify_by_contacts(nominal_arm(), contacts, few).scale_observable);
}

// What is left of the touches of each object, and of all of them.
TEST(Contacts, EveryObjectHasItsOwnResiduals) {
  const std::vector contacts{touched(vernier_test::table, "table", lengths(40, 20, 0.1), 0, 1),
                             touched(vernier_test::front, "front", lengths(30), 0.1e-3, 2),
                             touched(vernier_test::side, "side", lengths(20), 0, 3)};
  const auto found = identify_by_contacts(nominal_arm(), contacts, exact, {.loss = Loss::squared});
  ASSERT_EQ(found.objects.size(), 3u);
  double squares = 0, touches = 0;
  for (const TouchedObject& object : found.objects) {
    squares += static_cast<double>(object.touches) * object.rms * object.rms;
    touches += static_cast<double>(object.touches);
  }
  EXPECT_EQ(touches, 90);
  EXPECT_NEAR(found.rms_after, std::sqrt(squares / touches), 1e-12);
  EXPECT_GT(found.objects[1].rms, 1.5 * found.objects[0].rms);
  EXPECT_GT(found.objects[1].rms, 1.5 * found.objects[2].rms);
  // its normal, and a point of it: where the middle of its touches lies
  EXPECT_GT(std::abs(found.objects[0].direction.z()), 0.999);
  EXPECT_GT(std::abs(found.objects[1].direction.x()), 0.999);
  EXPECT_LT(std::abs(found.objects[0].point.x() - 0.35), 0.1);
  EXPECT_LT(std::abs(found.objects[0].point.z() - 0.25), 0.02);
  EXPECT_LT(std::abs(found.objects[1].point.x() - 0.45), 0.02);
  EXPECT_LT(std::abs(found.objects[1].point.z() - 0.4), 0.1);
}

TEST(Contacts, RefusesWhatDeterminesNothing) {
  const RealMatrix joints = three_planes(true)[0].joints();
  EXPECT_EQ(complaint([&] { identify_by_contacts(nominal_arm(), std::span<const Contact>()); }),
            "identify_by_contacts: no contacts");
  const std::vector five{Contact("p", ContactKind::plane, joints.block(0, 0, joints.rows(), 5))};
  EXPECT_EQ(complaint([&] { identify_by_contacts(nominal_arm(), five); }), "contact p: 5 joints, the arm has 6");
}

TEST(Contacts, RefusesAPlaneTouchedAlongALine) {
  // points of a line on the table, 40 mm apart
  MatrixX joints(10, 6);
  for (Index i = 0; i < 10; ++i) {
    const Vector3 point(0.3, 0.04 * static_cast<double>(i) - 0.2, 0.25);
    const Contact one = touched({ContactKind::socket, point, Vector3::UnitZ()}, "point", lengths(2), 0, 20);
    for (Index j = 0; j < 6; ++j) joints(i, j) = one.joints()(0, j);
  }
  auto contacts = three_planes(true);
  contacts[0] = Contact("table", ContactKind::plane, joints);
  const std::string text = complaint([&] { identify_by_contacts(nominal_arm(), contacts); });
  EXPECT_NE(text.find("contact table: all touches of the plane are along a line ("), std::string::npos) << text;
  EXPECT_NE(text.find("which does not determine its normal"), std::string::npos) << text;
}

TEST(Contacts, RefuseWhatTheyCannotKeepOfAnEarlierCalibration) {
  const std::vector<Contact> contacts{touched(vernier_test::front, "front", lengths(8))};
  const auto complaint_of = [&](const KnownGeometry& known) {
    return complaint([&] {
      static_cast<void>(
          identify_by_contacts(nominal_arm(), contacts, {.frames = Frames::tool}, {.loss = Loss::squared}, &known));
    });
  };
  EXPECT_EQ(complaint_of({.name = "earlier", .values = VectorX::Zero(3)}), "earlier: 3 parameters, the arm has 42");
  EXPECT_EQ(complaint_of({.name = "earlier", .values = ArmGeometry(nominal_arm()).parameters(), .parameters = {6}}),
            "earlier: a covariance of 0 parameters, 1 are known");
  JointTerms terms(6);
  terms.tilt.emplace(nominal_arm().chain());
  EXPECT_NE(complaint([&] {
              static_cast<void>(at_effective_joints(contacts, JointErrors(terms, VectorX::Ones(terms.size()))));
            }).find("has tilts of joint frames, links that bend, or guides that are not straight"),
            std::string::npos);
}

/// Touches of the three kinds of objects with lengths.
std::vector<Contact> lengthy_objects() {
  return {touched(vernier_test::table, "table", lengths(20, 10, 0.1)),
          touched({ContactKind::socket, {0.3, 0.1, 0.4}, Vector3(0.6, 0, -0.8)}, "bar", lengths(20, 10, 0.15)),
          touched({ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", VectorX::Constant(20, 0.02))};
}

TEST(ObjectErrors, OfTheArmThatTouchedAreNone) {
  for (const Contact& contact : lengthy_objects()) {
    const ObjectErrors found = object_errors(ArmGeometry(actual_arm()), contact);
    EXPECT_LT(found.rms(), 1e-9) << contact.name();
    EXPECT_LT(std::abs(found.length_error), 1e-9) << contact.name();
    for (Index i = 0; i < contact.size(); ++i)
      EXPECT_LT(
          (point(found.points, i) - actual_arm().position(JointVector<6>(contact.joints().row(i).transpose()))).norm(),
          1e-12);
  }
  EXPECT_TRUE(std::isnan(
      object_errors(ArmGeometry(actual_arm()), touched(vernier_test::front, "front", lengths(8))).length_error));
}

// A length that is said to be another one is off by that, whatever the kind of object.
TEST(ObjectErrors, MeasureTheLongestLength) {
  for (const Contact& contact : lengthy_objects()) {
    VectorX said = contact.known();
    const double longest = said.maxCoeff();
    for (double& length : said) length *= 1 + 0.1e-3 / longest;
    const Contact wrong(contact.name(), contact.kind(), contact.joints(), said);
    EXPECT_NEAR(object_errors(ArmGeometry(actual_arm()), wrong).length_error, -0.1e-3, 1e-6) << contact.name();
  }
}

// By another arm: distances are those of its points from the best plane, computed here by the eigenvector of their
// scatter.
TEST(ObjectErrors, AreDistancesFromTheBestPlane) {
  const Contact front = touched(vernier_test::front, "front", lengths(20));
  const ObjectErrors found = object_errors(ArmGeometry(nominal_arm()), front);
  PointRows points(20, 3);
  for (Index i = 0; i < 20; ++i)
    set_point(points, i, nominal_arm().position(JointVector<6>(front.joints().row(i).transpose())));
  const PointRows centred = points.rowwise() - points.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(Matrix3(centred.transpose() * centred));
  for (Index i = 0; i < 20; ++i)
    EXPECT_NEAR(found.distances(i), std::abs(centred.row(i).dot(axes.eigenvectors().col(0))), 1e-9) << i;
  EXPECT_GT(found.rms(), 1e-4);
}

}  // namespace
}  // namespace vernier::contact_identification_test
