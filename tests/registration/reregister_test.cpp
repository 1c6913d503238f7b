// SPDX-License-Identifier: BSD-3-Clause
// A fitted arm that was moved or re-mounted.

#include "vernier/registration/reregister.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "irb120_models.hpp"
#include "real_matrix.hpp"
#include "registrations.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/register_frames.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::reregister_test {
namespace {

using namespace vernier_test::irb120_models;
using vernier_test::another_tool;
using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::frame;
using vernier_test::mentions;
using vernier_test::RealMatrix;
using vernier_test::vector;
using vernier_test::irb120_models::difference;
void expect_found(const Reregistered<Chain>& found, const Model& truth) {
  EXPECT_TRUE(found.determined);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.rms_after, 1e-9);
  EXPECT_LT(difference(found.model, truth), 1e-9);
}

TEST(Reregister, FindsABaseFromThreePoses) {
  const Model model = fitted(), truth = model.moved(elsewhere, Joints::Zero(), still);
  const auto found = reregister(model, measure(truth, samples(3, 3)));
  expect_found(found, truth);
  EXPECT_GT(found.rms_before, 1);
  EXPECT_EQ(found.change_std.size(), 6);
  // one pose says it all, too; it leaves nothing over that could contradict
  const auto one = reregister(model, measure(truth, samples(1, 3)));
  expect_found(one, truth);
  EXPECT_EQ(one.contradiction, 0);
}

TEST(Reregister, FindsABaseFromSixPositions) {
  const Model model = fitted(), truth = model.moved(elsewhere, Joints::Zero(), still);
  expect_found(reregister(model, measure(truth, samples(6, 4), {.with_orientations = false})), truth);
  // orientations that are not to be used may be anything
  const auto wrong = measure(truth, samples(6, 4), {.orientation = 1}, 5);
  expect_found(reregister(model, wrong, {}, {.use_orientations = false}), truth);
  // used, they are worth as little as they are
  const auto weighted = reregister(model, wrong);
  EXPECT_LT(weighted.rms_after, 1e-7);
  EXPECT_GT(weighted.orientation_sigma, 0.3);
}

TEST(Reregister, PosesAreThoseOfTheDirectionFromWhichTheyWereApproached) {
  JointTerms terms(6);
  terms.hysteresis = {0.02};
  const Model model(robot.chain, Model::Arm({robot.chain, JointErrors(terms, VectorX::Constant(6, 3e-4))}));
  const Model truth = model.moved(elsewhere, Joints::Zero(), still);
  const JointRows<6> joints = samples(6, 3), previous = samples(6, 4);
  PointRows positions(6, 3), orientations(6, 3);
  for (Index i = 0; i < 6; ++i) {
    const Isometry3 pose = truth.approached_from(configuration(previous, i)).pose(configuration(joints, i));
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
  }
  expect_found(reregister(model, Dataset<6>(joints, positions, orientations).approached_from(previous)), truth);
}

// Orientations alone tell how a base stands where the tool turns about a point. Six of seven agree to 0.05 rad, one is
// off by 3.14: the base turns by their mean, a seventh of that, wherever the odd one lies among them.
TEST(Reregister, OneOrientationOfSevenDoesNotDecideWhereTheBaseStands) {
  const Model model(robot.chain, Model::Arm(WithJointErrors<Chain>(robot.chain)));
  for (const Index odd : {0, 6}) {
    JointRows<6> joints(7, 6);
    PointRows positions(7, 3), orientations(7, 3);
    for (Index i = 0; i < 7; ++i) {
      const Joints q(0.3, -0.4, 0.2, 0.5, 0.7, static_cast<double>(i) - 3);
      set_configuration(joints, i, q);
      const Isometry3 pose = model.pose(q);
      const double turn = i == odd ? 3.14 : i % 2 == 0 ? 0.05 : -0.05;
      const Matrix3 seen = exp_so3(Vector3(0, 0, turn)) * rotation(pose);
      set_point(positions, i, translation(pose));
      set_point(orientations, i, log_so3(seen));
    }
    const auto found = reregister(model, Dataset<6>(joints, positions, orientations), {.tool = true});
    const Vector3 turned = log_so3(rotation(found.motion.base));
    EXPECT_NEAR(turned.z(), 3.14 / 7, 0.03) << odd;
  }
}

// Frames of a model without parameters, from measurements in another place and with another tool. The prior that keeps
// offsets small moves them by less than a micrometre.
constexpr double by_prior = 1e-6;

TEST(RegisterFrames, FindsBaseAndToolOfAnyModel) {
  const FrameParameters base(elsewhere), tool(other_tool);
  const Framed<Chain> truth(robot.chain, base, tool);
  const auto measured = measure(truth, samples(8, 3));
  const Framed<Chain> found = register_frames(robot.chain, measured);
  EXPECT_LT(difference(found.base(), elsewhere), by_prior);
  EXPECT_LT(difference(found.tool(), other_tool), by_prior);
  const Framed<Chain> by_points = register_frames(robot.chain, measured.without_orientations());
  EXPECT_LT((translation(by_points.tool()) - translation(other_tool)).norm(), by_prior);
  EXPECT_LT((rotation(by_points.tool()) - Matrix3::Identity()).norm(), 1e-12);
  EXPECT_TRUE(mentions(complaint([&] { register_frames(robot.chain, measure(truth, samples(5, 3))); }),
                       "register_frames: 5 poses, needs six or more"));
}

// The flange of a SCARA turns about the vertical alone, so the height of the tool is one with that of the base.
TEST(RegisterFrames, PredictWhereTheFlangeTurnsAboutOneDirection) {
  const DhChain<2> planar({{.a = 0.3}, {.a = 0.2}});
  const Framed<DhChain<2>> truth(planar, FrameParameters(elsewhere),
                                 FrameParameters(rigid_motion(Matrix3::Identity(), Vector3(0.02, -0.01, 0.1))));
  JointRows<2> joints(9, 2), others(9, 2);
  for (Index i = 0; i < 9; ++i) {
    const auto k = static_cast<double>(i);
    set_configuration(joints, i, JointVector<2>(0.3 * k - 1, 1.5 - 0.41 * k));
    set_configuration(others, i, JointVector<2>(1.1 - 0.2 * k, 0.37 * k - 1));
  }
  const auto found = register_frames(planar, measure(truth, joints).without_orientations());
  EXPECT_LT((positions(found, others) - positions(truth, others)).cwiseAbs().maxCoeff(), by_prior);
}

TEST(Reregister, FindsATool) {
  const Model model = fitted(), truth = model.moved(still, Joints::Zero(), other_tool);
  const auto found = reregister(model, measure(truth, samples(4, 6)), another_tool({.base = false}));
  expect_found(found, truth);
  EXPECT_EQ(found.change_std.size(), 6);
  const Model turned = model.moved(still, Joints::Zero(), elsewhere);  // another tool altogether
  expect_found(reregister(model, measure(turned, samples(4, 6)), another_tool({.base = false})), turned);
}

TEST(Reregister, FindsBaseAndTool) {
  const Model model = fitted(), truth = model.moved(elsewhere, Joints::Zero(), other_tool);
  const auto found = reregister(model, measure(truth, samples(6, 7)), another_tool());
  expect_found(found, truth);
  EXPECT_EQ(found.change_std.size(), 12);
}

TEST(Reregister, FindsZerosInNoise) {
  const Model model = fitted();
  Rng rng(8);
  const Joints injected = random_zeros(rng, 0.5e-3);
  const Model truth = model.moved(still, injected, still);
  const MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.1e-3};
  const auto found = reregister(model, measure(truth, samples(40, 9), noise, 10), {.base = false, .offsets = true});
  EXPECT_TRUE(found.determined);
  EXPECT_TRUE(found.converged);
  ASSERT_EQ(found.change_std.size(), 6);
  const Joints zero_change = zeros(found.model) - zeros(model);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(std::abs(zero_change(i) - injected(i)), 3 * found.change_std(i)) << i;
    EXPECT_LT(found.change_std(i), 0.05e-3) << i;  // the data speak, not the prior
  }
  EXPECT_NEAR(found.rms_after, std::sqrt(3) * 0.03e-3, 0.01e-3);
  EXPECT_TRUE(found.estimated.offsets && !found.estimated.base);
  EXPECT_EQ(found.joint_types, std::vector<JointType>(6, JointType::revolute));
  const auto data = measure(truth, samples(40, 9), noise, 10);
  double before = 0, after = 0;
  for (Index i = 0; i < 40; ++i) {
    before += (model.position(data.joints(i)) - data.position(i)).squaredNorm() / 40;
    after += (found.model.position(data.joints(i)) - data.position(i)).squaredNorm() / 40;
  }
  EXPECT_NEAR(found.rms_before, std::sqrt(before), 1e-12);
  EXPECT_NEAR(found.rms_after, std::sqrt(after), 1e-12);
  EXPECT_GT(found.rms_before, 5 * found.rms_after);
}

TEST(Reregister, FewPosesLeaveZerosToTheirPrior) {
  const Model model = fitted();
  const auto data = measure(model.moved(still, Joints::Constant(0.1e-3), still), samples(1, 11));
  const auto found = reregister(model, data, {.base = false, .offsets = true}, {.use_orientations = false});
  EXPECT_TRUE(found.determined);  // three values for six zeros
  const double largest = RealMatrix(found.change_std).largest();
  EXPECT_GT(largest, 0.5e-3);
  EXPECT_LE(largest, 1e-3 * (1 + 1e-9));
}

TEST(Reregister, PriorsPullZerosAsMuchAsPosesDo) {
  const Model model = rigid();
  const ReregisterOptions options{.base = false, .offsets = true, .offset_prior_std = 0.1e-3};
  const auto data = measure(model.moved(still, Joints::Constant(0.5e-3), still), samples(2, 26),
                            {.position = 0.1e-3, .with_orientations = false}, 27);
  const auto found = reregister(model, data, options);
  ASSERT_TRUE(found.converged);
  const RealMatrix pull =
      (RealMatrix(zeros(found.model)) - zeros(model)) / (options.offset_prior_std * options.offset_prior_std);
  RealMatrix push(6, 1);
  for (Index i = 0; i < 2; ++i) {
    const RealMatrix effect = effect_of_changes(found.model, data.joints(i)).block(0, 6, 3, 6);
    const Vector3 error = data.position(i) - found.model.position(data.joints(i));
    push += effect.transpose() * error / (found.position_sigma * found.position_sigma);
  }
  EXPECT_GT(pull.norm(), 1e3);
  EXPECT_LT((push - pull).norm(), 1e-6 * pull.norm());
}

// Zeros beside a base, from orientations that err more than their sensor: a mean rotation of theirs is free to be as
// large as that error, and each zero is pulled from where it was. A step of least squares from the result is none.
TEST(Reregister, PriorsPullZerosBesideABaseAndOrientationsThatErr) {
  const Model model = rigid();
  const ReregisterOptions options{.offsets = true, .offset_prior_std = 0.3e-3};
  const Model truth = model.moved(elsewhere, Joints(0.3e-3, -0.4e-3, 0.5e-3, 0.4e-3, -0.6e-3, 0.8e-3), still);
  const auto data = measure(truth, samples(12, 28), {.position = 0.1e-3, .orientation = 0.8e-3}, 29);
  const auto found = reregister(model, data, options);
  ASSERT_TRUE(found.converged && !found.probe_turned);
  ASSERT_GT(found.orientation_sigma, 3 * sensors.orientation_sigma);
  const double own = std::sqrt(std::pow(found.orientation_sigma, 2) - std::pow(sensors.orientation_sigma, 2));
  const double p = 1 / found.position_sigma, o = 1 / found.orientation_sigma;
  const RealMatrix weights = RealMatrix::diagonal(vector({p, p, p, o, o, o}));
  RealMatrix information(15, 15), gradient(15, 1);
  for (Index i = 0; i < data.size(); ++i) {
    const RealMatrix all = effect_of_changes(found.model, data.joints(i));
    RealMatrix effect(6, 15);
    effect.set_block(0, 0, all.block(0, 0, 6, 12));
    effect.set_block(3, 12, all.block(3, 15, 3, 3));
    effect = weights * effect;
    const RealMatrix error = weights * RealMatrix(pose_difference(data.pose(i), found.model.pose(data.joints(i))));
    information += effect.transpose() * effect;
    gradient += effect.transpose() * error;
  }
  for (Index k = 6; k < 15; ++k) {
    const double prior = k < 12 ? options.offset_prior_std : own;
    information(k, k) += 1 / (prior * prior);
    if (k < 12) gradient(k) -= found.motion.offsets(k - 6) / (prior * prior);
  }
  const RealMatrix step = information.solve_by_cholesky(gradient);
  EXPECT_GT(RealMatrix(found.motion.offsets).largest(), 0.1e-3);
  for (Index k = 0; k < 12; ++k) EXPECT_LT(std::abs(step(k)), 1e-3 * found.change_std(k)) << k;
}

// Three values for six zeros that have priors: what is left over of them is more than nothing, and less than three.
TEST(Reregister, WeightsCountWhatTheUnknownsLeave) {
  const Model model = rigid();
  const ReregisterOptions options{.base = false, .offsets = true, .offset_prior_std = 0.5e-3};
  const Dataset<6> at = measure(model, samples(1, 26), {.with_orientations = false});
  PointRows positions = at.positions();
  set_point(positions, 0, point(positions, 0) + Vector3(0.8e-3, -0.5e-3, 0.7e-3));
  const Dataset<6> data(at.joints(), positions);
  const auto found = reregister(model, data, options, {.position_sigma = 0.3e-3});
  ASSERT_TRUE(found.converged);
  EXPECT_GT(found.position_sigma, 0.35e-3);
  const RealMatrix effect = effect_of_changes(found.model, data.joints(0)).block(0, 6, 3, 6) / found.position_sigma;
  const double precision = 1 / (options.offset_prior_std * options.offset_prior_std);
  const RealMatrix covariance = (effect.transpose() * effect + precision * RealMatrix::identity(6)).inverse();
  const double redundancy = 3 - (effect * covariance * effect.transpose()).trace();
  EXPECT_GT(redundancy, 1.1);
  EXPECT_LT(redundancy, 2.95);
  const double left = (found.model.position(data.joints(0)) - data.position(0)).squaredNorm();
  EXPECT_NEAR(left / redundancy, found.position_sigma * found.position_sigma, 5e-3 * left / redundancy);
}

TEST(Reregister, SaysWhatPosesDoNotDetermine) {
  const Model model = fitted();
  const auto positions_at = [&](const JointRows<6>& joints) {
    return measure(model, joints, {.with_orientations = false});
  };
  EXPECT_FALSE(reregister(model, positions_at(samples(1, 12))).determined);
  EXPECT_FALSE(reregister(model, positions_at(samples(2, 12))).determined);  // two points lie on a line
  EXPECT_TRUE(reregister(model, positions_at(samples(3, 12))).determined);

  JointRows<6> line = samples(5, 13);
  for (Index i = 0; i < 5; ++i) {
    Joints q = configuration(line, 0);
    const Vector3 wanted = model.position(q) + 0.01 * static_cast<double>(i) * Vector3(0.5, -0.3, 0.2);
    for (int step = 0; step < 20; ++step) {
      const RealMatrix j = RealMatrix(model.jacobian(q)).block(0, 0, 3, 6);
      const Vector3 left = wanted - model.position(q);
      q = six(q + j.transpose() * (j * j.transpose()).solve_by_cholesky(left), 0);
    }
    set_configuration(line, i, q);
  }
  const auto collinear = reregister(model, positions_at(line));
  EXPECT_FALSE(collinear.determined);
  EXPECT_FALSE(collinear.converged);
  EXPECT_TRUE(reregister(model, measure(model, line)).determined);

  // one pose cannot tell base from tool
  EXPECT_FALSE(reregister(model, measure(model, samples(1, 15)), another_tool()).determined);
  // nor the base from zeros of which nothing is known, or from how a probe is turned
  const auto open = reregister(model, measure(model, samples(1, 15)),
                               {.offsets = true, .offset_prior_std = std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(open.determined);
  EXPECT_FALSE(open.probe_turned);
  EXPECT_EQ(open.contradiction, 0);
  EXPECT_EQ(open.outside, std::vector<Index>{0});  // and nothing else is remarked upon
  EXPECT_EQ(open.remarks().size(), 1u) << open.summary();
}

// Positions see the point of another tool; how it is turned they do not see: that is held, and said.
TEST(Reregister, FindsThePointOfAnotherToolFromPositions) {
  const Model model = fitted();
  const Isometry3 tool = frame(Vector6{0.08, -0.15, 0.2, 0.4, -0.3, 1});
  for (const bool base : {true, false}) {
    const Model truth = model.moved(base ? elsewhere : still, Joints::Zero(), tool);
    const auto found =
        reregister(model, measure(truth, samples(12, 16), {.with_orientations = false}), another_tool({.base = base}));
    EXPECT_TRUE(found.determined);
    EXPECT_TRUE(found.converged);
    EXPECT_LT(found.rms_after, 1e-9);
    EXPECT_EQ(found.held, std::vector<std::string>{"the rotation of the tool"});
    const JointRows<6> fresh = samples(20, 17);
    for (Index i = 0; i < 20; ++i)
      EXPECT_LT((found.model.position(configuration(fresh, i)) - truth.position(configuration(fresh, i))).norm(), 1e-8);
    const Matrix3 turned = rotation(found.model.identified().tool()) - rotation(model.identified().tool());
    EXPECT_LT(turned.norm(), 1e-9);
  }
}

TEST(Reregister, KeepsTheBitsOfWhatMayNotMove) {
  const Model model = fitted();
  const Model truth = model.moved(elsewhere, Joints::Constant(1e-3), other_tool);
  const auto data = measure(truth, samples(20, 16));
  const auto expect_kept = [&](const Model::Arm& before, const Model::Arm& after, const ReregisterOptions& o) {
    EXPECT_EQ(after.model().joint_errors().coefficients(), before.model().joint_errors().coefficients());
    EXPECT_EQ(difference(after.base(), before.base()) == 0, !o.base);
    EXPECT_EQ(difference(after.tool(), before.tool()) == 0, !o.tool);
    const auto p = before.model().chain().parameters(), moved = after.model().chain().parameters();
    for (int k = 0; k < 30; ++k) EXPECT_EQ(moved(k) == p(k), !o.offsets || k % 5 != 3) << k;
  };
  for (int mask = 1; mask < 8; ++mask) {
    const ReregisterOptions options{.base = (mask & 1) != 0, .tool = (mask & 2) != 0, .offsets = (mask & 4) != 0};
    const Model found = reregister(model, data, options).model;
    expect_kept(model.identified(), found.identified(), options);
    expect_kept(*model.fallback(), *found.fallback(), options);
    EXPECT_EQ(found.nominal().model(), model.nominal().model());
    EXPECT_EQ(found.coverage()->ranges, model.coverage()->ranges);
    EXPECT_EQ(difference(found.coverage()->margin, model.coverage()->margin), 0);
    // the nominal arm stands where the actual one does
    EXPECT_EQ(difference(found.nominal().base(), found.identified().base()), 0);
    EXPECT_EQ(difference(found.nominal().tool(), found.identified().tool()), 0);
  }
}

TEST(Reregister, DeviationsAreThoseOfTheScatter) {
  const Model model = fitted();
  const ReregisterOptions options = another_tool({.offsets = true});
  const MeasurementNoise noise{.position = sensors.position_sigma, .orientation = sensors.orientation_sigma};
  RealMatrix squares(18, 1), std;
  constexpr int seeds = 60;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    // zeros come from their prior: it resolves joint 1 against the base and joint 6 against the tool
    Rng rng(100 + seed);
    const Model truth = model.moved(elsewhere, random_zeros(rng, options.offset_prior_std), other_tool);
    const auto found = reregister(model, measure(truth, samples(20, 17), noise, seed), options);
    ASSERT_TRUE(found.determined && found.converged);
    const RealMatrix error = change(truth, found.model);
    squares += error.times(error);
    std = found.change_std;
  }
  const RealMatrix scatter = (squares / seeds).sqrt();
  for (Index k = 0; k < 18; ++k) {
    EXPECT_LT(scatter(k), 1.3 * std(k)) << k;
    EXPECT_GT(scatter(k), std(k) / 1.3) << k;
  }
}

TEST(Reregister, MisuseThrows) {
  const Model model = rigid();
  const auto data = measure(model, samples(3, 18));
  const auto with = [&](const ReregisterOptions& o, const SensorModel& s = {}) {
    return complaint([&] { reregister(model, data, o, s); });
  };
  EXPECT_TRUE(mentions(complaint([&] { reregister(model, Dataset<6>()); }), "no samples"));
  EXPECT_TRUE(mentions(with({.base = false}), "nothing is to be estimated"));
  EXPECT_TRUE(mentions(with({}, {.position_sigma = -0.25}), "position_sigma is -0.25"));
  EXPECT_TRUE(mentions(with({}, {.orientation_sigma = 0}), "orientation_sigma is 0"));
  EXPECT_TRUE(mentions(with({.offset_prior_std = -2}), "offset_prior_std -2"));
  EXPECT_TRUE(mentions(with({.tool_position_prior_std = 0}), "tool_position_prior_std 0 must be positive"));
  EXPECT_TRUE(mentions(with({.tool_rotation_prior_std = -1}), "tool_rotation_prior_std -1 must be positive"));
  EXPECT_TRUE(mentions(with({.contradiction_threshold = 0}), "contradiction_threshold 0 must be positive"));
  EXPECT_TRUE(
      mentions(with({}, {.position_sigma = std::numeric_limits<double>::quiet_NaN()}), "position_sigma is nan"));
}

TEST(FrameUpdateWhiteBox, ColumnsAreCentralDifferences) {
  const detail::FrameUpdate all{true, true, true, 6};
  const detail::FrameUpdate probe{.base = true, .offsets = false, .tool = false, .joints = 6, .probe = true};
  const auto columns = [&](const PoseAndJacobian<6>& at) {
    return RealMatrix(all.columns(at.pose, at.jacobian.data()));
  };
  const JointRows<6> joints = samples(20, 19);
  const Model exact = rigid(), model = fitted();
  for (Index i = 0; i < 20; ++i) {
    const Joints q = configuration(joints, i);
    const PoseAndJacobian<6> at = exact.pose_and_jacobian(q);
    EXPECT_LT((columns(at) - effect_of_changes(exact, q)).norm(), 1e-8);
    // a probe turns as a tool does, and moves no position
    RealMatrix turns(6, 9);
    turns.set_block(0, 0, columns(at).block(0, 0, 6, 6));
    turns.set_block(0, 6, columns(at).block(0, 15, 6, 3));
    EXPECT_EQ(RealMatrix(probe.columns(at.pose, at.jacobian.data())), turns);
    const RealMatrix apart = columns(model.pose_and_jacobian(q)) - effect_of_changes(model, q);
    EXPECT_LT(apart.block(0, 0, 6, 6).norm(), 1e-8);
    EXPECT_LT(apart.block(0, 12, 6, 6).norm(), 1e-6);  // between arm and fallback, but for their difference
    // a zero comes after the joint errors, a joint before: their slopes lie between
    EXPECT_LT(apart.block(0, 6, 6, 6).norm(), 3e-3);
  }
}

TEST(Reregister, FindsAToolTurnedByAnyAngle) {
  const Model model = fitted();
  for (const double angle : {1.0, 2.0, 2.5, 3.0, 3.14})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Rng rng(seed);
      Vector3 axis(rng.normal(), rng.normal(), rng.normal());
      const Isometry3 tool = rigid_motion(exp_so3(Vector3(angle * axis.normalized())), Vector3(0.05, -0.02, 0.01));
      const Model there = model.moved(frame({2, -1, 0.5, 0.4, -1, 0.8}), Joints::Zero(), tool);
      const auto found = reregister(model, measure(there, samples(12, seed)), another_tool());
      EXPECT_TRUE(found.determined && found.converged) << angle << ", " << seed;
      EXPECT_LT(found.rms_after, 1e-9) << angle << ", " << seed;
    }
}

// One pose measured three times as well as a tool is expected to be remounted: a tenth of the prior's variance is left.
TEST(Reregister, PriorsOfAToolByHand) {
  const ReregisterOptions options{
      .base = false, .tool = true, .tool_position_prior_std = 3e-3, .tool_rotation_prior_std = 6e-3};
  const SensorModel coarse{.position_sigma = 1e-3, .orientation_sigma = 2e-3};
  const auto found = reregister(rigid(), measure(rigid(), samples(1, 3)), options, coarse);
  EXPECT_TRUE(found.held.empty());
  ASSERT_EQ(found.change_std.size(), 6);
  for (Index k = 0; k < 6; ++k) EXPECT_NEAR(found.change_std(k), (k < 3 ? 3e-3 : 6e-3) / std::sqrt(10.0), 1e-12) << k;
}

// Positions measured as well as expected leave half of a variance, which is more than half of a deviation: held. The
// rotation is measured three times as well.
TEST(Reregister, APositionAsGoodAsThePriorHalvesTheVariance) {
  const ReregisterOptions options{
      .base = false, .tool = true, .tool_position_prior_std = 3e-3, .tool_rotation_prior_std = 6e-3};
  const SensorModel coarse{.position_sigma = 3e-3, .orientation_sigma = 2e-3};
  const auto found = reregister(rigid(), measure(rigid(), samples(1, 3)), options, coarse);
  EXPECT_TRUE(found.determined);
  EXPECT_EQ(found.held, std::vector<std::string>{"the position of the tool"});
  ASSERT_EQ(found.change_std.size(), 6);
  for (Index k = 0; k < 6; ++k)
    EXPECT_NEAR(found.change_std(k), k < 3 ? 3e-3 / std::sqrt(2.0) : 6e-3 / std::sqrt(10.0), 1e-9) << k;
}

}  // namespace
}  // namespace vernier::reregister_test
