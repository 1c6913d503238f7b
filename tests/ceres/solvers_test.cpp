// SPDX-License-Identifier: BSD-3-Clause
// The library's own solver and Ceres as the solver of an identification: one minimum, on simulated and measured arms.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "vernier/ceres.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::solvers_test {
namespace {

/// Identifies an arm by both, with priors of the same width, and compares.
template <int N>
void expect_one_minimum(const DhChain<N>& chain, const Dataset<N>& data, Loss loss) {
  const IdentifyOptions options{.frames = Frames::base_and_tool, .priors = false};
  const SensorModel sensors{.loss = loss};
  const auto by_ceres = identify(chain, data, options, sensors, ceres_solver);
  const auto by_own = identify(chain, data, options, sensors, own_solver);
  ASSERT_TRUE(by_ceres.converged()) << by_ceres.message;
  ASSERT_TRUE(by_own.converged()) << by_own.message;
  ASSERT_EQ(by_own.free, by_ceres.free);
  for (const Index k : by_own.free) {
    const ParameterEstimate &own = by_own.parameters[static_cast<std::size_t>(k)],
                            &ceres = by_ceres.parameters[static_cast<std::size_t>(k)];
    EXPECT_LT(std::abs(own.identified - ceres.identified), 1e-4 * ceres.std) << own.name;
    EXPECT_NEAR(own.std, ceres.std, 1e-2 * ceres.std) << own.name;  // of weak ones a function of their values
  }
  for (Index i = 0; i < data.size(); ++i)
    ASSERT_LT((by_own.model.position(data.joints(i)) - by_ceres.model.position(data.joints(i))).norm(), 1e-8) << i;
}

TEST(GeometrySolvers, FindOneMinimumOfSimulatedArms) {
  const auto robot = robots::ur10();
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto actual = with_geometric_errors(robot.chain, {}, seed);
    const auto data =
        measure(actual, sample_joints(robot.limits, 60, seed), {.position = 0.03e-3, .orientation = 5e-5}, seed + 10);
    for (const Loss loss : {Loss::squared, Loss::huber}) expect_one_minimum(robot.chain, data, loss);
  }
}

template <int N>
void of_measured_arm(const DhChain<N>& chain, const char* file) {
  const char* folder = std::getenv("VERNIER_DATA_DIR");
  if (folder == nullptr) GTEST_SKIP() << "VERNIER_DATA_DIR is not set";
  expect_one_minimum(chain, split_every(read_dataset<N>(std::string(folder) + "/" + file), 5).train, Loss::squared);
}
TEST(GeometrySolvers, FindOneMinimumOfTheUr10) { of_measured_arm(robots::ur10().chain, "ur10_random_poses.csv"); }
TEST(GeometrySolvers, FindOneMinimumOfTheUr5) { of_measured_arm(robots::ur5().chain, "ur5_grid.csv"); }
TEST(GeometrySolvers, FindOneMinimumOfTheWam) { of_measured_arm(robots::barrett_wam().chain, "wam_grid.csv"); }

}  // namespace
}  // namespace vernier::solvers_test
