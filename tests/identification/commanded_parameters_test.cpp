// SPDX-License-Identifier: BSD-3-Clause
// Parameters that no command of a controller tells apart.
#include "vernier/identification/commanded_parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <Eigen/QR>

#include "vernier/core/rng.hpp"
#include "vernier/identification/detail/identification_plan.hpp"

namespace vernier::commanded_parameters_test {
namespace {

/// A palletiser, of which the fourth joint keeps the flange level.
const DhChain<5> palletiser{{{{.a = 0.26, .alpha = -1.5707963267948966, .d = 0.8},
                              {.a = 1.15},
                              {.a = 1.25},
                              {.a = 0.22, .alpha = -1.5707963267948966},
                              {.d = 0.25}}}};
const std::vector<std::string> law{"J1", "J2", "J3 - J2", "-J3", "J4"};

std::vector<std::string> unseen(const ControllerMap& map) {
  IdentifyOptions options;
  options.frames = Frames::base_and_tool;
  return unseen_parameters(ArmGeometry(in_frames(palletiser)), map, options);
}

TEST(UnseenParameters, NoneWithoutPassiveJoints) {
  EXPECT_TRUE(unseen({}).empty());
  EXPECT_TRUE(unseen(ControllerMap(std::vector<std::string>{"-J1", "J2", "J3 - J2", "J4", "J5"})).empty());
}

// What a held parameter does to commanded poses, the others can do as well; they are independent.
TEST(UnseenParameters, OfAPalletiserFollowOthers) {
  const std::vector<std::string> held = unseen(ControllerMap(law));
  EXPECT_NE(std::find(held.begin(), held.end(), "tool_z"), held.end());  // a level flange: the height of the base
  const ArmGeometry arm = ArmGeometry(in_frames(palletiser))
                              .with_frames(FrameParameters(Vector6{1, 2, 3, 0.4, 0.5, 0.6}),
                                           FrameParameters(Vector6{0.1, 0, 0.2, 0, 0.3, 0}));
  Rng rng(3);
  MatrixX shown(40, 4);
  for (Index k = 0; k < shown.size(); ++k) shown.data()[k] = rng.uniform(-1.5, 1.5);
  PosesAndJacobians at;
  arm.poses_and_parameter_jacobians(ControllerMap(law).to_chain(shown), at);
  const std::vector<std::string> names = arm.parameter_names();
  MatrixX seen(240, 0), all(240, 0);
  IdentifyOptions options;
  options.frames = Frames::base_and_tool;
  const detail::IdentificationPlan plan(arm, options);
  for (const Index k : plan.candidates) {
    VectorX column(240);
    for (Index i = 0; i < 40; ++i)
      for (Index r = 0; r < 6; ++r) column(6 * i + r) = at.jacobians(i, 6 * k + r);
    all.conservativeResize(240, all.cols() + 1);
    all.rightCols(1) = column;
    if (std::find(held.begin(), held.end(), names[static_cast<std::size_t>(k)]) != held.end()) continue;
    seen.conservativeResize(240, seen.cols() + 1);
    seen.rightCols(1) = column;
  }
  const auto rank = [](const MatrixX& m) {
    Eigen::ColPivHouseholderQR<MatrixX> qr(m);
    qr.setThreshold(1e-9);
    return qr.rank();
  };
  EXPECT_EQ(rank(seen), seen.cols());
  EXPECT_EQ(rank(all), seen.cols());
  EXPECT_EQ(all.cols() - seen.cols(), static_cast<Index>(held.size()));
}

}  // namespace
}  // namespace vernier::commanded_parameters_test
