// SPDX-License-Identifier: BSD-3-Clause
// A fitted error model: its arm where the joints were measured, its fallback elsewhere, one smooth model in between.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vernier/compensation/compensated.hpp>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/core/so3.hpp>
#include <vernier/error_model/error_model.hpp>
#include <vernier/kinematics/all_branches.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/testing/kinematic_laws.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vn = vernier;
using vernier_test::allocations;
using vernier_test::difference;
using vernier_test::keep;
using vernier_test::RealMatrix;
using vn::Index;
using vn::VectorX;

namespace error_model_test {
namespace {

static_assert(vn::KinematicModel<vn::ErrorModel<vn::DhChain<6>>>);
static_assert(vn::KinematicModel<vn::ErrorModel<vn::DhChain<1, vn::ModifiedDh>>>);
static_assert(vn::KinematicModel<vn::ErrorModel<vn::DhChain<7, vn::ModifiedDh>>>);
static_assert(!vn::ParametricModel<vn::ErrorModel<vn::DhChain<6>>>);
static_assert(std::is_same_v<vn::NominalOf<vn::ErrorModel<vn::DhChain<6>>>, vn::Framed<vn::DhChain<6>>>);

/// Two ranges a joint: [-1.5, -0.5] and [0.5, 1.5], margin 0.3.
template <int N>
vn::JointCoverage<N> coverage() {
  vn::JointCoverage<N> out;
  out.ranges.fill({{-1.5, -0.5}, {0.5, 1.5}});
  out.margin.setConstant(0.3);
  return out;
}

/// A joint value at a distance from the measured ranges; which of the four ends is up to chance.
double beyond(vn::Rng& rng, double distance) { return rng.sign() * (1 + rng.sign() * (0.5 + distance)); }

enum class Zone { inside, falling, outside };

/// Joints of a zone, clear of its borders by more than a step of the laws' differences.
template <int N>
vn::JointVector<N> joints_in(Zone zone, vn::Rng& rng) {
  vn::JointVector<N> q;
  for (int i = 0; i < N; ++i) q(i) = beyond(rng, rng.uniform(-0.49, -0.01));
  const auto several = [&](double least, double most) {  // one joint at least
    const auto sure = static_cast<int>(rng.below(N));
    for (int i = 0; i < N; ++i)
      if (i == sure || rng.uniform() < 0.3) q(i) = beyond(rng, rng.uniform(least, most));
  };
  if (zone == Zone::falling) several(0.01, 0.29);
  if (zone == Zone::outside) {
    several(0.01, 0.29);
    q(static_cast<int>(rng.below(N))) = beyond(rng, rng.uniform(0.31, 0.45));
  }
  return q;
}

template <int N>
vn::JointRows<N> rows_in(Zone zone, Index n, vn::Rng& rng) {
  vn::JointRows<N> out(n, N);
  for (Index i = 0; i < n; ++i) vn::set_configuration(out, i, joints_in<N>(zone, rng));
  return out;
}

vn::FrameParameters random_frame(vn::Rng& rng) {
  vn::Vector6 values;
  for (double& x : values) x = rng.uniform(-1, 1);
  return vn::FrameParameters(values);
}

/// Parameters that differ by a normal error.
template <class Chain>
Chain nearby(const Chain& chain, double error, vn::Rng& rng) {
  auto p = chain.parameters();
  for (double& x : p) x += error * rng.normal();
  return chain.with_parameters(p);
}

/// Arm and fallback that differ in every parameter, joint term and frame.
/// @param error of chain and joints [m, rad]
template <class Chain>
vn::ErrorModel<Chain> random_model(const Chain& nominal, double error, vn::Rng& rng) {
  const auto joint_errors = [&](const vn::JointTerms& terms) {
    VectorX beta(terms.size());
    for (double& x : beta) x = error * rng.normal();
    return vn::JointErrors(terms, beta);
  };
  vn::JointTerms few(Chain::dof);
  few.gear_ratio = few.coupling = true;
  few.gravity.emplace(nominal);
  vn::JointTerms all = few;
  all.transmission.assign(Chain::dof, vn::Fourier::up_to(3));
  using Arm = typename vn::ErrorModel<Chain>::Arm;
  const vn::FrameParameters base = random_frame(rng), tool = random_frame(rng);
  const auto moved = [&](const vn::FrameParameters& frame) {
    vn::Vector6 values = frame.values();
    for (double& x : values) x += error * rng.normal();
    return vn::FrameParameters(values);
  };
  const Arm arm(vn::WithJointErrors<Chain>(nearby(nominal, error, rng), joint_errors(all)), base, tool);
  const Arm fallback(vn::WithJointErrors<Chain>(nearby(nominal, error, rng), joint_errors(few)), moved(base),
                     moved(tool));
  return {nominal, arm, fallback, coverage<Chain::dof>()};
}

/// The rotation of one pose against another, in the base's frame.
vn::Vector3 turn(const vn::Isometry3& to, const vn::Isometry3& from) {
  return vn::log_so3(vn::rotation(vn::composed(to, vn::inverse_of(from))));
}

const vn::DhChain<6> nominal = vn::robots::abb_irb120().chain;

TEST(ErrorModel, IsItsArmWhereMeasuredAndItsFallbackElsewhere) {
  vn::Rng rng(1);
  const auto model = random_model(nominal, 0.05, rng);
  for (const Zone zone : {Zone::inside, Zone::outside})
    for (int i = 0; i < 50; ++i) {
      const auto q = joints_in<6>(zone, rng);
      const auto& arm = zone == Zone::inside ? model.identified() : *model.fallback();
      EXPECT_EQ(model.gate(q), zone == Zone::inside ? 1 : 0);
      EXPECT_EQ(difference(model.pose(q), arm.pose(q)), 0);
      EXPECT_EQ(difference(model.position(q), arm.position(q)), 0);
      EXPECT_EQ(difference(model.jacobian(q), arm.jacobian(q)), 0);
      EXPECT_GT((model.identified().position(q) - model.fallback()->position(q)).norm(), 1e-3);
    }
}

TEST(ErrorModel, GoesStraightFromOneToTheOtherBetween) {
  vn::Rng rng(3);
  const auto model = random_model(nominal, 0.05, rng);
  for (int i = 0; i < 50; ++i) {
    const auto q = joints_in<6>(Zone::falling, rng);
    const double gate = model.gate(q);
    EXPECT_EQ(gate, (*model.coverage())(q));
    ASSERT_GT(gate, 0);
    ASSERT_LT(gate, 1);
    const vn::Isometry3 pose = model.pose(q), near = model.identified().pose(q), far = model.fallback()->pose(q);
    const vn::Vector3 between = gate * vn::translation(near) + (1 - gate) * vn::translation(far);
    EXPECT_LE((vn::translation(pose) - between).norm(), 1e-14);
    // about the axis that turns one into the other, by the gate's share of the angle
    const vn::Vector3 whole = turn(near, far), part = turn(pose, far);
    EXPECT_LE((part - gate * whole).norm(), 1e-14);
  }
}

template <int N, class Convention>
void expect_laws(std::uint64_t seed) {
  vn::Rng rng(seed);
  const auto chain = vernier_test::random_chain<N, Convention>(rng);
  const auto model = random_model(chain, 0.05, rng);
  for (const Zone zone : {Zone::inside, Zone::falling, Zone::outside}) {
    const auto samples = rows_in<N>(zone, 40, rng);
    for (Index i = 0; i < samples.rows(); ++i) {
      const double gate = model.gate(vn::configuration(samples, i));
      ASSERT_EQ(gate == 1 ? Zone::inside : gate == 0 ? Zone::outside : Zone::falling, zone) << N << ": " << gate;
    }
    EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(model, samples)))
        << N << " joints, zone " << static_cast<int>(zone);
  }
}

TEST(ErrorModel, WholeTurnsFurtherAllButTheLinearTermsIsTheSame) {
  const auto robot = vn::robots::ur10();
  vn::JointTerms periodic(6);
  periodic.gravity.emplace(robot.chain, vn::Vector3(0, 0, -1));
  vn::JointTerms linear = periodic;
  linear.gear_ratio = linear.coupling = true;
  vn::Rng rng(4);
  for (vn::JointTerms* terms : {&periodic, &linear})
    for (auto& fourier : terms->transmission) fourier = vn::Fourier::up_to(9);
  for (auto& range : linear.linear_ranges = std::vector<vn::JointRange>(6)) range = {-1.5, 1.5};
  vn::VectorX beta(linear.size());
  for (double& value : beta) value = 1e-4 * rng.normal();
  auto gate = coverage<6>();
  gate.periodic.fill(true);
  const auto model = [&](const vn::JointTerms& terms, const vn::VectorX& values) {
    using Model = vn::ErrorModel<vn::DhChain<6>>;
    return Model(robot.chain, Model::Arm({robot.chain, vn::JointErrors(terms, values)}), Model::Arm(robot.chain), gate);
  };
  const Index num_linear = linear.size() - periodic.size();
  const auto without = model(periodic, RealMatrix(beta).block(num_linear, 0, periodic.size(), 1)),
             with = model(linear, beta);
  double linear_sum = 0;
  for (Index k = 0; k < num_linear; ++k) linear_sum += std::abs(beta(k));
  for (const Zone zone : {Zone::inside, Zone::falling, Zone::outside})
    for (int i = 0; i < 50; ++i) {
      const vn::JointVector<6> q = joints_in<6>(zone, rng);
      vn::JointVector<6> further = q;
      for (int j = 0; j < 6; ++j)
        further(j) += 2 * std::numbers::pi * static_cast<double>(rng.below(3)) - 2 * std::numbers::pi;
      EXPECT_NEAR(without.gate(further), without.gate(q), 1e-12);
      EXPECT_LT((RealMatrix(without.pose(further)) - without.pose(q)).norm(), 1e-12);
      EXPECT_LT((RealMatrix(without.jacobian(further)) - without.jacobian(q)).norm(), 1e-10);
      // what the linear terms do stays within what they do where they were measured
      const double change = (with.position(further) - with.position(q)).norm();
      EXPECT_LT(change, 2 * 3 * 1.5 * linear_sum);
      EXPECT_TRUE(zone != Zone::inside || difference(further, q) < 1e-12 || change > 0);
    }
}

TEST(ErrorModel, ObeysTheLawsInEveryZone) {
  expect_laws<1, vn::StandardDh>(11);
  expect_laws<3, vn::ModifiedDh>(12);
  expect_laws<6, vn::StandardDh>(13);
  expect_laws<7, vn::ModifiedDh>(14);
}

TEST(ErrorModel, WithoutCoverageHoldsEverywhere) {
  vn::Rng rng(5);
  const auto arm = random_model(nominal, 0.05, rng).identified();
  const vn::ErrorModel<vn::DhChain<6>> model(nominal, arm);
  EXPECT_EQ(model.fallback(), nullptr);
  EXPECT_EQ(model.coverage(), nullptr);
  const auto samples = vernier_test::random_joint_rows<6>(rng, 20);
  for (Index i = 0; i < samples.rows(); ++i) {
    const vn::JointVector<6> q = vn::configuration(samples, i);
    EXPECT_EQ(model.gate(q), 1);
    EXPECT_EQ(difference(model.pose(q), arm.pose(q)), 0);
  }
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(model, samples)));
}

// Nothing lies outside, and the sphere is no larger than the links: the stretched arm nearly touches it.
TEST(ErrorModel, StaysWithinItsReach) {
  vn::Rng rng(16);
  for (int arm = 0; arm < 5; ++arm) {
    const auto model = random_model(nominal, arm == 0 ? 1e-9 : 0.05, rng);
    const vn::ReachSphere sphere = model.reach_sphere();
    double farthest = 0;
    for (int i = 0; i < 4000; ++i) {
      vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
      if (i % 2 == 0) q = joints_in<6>(Zone::falling, rng);
      farthest = std::max(farthest, (model.position(q) - sphere.centre).norm());
    }
    EXPECT_LE(farthest, sphere.radius);
    EXPECT_GT(farthest, 0.6 * sphere.radius);
    if (arm > 0) continue;
    const double links = 0.29 + 0.27 + std::hypot(0.07, 0.0) + 0.302 + 0.072;
    EXPECT_NEAR(sphere.radius, links + vn::translation(model.identified().tool()).norm(), 1e-5);

    const vn::ClosedForm<6> closed_form(model.nominal());
    vn::Isometry3 target = vn::rigid_motion(vn::rotation(model.pose(vn::JointVector<6>::Zero())),
                                            sphere.centre + vn::Vector3(0, 0, sphere.radius + 1e-3));
    const auto out = vn::all_branches(closed_form, model, target);
    EXPECT_EQ(out.reach, vn::Reach::proven_out);
    EXPECT_NEAR(out.margin, 1e-3, 1e-9);
    target(2, 3) -= 2e-3;
    EXPECT_EQ(vn::all_branches(closed_form, model, target).reach, vn::Reach::not_found);
  }
}

TEST(ErrorModel, KnowsTheNominalArmInItsFrames) {
  vn::Rng rng(6);
  const auto model = random_model(nominal, 0.05, rng);
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  EXPECT_EQ(model.nominal().model(), nominal);
  EXPECT_EQ(difference(model.nominal().base(), model.identified().base()), 0);
  EXPECT_EQ(difference(model.nominal().tool(), model.identified().tool()), 0);
  EXPECT_EQ(&vn::nominal_of(model), &model.nominal());
  const RealMatrix pose = nominal.pose(q), by_hand = model.identified().base() * pose * model.identified().tool();
  EXPECT_LE((model.nominal().pose(q) - by_hand).norm(), 1e-14);
}

/// The pose of a model's arm by hand: joint values and their errors go into its chain, between base and tool.
template <class Arm, int N>
RealMatrix pose_by_hand(const Arm& arm, const vn::JointVector<N>& q, const vn::JointVector<N>& zeros) {
  const vn::JointVector<N> at = vn::JointVector<N>(arm.model().joint_errors().template effective<N>(q).joints) + zeros;
  const RealMatrix chain = arm.model().chain().pose(at), placed = RealMatrix(arm.base()) * chain;
  return placed * RealMatrix(arm.tool());
}

// Joint errors are those of the joint values that are commanded, wherever the joints have their zeros.
TEST(ErrorModel, MovedHasOtherFramesAndZeros) {
  vn::Rng rng(9);
  const vn::DhChain<3> chain{{{
      {.a = 0.3, .alpha = 1.2, .d = 0.4},
      {.a = 0.1, .alpha = -0.7, .d = 0.2, .joint = vn::JointType::prismatic},
      {.a = 0.25, .alpha = 0.4, .d = 0.1},
  }}};
  const auto model = random_model(chain, 0.02, rng);
  const vn::JointVector<3> zeros(0.1, -0.07, 0.3);
  const vn::Isometry3 base = random_frame(rng).isometry(), tool = random_frame(rng).isometry();
  const auto moved = model.moved(base, zeros, tool);
  for (const Zone zone : {Zone::inside, Zone::outside}) {
    const auto q = joints_in<3>(zone, rng);
    const bool inside = zone == Zone::inside;
    const RealMatrix before = pose_by_hand(inside ? model.identified() : *model.fallback(), q, zeros);
    const RealMatrix expected = RealMatrix(base) * before * RealMatrix(tool);
    EXPECT_LT((RealMatrix(moved.pose(q)) - expected).norm(), 1e-13);
    EXPECT_GT((RealMatrix(model.moved(base, vn::JointVector<3>::Zero(), tool).pose(q)) - expected).norm(), 0.05);
  }
}

TEST(ErrorModel, CorrectsToItsReference) {
  vn::Rng rng(7);
  const auto model = random_model(nominal, 1e-3, rng);
  const auto compensated = vn::compensate(model, {.position_tolerance = 1e-9, .rotation_tolerance = 1e-9});
  for (const Zone zone : {Zone::inside, Zone::falling, Zone::outside})
    for (int i = 0; i < 30; ++i) {
      vn::JointVector<6> q;
      do {  // clear of singularities, where a real arm need not reach where the nominal one does
        q = joints_in<6>(zone, rng);
      } while (RealMatrix(model.nominal().jacobian(q)).singular_values()(5) < 0.05);
      const auto correction = compensated.correct(q);
      ASSERT_EQ(correction.status, vn::IkStatus::converged);
      EXPECT_EQ(correction.gate, model.gate(correction.command));
      const vn::Isometry3 wanted = model.nominal().pose(q), reached = model.pose(correction.command);
      EXPECT_LE((vn::translation(reached) - vn::translation(wanted)).norm(), 1e-8);
      EXPECT_LE(turn(reached, wanted).norm(), 1e-8);
      EXPECT_GT((model.position(q) - vn::translation(wanted)).norm(), 1e-4);  // there was something to correct
    }
}

// Temperature changes arm and fallback alike.
TEST(ErrorModel, IsAsWarmOutsideAsWhereMeasured) {
  vn::Rng rng(10);
  using Model = vn::ErrorModel<vn::DhChain<6>>;
  const Model::Arm arm(nearby(nominal, 0.01, rng), random_frame(rng), random_frame(rng));
  VectorX rates(42);
  for (double& x : rates) x = 1e-4 * rng.normal();
  const vn::ThermalRates thermal{22, 10, 40, rates};
  const Model everywhere = Model(nominal, arm).with_thermal(thermal),
              gated = Model(nominal, arm, arm, coverage<6>()).with_thermal(thermal);
  for (const Zone zone : {Zone::inside, Zone::falling, Zone::outside}) {
    const auto q = joints_in<6>(zone, rng);
    const vn::Vector3 cold = everywhere.position(q), warm = everywhere.at_temperature(35).position(q);
    EXPECT_GT((warm - cold).norm(), 1e-4);
    EXPECT_LT((gated.at_temperature(35).position(q) - warm).norm(), 1e-12);
    EXPECT_EQ(difference(gated.at_temperature(50).position(q), gated.at_temperature(40).position(q)), 0);
  }
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)everywhere.with_thermal({22, 10, 40, VectorX::Zero(5)});
            }),
            "ErrorModel: 5 thermal rates of 42 parameters, all must be finite");
}

TEST(NoAllocation, ErrorModel) {
  vn::Rng rng(8);
  const auto model = random_model(nominal, 1e-3, rng);
  const auto compensated = vn::compensate(model);
  for (const Zone zone : {Zone::inside, Zone::falling, Zone::outside}) {
    const auto q = joints_in<6>(zone, rng);
    EXPECT_EQ(allocations([&] { keep(model.gate(q)); }), 0);
    EXPECT_EQ(allocations([&] { keep(model.pose(q)); }), 0);
    EXPECT_EQ(allocations([&] { keep(model.position(q)); }), 0);
    EXPECT_EQ(allocations([&] { keep(model.jacobian(q)); }), 0);
    EXPECT_EQ(allocations([&] { keep(model.pose_and_jacobian(q)); }), 0);
    EXPECT_EQ(allocations([&] { keep(compensated.correct(q)); }), 0);
  }
}

}  // namespace
}  // namespace error_model_test
