// SPDX-License-Identifier: BSD-3-Clause
// Arms with parallel axes and a prismatic joint among them: found tilts make no frame observable, so none runs away.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "vernier/calibration/calibrate.hpp"
#include "vernier/compensation/compensated.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::prismatic_arms_test {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr JointType slides = JointType::prismatic;

template <int N>
struct Arm {
  DhChain<N> chain;
  JointLimits<N> limits;
};

Arm<4> scara() {
  return {DhChain<4>::from_rows(
              {{{.a = 0.325, .d = 0.4}, {.a = 0.225, .alpha = pi}, {.d = 0.1, .joint = slides}, {.d = 0.05}}}),
          {JointVector<4>(-2.27, -2.53, 0, -2 * pi), JointVector<4>(2.27, 2.53, 0.2, 2 * pi)}};
}

Arm<4> on_a_column() {
  return {DhChain<4>::from_rows(
              {{{.d = 0.2, .joint = slides}, {.a = 0.325, .d = 0.1}, {.a = 0.225, .alpha = pi}, {.d = 0.05}}}),
          {JointVector<4>(0, -2.27, -2.53, -2 * pi), JointVector<4>(0.4, 2.27, 2.53, 2 * pi)}};
}

Arm<3> planar() {
  return {DhChain<3>::from_rows({{{.a = 0.4}, {.a = 0.3}, {.a = 0.1}}}),
          {JointVector<3>(-2.27, -2.53, -pi), JointVector<3>(2.27, 2.53, pi)}};
}

/// An arm as made, its sensor and its reflector somewhere.
template <int N>
auto made(const DhChain<N>& nominal, std::uint64_t seed) {
  const auto chain = with_geometric_errors(nominal, {}, child_seed(seed, 0));
  const JointErrors errors = draw_joint_errors(chain, {.harmonics = 30, .ripple = 0.01e-3}, child_seed(seed, 1));
  Rng rng(child_seed(seed, 2));
  const auto drawn = [&](double position, double rotation) {
    Vector6 frame;
    for (int k = 0; k < 6; ++k) frame(k) = rng.uniform(-1, 1) * (k < 3 ? position : rotation);
    return FrameParameters(frame).isometry();
  };
  const Isometry3 base = drawn(3, 1.5), tool = drawn(0.1, 1);
  return Framed<WithJointErrors<DhChain<N>>>({chain, errors}, base, tool);
}

/// Root of the mean squared distance of points from the nominal arm in its best frames [m].
template <int N>
double off_nominal(const DhChain<N>& nominal, const JointRows<N>& joints, const PointRows& points) {
  const auto best = starting_frames(nominal, Dataset<N>(joints, points), true, true);
  double sum = 0;
  for (Index i = 0; i < joints.rows(); ++i)
    sum += (best.position(joints.row(i).transpose()) - points.row(i).transpose()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(joints.rows()));
}

/// What a calibration from 60 poses is worth to the arm as made, at 100 other configurations.
struct Outcome {
  double nominal;       ///< off the nominal arm in its best frames, by nominal commands (rms) [m]
  double corrected;     ///< the same by corrected commands
  double missed;        ///< from where the model puts corrected commands (rms) [m]
  double saved_frames;  ///< of the nominal arm in the saved frames from the arm as made (rms) [m]
  IdentificationReport report;
};

template <int N>
Outcome outcome(const Arm<N>& arm, std::uint64_t seed, bool oriented) {
  const auto actual = made(arm.chain, seed);
  const JointRows<N> joints = sample_joints(arm.limits, 60, seed), fresh = sample_joints(arm.limits, 100, 1000 + seed);
  const Dataset<N> data =
      measure(actual, joints, {.position = 0.03e-3, .orientation = 0.05e-3, .with_orientations = oriented}, seed);
  const auto found = calibrate(arm.chain, data, {.remainder = {.learners = {}}});
  const auto model = compensate(found.model());
  PointRows before(fresh.rows(), 3), after(fresh.rows(), 3);
  double missed = 0, saved = 0;
  for (Index i = 0; i < fresh.rows(); ++i) {
    const JointVector<N> q = fresh.row(i).transpose(), command = model.correct(q).command;
    before.row(i) = actual.position(q).transpose();
    after.row(i) = actual.position(command).transpose();
    missed += (actual.position(command) - found.model().position(command)).squaredNorm();
    saved += (actual.position(q) - found.model().nominal().position(q)).squaredNorm();
  }
  const auto n = static_cast<double>(fresh.rows());
  return {off_nominal(arm.chain, fresh, before), off_nominal(arm.chain, fresh, after), std::sqrt(missed / n),
          std::sqrt(saved / n), found.geometry};
}

template <int N>
void expect_help(const Arm<N>& arm, double corrected) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const bool oriented : {false, true}) {
      SCOPED_TRACE(message("seed ", seed, oriented ? ", poses" : ", positions"));
      const Outcome found = outcome(arm, seed, oriented);
      EXPECT_LT(found.corrected, found.nominal);
      EXPECT_LT(found.missed, 0.3e-3);
      EXPECT_LT(found.corrected, corrected);
      EXPECT_LT(found.saved_frames, 3e-3);
      EXPECT_LT(found.report.condition, 2e3);
      const auto held = found.report.names(ParameterState::not_identifiable);
      EXPECT_NE(std::find(held.begin(), held.end(), "tool_z"), held.end());
      for (const ParameterEstimate& p : found.report.parameters) EXPECT_LT(std::abs(p.identified), 4) << p.name;
    }
}

TEST(PrismaticArms, ScaraIsCorrected) { expect_help(scara(), 0.3e-3); }

TEST(PrismaticArms, ArmOnAColumnIsCorrected) { expect_help(on_a_column(), 0.3e-3); }

// Out of its plane it cannot be corrected.
TEST(PrismaticArms, PlanarArmIsCorrectedInItsPlane) { expect_help(planar(), 1e-3); }

}  // namespace
}  // namespace vernier::prismatic_arms_test
