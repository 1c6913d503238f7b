// Poses without an arm behind them: what a re-registration tries first, what its priors pull, what it holds.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier::closed_forms_test {
namespace {

using vernier_test::difference;
using vernier_test::random_direction;
using vernier_test::RealMatrix;

constexpr double infinity = std::numeric_limits<double>::infinity();
const Isometry3 still = Isometry3::Identity();

Isometry3 frame(const Vector3& shift, const Vector3& turn) { return rigid_motion(exp_so3(turn), shift); }

/// Poses as modelled, and how the arm stands now.
struct Truth {
  std::vector<Isometry3> modelled;
  Isometry3 base = still, tool = still;
  Vector3 probe = Vector3::Zero();
};

/// The outcome, and the motions that were tried, each unlike the one before.
struct Outcome {
  ReregistrationReport report;
  std::vector<FrameMotion> tried;
};

bool alike(const FrameMotion& a, const FrameMotion& b) {
  return difference(a.base, b.base) == 0 && difference(a.tool, b.tool) == 0 && difference(a.probe, b.probe) == 0;
}

/// Registers exact measurements.
Outcome registered(const Truth& truth, bool oriented, const ReregisterOptions& options,
                   const SensorModel& sensors = {}) {
  const auto n = static_cast<Index>(truth.modelled.size());
  constexpr int joints = 6;
  PointRows positions(n, 3);
  std::vector<Matrix3> orientations;
  for (Index i = 0; i < n; ++i) {
    const Isometry3 pose = composed(composed(truth.base, truth.modelled[static_cast<std::size_t>(i)]), truth.tool);
    set_point(positions, i, translation(pose));
    if (oriented) orientations.push_back(rotation(pose) * exp_so3(truth.probe));
  }
  const MeasuredSet station("poses", MatrixX::Zero(n, joints),
                            PoseSensor(positions, orientations, {sensors.position_sigma, sensors.orientation_sigma}));
  Outcome out;
  const auto evaluate = [&](const FrameMotion& motion, std::vector<Isometry3>& poses, MatrixX& jacobians) {
    poses.clear();
    for (const Isometry3& pose : truth.modelled) poses.push_back(composed(composed(motion.base, pose), motion.tool));
    jacobians = MatrixX::Zero(6, joints * n);
    if (out.tried.empty() || !alike(out.tried.back(), motion)) out.tried.push_back(motion);
  };
  detail::reregister(evaluate, station, options, sensors, out.report);
  return out;
}

std::vector<Isometry3> poses_anywhere(Rng& rng, int n) {
  std::vector<Isometry3> out;
  for (int i = 0; i < n; ++i)
    out.push_back(frame(random_direction(rng), rng.uniform(0, std::numbers::pi) * random_direction(rng)));
  return out;
}

// What is exact needs no iteration: by positions, and by the orientations of one pose.
TEST(ReregisterWhiteBox, TheFirstBaseTriedIsThatOfExactPoses) {
  Rng rng(1);
  for (const int n : {1, 2, 3, 8})
    for (const bool oriented : {false, true}) {
      if (n < 3 && !oriented) continue;
      const Truth truth{poses_anywhere(rng, n), frame(3 * random_direction(rng), 2 * random_direction(rng))};
      const Outcome found = registered(truth, oriented, {});
      ASSERT_GE(found.tried.size(), 2U);
      EXPECT_EQ(difference(found.tried[0].base, still), 0);
      EXPECT_LT(difference(found.tried[1].base, truth.base), 1e-13) << n;
      EXPECT_LT(found.tried[1].probe.norm(), 1e-13) << n;
      EXPECT_LT(difference(found.report.motion.base, truth.base), 1e-12) << n;
    }
}

// Base and tool at once, the tool turned by any angle: its rotation first, then the base.
TEST(ReregisterWhiteBox, TheFirstToolTriedIsTurnedAsExactPosesAre) {
  Rng rng(2);
  ReregisterOptions another{.tool = true};
  another.tool_position_prior_std = another.tool_rotation_prior_std = infinity;
  for (const int n : {3, 4, 9})
    for (int trial = 0; trial < 10; ++trial) {
      const Isometry3 tool = frame(Vector3::Zero(), rng.uniform(0, 3) * random_direction(rng));
      const Truth truth{poses_anywhere(rng, n), frame(random_direction(rng), 3 * random_direction(rng)), tool};
      const Outcome found = registered(truth, true, another);
      ASSERT_GE(found.tried.size(), 3U);
      EXPECT_EQ(difference(found.tried[1].base, still), 0);
      EXPECT_LT(difference(found.tried[1].tool, truth.tool), 1e-11) << n;
      EXPECT_LT(difference(found.tried[2].base, truth.base), 1e-11) << n;
      EXPECT_LT(difference(found.tried[2].tool, truth.tool), 1e-11) << n;
    }
}

// Orientations that put the arm somewhere else are those of a probe: the base is that of the positions, the probe what
// is left.
TEST(ReregisterWhiteBox, TheFirstProbeTriedIsThatOfExactPoses) {
  Rng rng(3);
  for (const double angle : {0.3, 1.5, 3.0}) {
    const Truth truth{poses_anywhere(rng, 9), frame(random_direction(rng), 2 * random_direction(rng)), still,
                      angle * random_direction(rng)};
    const Outcome found = registered(truth, true, {});
    ASSERT_GE(found.tried.size(), 4U);
    EXPECT_GT(difference(found.tried[1].base, truth.base), 0.01) << angle;
    EXPECT_LT(difference(found.tried[2].base, truth.base), 1e-13) << angle;
    EXPECT_LT(difference(found.tried[3].base, truth.base), 1e-13) << angle;
    EXPECT_LT(difference(found.tried[3].probe, truth.probe), 1e-12) << angle;
  }
}

// Positions fix the base; n orientations with a standard deviation s stand against one prior of 1 rad about zero, which
// takes 1 / (1 + n / s^2) of the probe's rotation away, wherever the search began.
TEST(ReregisterWhiteBox, ThePriorOfAProbeIsAboutZero) {
  Rng rng(4);
  const SensorModel coarse{.position_sigma = 1e-6, .orientation_sigma = 0.02};
  for (const double angle : {0.5, 2.5}) {
    const Truth truth{poses_anywhere(rng, 9), frame(random_direction(rng), random_direction(rng)), still,
                      angle * random_direction(rng)};
    const ReregistrationReport found = registered(truth, true, {}, coarse).report;
    ASSERT_TRUE(found.probe_turned && found.converged);
    EXPECT_EQ(found.orientation_sigma, coarse.orientation_sigma);
    const double taken = 1 / (1 + 9 / (0.02 * 0.02));
    const Vector3 pulled = truth.probe - found.motion.probe;
    EXPECT_LT((pulled - taken * truth.probe).norm(), 0.01 * taken * angle) << angle;
  }
}

// A prior of something that is not estimated has no effect; positions alone say nothing of how a tool is turned.
TEST(ReregisterWhiteBox, AToolThatIsNotEstimatedStays) {
  Rng rng(5);
  const Truth truth{poses_anywhere(rng, 6), frame(random_direction(rng), random_direction(rng))};
  const Outcome kept = registered(truth, true, {.tool = false, .tool_rotation_prior_std = infinity});
  for (const FrameMotion& motion : kept.tried) EXPECT_EQ(difference(motion.tool, still), 0);
  EXPECT_LT(difference(kept.report.motion.base, truth.base), 1e-12);
  const Outcome open = registered(truth, false, {.tool = true, .tool_rotation_prior_std = infinity});
  EXPECT_FALSE(open.report.determined);
  EXPECT_EQ(open.report.change_std.size(), 0);
}

// Poses that turn about one axis: along it a tool may move as the base does. The axis is named by hundredths, its
// largest component positive, whatever its direction.
TEST(ReregisterWhiteBox, TheAxisOfWhatIsHeldIsNamed) {
  struct Named {
    Vector3 axis;
    const char* name;
  };
  const Named axes[] = {{{0.48, 0.64, 0.6}, "(0.48, 0.64, 0.60)"},
                        {{-0.48, 0.64, 0.6}, "(-0.48, 0.64, 0.60)"},
                        {{0.48, -0.64, 0.6}, "(-0.48, 0.64, -0.60)"},
                        {{0.48, 0.64, -0.6}, "(0.48, 0.64, -0.60)"},
                        {{-0.8, 0, 0.6}, "(0.80, 0.00, -0.60)"},
                        {{0, -0.6, -0.8}, "(0.00, 0.60, 0.80)"},
                        {{0.006, -0.8, 0.6}, "(-0.01, 0.80, -0.60)"},
                        {{-0.004, 0.6, 0.8}, "(0.00, 0.60, 0.80)"},
                        {{-0.28, 0.96, 0}, "(-0.28, 0.96, 0.00)"},
                        {{0.96, -0.006, 0.28}, "(0.96, -0.01, 0.28)"},
                        {{0.46664, 0.62284, -0.627947}, "(-0.47, -0.62, 0.63)"},
                        {{0.578306, -0.569214, -0.58443}, "(-0.58, 0.57, 0.58)"},
                        {{-0.512993, 0.525448, -0.67878}, "(0.51, -0.53, 0.68)"},
                        {{0.418535, 0.588307, -0.691898}, "(-0.42, -0.59, 0.69)"}};
  Rng rng(6);
  for (const auto& [direction, name] : axes) {
    const Vector3 axis = direction.normalized();
    Truth truth;
    for (int i = 0; i < 12; ++i) truth.modelled.push_back(frame(random_direction(rng), rng.uniform(-2, 2) * axis));
    const ReregistrationReport found = registered(truth, true, {.tool = true}).report;
    EXPECT_EQ(found.held,
              std::vector<std::string>{std::string("the position of the tool along ") + name + " of its frame"});
  }
}

}  // namespace
}  // namespace vernier::closed_forms_test
