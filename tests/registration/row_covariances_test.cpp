// SPDX-License-Identifier: BSD-3-Clause
// Registering again from rows with covariances of their own: bad rows count little.

#include <gtest/gtest.h>

#include <vector>

#include "irb120_models.hpp"
#include "registrations.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::row_covariances_test {
namespace {

using namespace vernier_test::irb120_models;

// Every second row is a hundred times worse. Weighted by their covariances, they hardly disturb the others.
TEST(RowCovariances, WeightTheRowsOfARegistration) {
  const Model model = fitted(), truth = model.moved(elsewhere, Joints::Zero(), still);
  double weighted = 0, unweighted = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const JointRows<6> joints = samples(40, seed);
    const auto good = measure(truth, joints, {.position = 0.01e-3, .with_orientations = false}, seed),
               bad = measure(truth, joints, {.position = 1e-3, .with_orientations = false}, seed + 50);
    PointRows positions = good.positions();
    std::vector<Matrix6> covariances(40, Matrix6(Matrix6::Identity() * 1e-10));
    for (Index i = 0; i < 40; i += 2) {
      positions.row(i) = bad.positions().row(i);
      covariances[static_cast<std::size_t>(i)] *= 1e4;
    }
    const Dataset<6> mixed(joints, positions);
    const JointRows<6> fresh = samples(50, 99);
    const auto error = [&](const Dataset<6>& data) {
      const auto found = reregister(model, data);
      double sum = 0;
      for (Index i = 0; i < 50; ++i) {
        const Joints q = fresh.row(i).transpose();
        sum += (found.model.position(q) - truth.position(q)).norm() / 50;
      }
      return sum;
    };
    weighted += error(mixed.with_covariances(covariances)) / 5;
    unweighted += error(mixed) / 5;
  }
  EXPECT_LT(weighted, 0.02e-3);
  EXPECT_GT(unweighted, 5 * weighted);
}

}  // namespace
}  // namespace vernier::row_covariances_test
