// A fitted arm that was moved, re-mounted or drifts.

#include "vernier/registration/reregister.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/recursive_calibration.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::reregister_test {
namespace {

using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::RealMatrix;
using vernier_test::vector;
using Chain = DhChain<6>;
using Model = ErrorModel<Chain>;
using Joints = JointVector<6>;

const Robot<6> robot = robots::abb_irb120();

Isometry3 frame(const Vector6& values) { return FrameParameters(values).isometry(); }
Vector6 values(const Isometry3& frame) { return FrameParameters(frame).values(); }

const SensorModel sensors{};
const Isometry3 still = Isometry3::Identity();
const Isometry3 elsewhere = frame(Vector6{2, -3, 1.5, 1.2, -1.2, 1.06});  // turned by 2 rad
const Isometry3 other_tool = frame(Vector6{0.03, -0.02, 0.05, 0.3, -0.2, 0.25});

Joints random_zeros(Rng& rng, double size) {
  Joints out;
  for (double& x : out) x = size * rng.normal();
  return out;
}

JointRows<6> samples(Index n, std::uint64_t seed) { return sample_joints(robot.limits, n, seed); }

/// Joint errors and geometry of an arm, another one where joints 1 and 2 leave [-1.5, 1.5].
Model fitted() {
  const FrameParameters base(Vector6{0.4, -0.2, 0.1, 0.1, -0.3, 0.8}), tool(Vector6{0.05, 0.01, 0.12, 0.2, 0.4, -0.6});
  const WithJointErrors<Chain> arm(with_geometric_errors(robot.chain, {}, 1), draw_joint_errors(robot.chain, {}, 2));
  const WithJointErrors<Chain> fallback(with_geometric_errors(robot.chain, {}, 1),
                                        draw_joint_errors(robot.chain, {.harmonics = 0}, 2));
  JointCoverage<6> coverage;
  coverage.ranges[0] = coverage.ranges[1] = {{-1.5, 1.5}};
  coverage.margin.setConstant(0.5);
  return {robot.chain, Model::Arm(arm, base, tool), Model::Arm(fallback, base, tool), coverage};
}

/// No joint errors, holds everywhere.
Model rigid() {
  return {robot.chain, Model::Arm(WithJointErrors<Chain>(with_geometric_errors(robot.chain, {}, 1)), still,
                                  frame(Vector6{0.05, 0.01, 0.12, 0.2, 0.4, -0.6}))};
}

/// Largest difference of poses over the joint space [m, rad].
double difference(const Model& a, const Model& b) {
  double out = 0;
  const JointRows<6> joints = samples(50, 99);
  for (Index i = 0; i < joints.rows(); ++i) {
    const Joints q = configuration(joints, i);
    out = vernier_test::larger(out, RealMatrix(pose_difference(a.pose(q), b.pose(q))).largest());
  }
  return out;
}

/// Six elements of a column.
Vector6 six(const RealMatrix& column, Index first) {
  Vector6 out;
  for (Index k = 0; k < 6; ++k) out(k) = column(first + k);
  return out;
}

/// A model with other base, zeros and tool, all given as small values: 6, 6 and 6.
Model changed(const Model& model, const RealMatrix& by) {
  return model.moved(frame(six(by, 0)), six(by, 6), frame(six(by, 12)));
}

/// Zeros of a model's joints.
Joints zeros(const Model& model) {
  Joints out;
  for (int i = 0; i < 6; ++i) out(i) = model.identified().model().chain().row(i).theta;
  return out;
}

/// What takes one model to the other: base twist, zeros, tool twist.
RealMatrix change(const Model& from, const Model& to) {
  RealMatrix out(18, 1);
  out.set_block(0, 0, values(composed(to.identified().base(), inverse_of(from.identified().base()))));
  out.set_block(6, 0, RealMatrix(zeros(to)) - zeros(from));
  out.set_block(12, 0, values(composed(inverse_of(from.identified().tool()), to.identified().tool())));
  return out;
}

/// Rows of all changes at a pose, from models that differ.
RealMatrix effect_of_changes(const Model& model, const Joints& q) {
  RealMatrix out(6, 18);
  constexpr double size = 1e-5;
  for (Index k = 0; k < 18; ++k) {
    RealMatrix step(18, 1);
    step(k) = size;
    const RealMatrix moved = pose_difference(changed(model, step).pose(q), changed(model, -step).pose(q));
    out.set_block(0, k, moved / (2 * size));
  }
  return out;
}

/// A tool of which nothing is known.
ReregisterOptions another_tool(ReregisterOptions options = {}) {
  options.tool = true;
  options.tool_position_prior_std = options.tool_rotation_prior_std = std::numeric_limits<double>::infinity();
  return options;
}

bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

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

  // positions do not see how a tool is turned; one pose cannot tell base from tool
  EXPECT_FALSE(reregister(model, positions_at(samples(20, 14)), another_tool({.base = false})).determined);
  EXPECT_FALSE(reregister(model, measure(model, samples(1, 15)), another_tool()).determined);
  // nor the base from zeros of which nothing is known, or from how a probe is turned
  const auto open = reregister(model, measure(model, samples(1, 15)),
                               {.offsets = true, .offset_prior_std = std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(open.determined);
  EXPECT_FALSE(open.probe_turned);
  EXPECT_EQ(open.contradiction, 0);
  EXPECT_TRUE(open.remarks().empty()) << open.summary();
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

TEST(RecursiveCalibration, FollowsADriftingBase) {
  // Forgetting f weighs a pose that is k old by f^k: their mean age is f / (1 - f) = 19 poses, so a base that drifts by
  // 1 um a pose is believed to stand 19 um behind. Poses differ in what they tell, so ages differ by direction: by
  // less than a third.
  constexpr double drift = 1e-6, forgetting = 0.95, lag = drift * forgetting / (1 - forgetting);
  const Model model = fitted();
  RecursiveCalibration<Chain> poses(model, {}, {}, forgetting), positions(model, {}, {}, forgetting);
  const JointRows<6> joints = samples(400, 20);
  double mean = 0, worst_pose = 0, worst_position = 0;
  for (Index i = 0; i < 400; ++i) {
    const Joints q = configuration(joints, i);
    const Vector3 drifted = drift * static_cast<double>(i) / 3 * Vector3(2, -1, 2);
    const Isometry3 seen = composed(rigid_motion(rotation(still), drifted), model.pose(q));
    const Vector3 position = translation(seen);
    poses.update(q, seen);
    positions.update(q, position);
    if (i < 200) continue;
    const double behind = (poses.model().position(q) - position).norm();
    mean += behind / 200;
    worst_pose = vernier_test::larger(worst_pose, behind);
    worst_position = vernier_test::larger(worst_position, (positions.model().position(q) - position).norm());
  }
  EXPECT_NEAR(mean, lag, 0.1 * lag);
  EXPECT_LT(worst_pose, 1.3 * lag);
  EXPECT_LT(worst_position, 1.3 * lag);
}

TEST(RecursiveCalibration, WithoutForgettingIsLeastSquares) {
  // changes so small that the arm is linear in them, sensors as good
  constexpr double size = 2e-8;
  const ReregisterOptions options{.tool = true, .offsets = true, .offset_prior_std = size};
  const SensorModel precise{.position_sigma = 0.1 * size, .orientation_sigma = 0.3 * size};
  const Model model = rigid();
  Rng rng(21);
  RealMatrix injected(18, 1);
  for (Index k = 0; k < 18; ++k) injected(k) = size * rng.normal();
  const Model truth = changed(model, injected);
  const MeasurementNoise noise{.position = precise.position_sigma, .orientation = precise.orientation_sigma};
  const auto data = measure(truth, samples(30, 22), noise, 23);

  RealMatrix information(18, 18), gradient(18, 1);
  for (Index k = 0; k < 18; ++k) {
    const bool zero = 6 <= k && k < 12, position = k % 6 < 3;
    const double deviation = zero ? size : position ? 4 * size : 2 * size;
    information(k, k) = 1 / (deviation * deviation);
  }
  RecursiveCalibration<Chain> online(model, options, precise, 1, {4 * size, 2 * size});
  const double p = 1 / precise.position_sigma, o = 1 / precise.orientation_sigma;
  const RealMatrix weights = RealMatrix::diagonal(vector({p, p, p, o, o, o}));
  for (Index i = 0; i < data.size(); ++i) {
    const bool oriented = i % 3 != 0;  // both kinds of update
    const Index rows = oriented ? 6 : 3;
    const Vector6 error = pose_difference(data.pose(i), model.pose(data.joints(i)));
    const RealMatrix effect = (weights * effect_of_changes(model, data.joints(i))).block(0, 0, rows, 18),
                     residual = (weights * error).block(0, 0, rows, 1);
    information += effect.transpose() * effect;
    gradient += effect.transpose() * residual;
    if (oriented)
      online.update(data.joints(i), data.pose(i));
    else
      online.update(data.joints(i), data.position(i));
  }
  const RealMatrix batch = information.solve_by_cholesky(gradient);
  EXPECT_LT((change(model, online.model()) - batch).norm(), 1e-6 * batch.norm());
  EXPECT_GT((batch - injected).norm(), 1e-3 * batch.norm());  // noise is in it
  const RealMatrix covariance = information.solve_by_cholesky(RealMatrix::identity(18));
  EXPECT_LT((online.covariance() - covariance).norm(), 1e-6 * covariance.norm());
}

TEST(RecursiveCalibration, ForgetsNoMoreThanItKnewAtTheStart) {
  const Model model = fitted();
  const Joints q = configuration(samples(1, 24), 0);
  RecursiveCalibration<Chain> online(model, {.tool = true, .offsets = true}, {}, 0.98);
  const RealMatrix start = RealMatrix(online.covariance()).diagonal();
  const Vector3 position = model.position(q);
  Rng rng(25);
  for (int i = 0; i < 2000; ++i) {
    Vector3 noise;
    for (double& x : noise) x = 0.03e-3 * rng.normal();
    online.update(q, Vector3(position + noise));
    const RealMatrix p = online.covariance();
    for (Index k = 0; k < 18; ++k) ASSERT_LE(p(k, k), start(k) * (1 + 1e-12)) << i;
    ASSERT_EQ(p, p.transpose());
    if (i % 100 != 99) continue;
    ASSERT_GT(p.symmetric_eigenvalues()(0), 0) << i;
  }
  // what a single position does not tell is as little known as before
  EXPECT_GT(RealMatrix(online.covariance()).diagonal().over(start).largest(), 0.5);
}

TEST(RecursiveCalibration, DoesNotWanderWhereNothingIsExcited) {
  const Model model = rigid();
  RecursiveCalibration<Chain> online(model, {.base = true, .tool = true, .offsets = true}, {}, 0.98);
  const JointRows<6> joints = samples(50, 3);
  const Joints q = configuration(joints, 0);
  Rng rng(4);
  for (int i = 0; i < 2000; ++i) {  // an arm that stands still, seen with noise
    const Vector3 noise = 0.03e-3 * Vector3(rng.normal(), rng.normal(), rng.normal());
    online.update(q, Vector3(model.position(q) + noise));
  }
  double worst = 0;
  for (Index i = 0; i < joints.rows(); ++i) {
    const Joints other = configuration(joints, i);
    worst = vernier_test::larger(worst, (online.model().position(other) - model.position(other)).norm());
  }
  EXPECT_LT(worst, 0.3e-3);
  EXPECT_THROW(online.update(q, Vector3(0, std::numeric_limits<double>::quiet_NaN(), 0)), std::invalid_argument);
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

TEST(RecursiveCalibration, MisuseThrows) {
  const Model model = rigid();
  const auto with = [&](const ReregisterOptions& o, double forgetting, std::array<double, 2> sizes) {
    return complaint([&] { RecursiveCalibration<Chain>(model, o, {}, forgetting, sizes); });
  };
  EXPECT_TRUE(mentions(with({}, 0, {1, 1}), "forgetting is 0,"));
  EXPECT_TRUE(mentions(with({}, 1.5, {1, 1}), "forgetting is 1.5"));
  EXPECT_TRUE(mentions(with({}, std::numeric_limits<double>::quiet_NaN(), {1, 1}), "forgetting is nan"));
  EXPECT_TRUE(mentions(with({}, 1, {0, 1}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({}, 1, {1, -1}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({}, 1, {1, 0}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({.base = false}, 1, {1, 1}), "nothing is to be estimated"));
  EXPECT_EQ(with({}, 1, {1, 1}), "");
}

TEST(ReregistrationReport, OfNothingClaimsNothing) {
  const ReregistrationReport report;
  EXPECT_FALSE(report.determined || report.converged || report.probe_turned);
  for (const double value :
       {report.rms_before, report.rms_after, report.position_sigma, report.orientation_sigma, report.contradiction})
    EXPECT_EQ(value, 0);
  EXPECT_TRUE(report.remarks().empty());
}

// As much as a limit is not beyond it; powers of two, so that products are exact.
TEST(ReregistrationReport, RemarksBeginBeyondTheirLimits) {
  constexpr double small = 1.0 / 512;
  ReregistrationReport report;
  report.estimated = {.base = false, .offsets = true, .offset_prior_std = 2 * small};
  report.motion.offsets = VectorX::Zero(2);
  report.change_std = VectorX{{small, small * 1.000001}};
  EXPECT_EQ(report.remarks(), std::vector<std::string>{"The poses tell little about the zeros of joints 2: held near "
                                                       "where they were."});
  report.change_std.resize(0);  // not determined: of no joint more is known than of another
  EXPECT_TRUE(report.remarks().empty());

  report.estimated = {.base = false, .tool = true, .tool_position_prior_std = small};
  report.motion.tool = rigid_motion(rotation(still), Vector3(0, 3 * small, 0));
  EXPECT_TRUE(report.remarks().empty());
  report.motion.tool = rigid_motion(rotation(still), Vector3(0, 3.000001 * small, 0));
  EXPECT_EQ(report.remarks().size(), 1U);

  report.motion.tool = still;
  report.estimated = another_tool({.base = false});
  report.change_std = VectorX::Constant(6, 1e-3);
  EXPECT_TRUE(report.remarks().empty());
  report.change_std.setConstant(1.000001e-3);
  EXPECT_EQ(report.remarks().size(), 2U);
}

TEST(ReregistrationReport, TheLeastCertainDirectionOfAToolIsSaid) {
  for (Index axis = 0; axis < 3; ++axis) {
    ReregistrationReport report;
    report.estimated = another_tool();
    report.change_std = VectorX::Constant(12, 0.1e-3);
    report.change_std(6 + axis) = 2e-3;
    report.change_std(9 + axis) = 4e-3;
    EXPECT_EQ(report.remarks(),
              (std::vector<std::string>{"The poses determine the position of the tool to 2.0 mm only.",
                                        "The poses determine the rotation of the tool to 4.0 mrad only."}))
        << axis;
  }
}

TEST(ReregistrationReport, AToolIsFarBeyondThreeOfItsExpectedSizes) {
  ReregistrationReport report;
  report.estimated.tool = true;
  report.motion.tool = frame(Vector6{0, 8.9e-3, 0, 0, 0, 14.9e-3});
  EXPECT_TRUE(report.remarks().empty());
  report.motion.tool = frame(Vector6{0, 9.1e-3, 0, 0, 0, 15.1e-3});
  ASSERT_EQ(report.remarks().size(), 2u);
  EXPECT_TRUE(mentions(report.remarks()[0], "The tool has moved by 9.10 mm, where 3.00 are expected"));
  EXPECT_TRUE(mentions(report.remarks()[1], "The tool has turned by 15.10 mrad, where 5.00 are expected"));
}

/// A report of an arm with a revolute and a sliding joint, of which everything was estimated.
ReregistrationReport of_two_joints() {
  ReregistrationReport report;
  report.estimated = {.base = true, .tool = true, .offsets = true};
  report.joint_types = {JointType::revolute, JointType::prismatic};
  report.motion.base = frame(Vector6{1e-3, -2e-3, 3e-3, 4e-3, -5e-3, 6e-3});
  report.motion.offsets = VectorX{{0.125e-3, -0.25e-3}};
  report.motion.tool = frame(Vector6{0.5e-3, 0.25e-3, -0.75e-3, 1.5e-3, 1.25e-3, -1.75e-3});
  report.change_std.resize(14);
  for (Index k = 0; k < 14; ++k) report.change_std(k) = 0.01e-3 * static_cast<double>(k + 1);
  report.position_sigma = 0.05e-3;
  report.orientation_sigma = 0.2e-3;
  return report;
}

TEST(ReregistrationReport, SummaryByHand) {
  ReregistrationReport report = of_two_joints();
  EXPECT_EQ(report.summary(),
            "Base moved by (1.000, -2.000, 3.000) +- (0.010, 0.020, 0.030) mm, turned by (4.000, -5.000, 6.000) +- "
            "(0.040, 0.050, 0.060) mrad\n"
            "Zero of joint 1 moved by +0.1250 +- 0.0700 mrad\n"
            "Zero of joint 2 moved by -0.2500 +- 0.0800 mm\n"
            "Tool moved by (0.500, 0.250, -0.750) +- (0.090, 0.100, 0.110) mm, turned by (1.500, 1.250, -1.750) +- "
            "(0.120, 0.130, 0.140) mrad\n"
            "Weighted for residuals of 0.050 mm and 0.200 mrad a component\n");
  report.change_std.resize(0);  // not determined
  report.orientation_sigma = 0;
  report.estimated.offsets = false;
  EXPECT_EQ(report.summary(),
            "Base moved by (1.000, -2.000, 3.000) mm, turned by (4.000, -5.000, 6.000) mrad\n"
            "Tool moved by (0.500, 0.250, -0.750) mm, turned by (1.500, 1.250, -1.750) mrad\n"
            "Weighted for residuals of 0.050 mm a component\n");
  report.held = {"the position of the tool"};  // remarks end it
  EXPECT_TRUE(mentions(report.summary(),
                       "component\nThe poses do not determine the position of the tool: held where it was.\n"));
}

TEST(ReregistrationReport, AProbeThatTurnedIsSaidInNumbers) {
  ReregistrationReport report;
  report.probe_turned = true;
  report.motion.probe = Vector3(1.2e-3, 0.25e-3, -0.9e-3);
  report.probe_std = Vector3(0.1e-3, 0.2e-3, 0.3e-3);
  report.contradiction = 52.4;
  EXPECT_EQ(report.remarks(),
            std::vector<std::string>{
                "Measured orientations are turned by 1.52 mrad against the tool, (1.20, 0.25, -0.90) +- (0.10, 0.20, "
                "0.30) in its frame (statistic 52, by chance up to 16.3): was the probe remounted? The rotation is "
                "taken off the orientations; the model's tool is kept."});
}

// A zero is little known where more than half of its prior is left, wherever the zeros stand among what is estimated.
TEST(ReregistrationReport, ZerosOfWhichMoreThanHalfThePriorIsLeft) {
  for (const bool base : {false, true}) {
    ReregistrationReport report;
    report.estimated = {.base = base, .offsets = true, .offset_prior_std = 2e-3};
    report.motion.offsets = VectorX::Zero(3);
    report.change_std = VectorX::Constant(base ? 9 : 3, 5e-3);
    const Index zeros = base ? 6 : 0;
    report.change_std(zeros) = 0.9e-3;
    report.change_std(zeros + 1) = 1.1e-3;
    report.change_std(zeros + 2) = 0.95e-3;
    EXPECT_EQ(report.remarks(), std::vector<std::string>{"The poses tell little about the zeros of joints 2: held near "
                                                         "where they were."})
        << base;
  }
}

// Another tool is known to a millimetre and a milliradian, or that is said; one with a prior is known as well as that.
TEST(ReregistrationReport, AToolIsVagueBeyondAThousandthWithoutItsPrior) {
  const double infinity = std::numeric_limits<double>::infinity();
  ReregistrationReport report;
  report.estimated = {.base = false, .tool = true};
  report.change_std = VectorX::Constant(6, 1.1e-3);
  EXPECT_TRUE(report.remarks().empty());
  report.estimated.tool_position_prior_std = infinity;
  EXPECT_EQ(report.remarks(), std::vector<std::string>{"The poses determine the position of the tool to 1.1 mm only."});
  report.estimated.tool_position_prior_std = 3e-3;
  report.estimated.tool_rotation_prior_std = infinity;
  EXPECT_EQ(report.remarks(),
            std::vector<std::string>{"The poses determine the rotation of the tool to 1.1 mrad only."});
  report.change_std.setConstant(0.9e-3);
  EXPECT_TRUE(report.remarks().empty());
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
