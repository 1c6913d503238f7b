// SPDX-License-Identifier: BSD-3-Clause
// Informants by hand; the ball from which a particle's next place is drawn, and its confinement.

#include "vernier/search/spso2011.hpp"

#include <gtest/gtest.h>

namespace vernier::spso2011_test {
namespace {

const auto evaluate_bowl = [](const MatrixX& population, VectorX& fitness) {
  fitness = population.colwise().squaredNorm().transpose();
};

// 0 informs 1 and 2, 1 informs 3 twice, 2 informs 0 and itself, 3 informs nobody but 3.
TEST(Spso2011, InformantsByHand) {
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic> links(2, 4);
  links << 1, 3, 0, 3,  //
      2, 3, 2, 3;
  EXPECT_EQ(Spso2011::best_informants(Eigen::Vector4d(1, 2, 3, 4), links), (std::vector<Index>{0, 0, 0, 1}));
  EXPECT_EQ(Spso2011::best_informants(Eigen::Vector4d(4, 3, 2, 1), links), (std::vector<Index>{2, 1, 2, 3}));
  EXPECT_EQ(Spso2011::best_informants(Eigen::Vector4d(2, 2, 2, 2), links), (std::vector<Index>{0, 1, 2, 3}));
}

TEST(Spso2011, Constants) {
  EXPECT_NEAR(Spso2011{}.inertia, 0.7213475204444817, 1e-15);
  EXPECT_NEAR(Spso2011{}.acceleration, 1.1931471805599454, 1e-15);
}

/// A particle at (1, 2) that remembers (3, 2) and, if it has a leader, is told of (1, 5); its velocity is (10, -20).
Spso2011::State two_particles(std::uint64_t seed, bool led) {
  Spso2011::State s;
  s.rng = Rng(seed);
  s.positions = (MatrixX(2, 2) << 1, 7, 2, 7).finished();
  s.velocities = (MatrixX(2, 2) << 10, 0, -20, 0).finished();
  s.best_positions = (MatrixX(2, 2) << 3, 1, 2, 5).finished();
  s.fitness = s.best_values = Eigen::Vector2d(2, led ? 1 : 3);
  s.best = Eigen::Vector2d(0, 0);
  s.best_fitness = -1;
  s.links.resize(1, 2);
  s.links << 1, 0;
  return s;
}

// What is added to w v is a point of the ball about c ((p - x) + (l - x)) / 3, or c (p - x) / 2 without a better
// informant, that passes through x: in the mean its centre, the radius uniform, all directions alike.
TEST(Spso2011, DrawsFromTheBall) {
  const Box box = Box::cube(2, -1e6, 1e6);
  const double c = Spso2011{}.acceleration, w = Spso2011{}.inertia;
  for (const bool led : {true, false}) {
    const Eigen::Vector2d centre = led ? Eigen::Vector2d(2 * c / 3, 3 * c / 3) : Eigen::Vector2d(2 * c / 2, 0);
    const double radius = centre.norm();
    constexpr int draws = 20000;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    double sum_of_radii = 0, farthest = 0;
    for (int i = 0; i < draws; ++i) {
      Spso2011::State s = two_particles(static_cast<std::uint64_t>(i), led);
      Spso2011{}.step(s, box, evaluate_bowl);
      const Eigen::Vector2d moved = s.velocities.col(0) - w * Eigen::Vector2d(10, -20);
      ASSERT_LT((s.positions.col(0) - Eigen::Vector2d(1, 2) - s.velocities.col(0)).norm(), 1e-9);
      const Eigen::Vector2d from_centre = (moved - centre) / radius;
      sum += from_centre;
      second += from_centre * from_centre.transpose();
      sum_of_radii += from_centre.norm();
      farthest = std::max(farthest, from_centre.norm());
    }
    // radius uniform: mean 1/2 (sd 0.289), mean square 1/3, so 1/6 in each coordinate; sd of the means below 0.003
    EXPECT_LE(farthest, 1 + 1e-12);
    EXPECT_GT(farthest, 0.999);
    EXPECT_NEAR(sum_of_radii / draws, 0.5, 4 * 0.289 / std::sqrt(draws));
    EXPECT_LT((sum / draws).cwiseAbs().maxCoeff(), 4 * 0.409 / std::sqrt(draws));
    EXPECT_LT((second / draws - Eigen::Matrix2d::Identity() / 6).cwiseAbs().maxCoeff(), 0.007);
  }
}

// Far over the bound: the particle stops there with half its velocity turned back.
TEST(Spso2011, ConfinementByHand) {
  const Box box = Box::cube(2, -8, 8);
  Spso2011::State s = two_particles(1, true), free = s;
  Spso2011{}.step(free, Box::cube(2, -1e6, 1e6), evaluate_bowl);
  Spso2011{}.step(s, box, evaluate_bowl);
  ASSERT_LT(free.positions(1, 0), -8);
  EXPECT_EQ(s.positions(1, 0), -8);
  EXPECT_EQ(s.velocities(1, 0), -0.5 * free.velocities(1, 0));
}

// Links are drawn anew after a step that bettered nothing, and kept after one that did.
TEST(Spso2011, LinksChangeWhereNothingIsBettered) {
  const Box box = Box::cube(3, -1, 1);
  Spso2011::State s = Spso2011{}.start(box, 3, evaluate_bowl);
  EXPECT_EQ(s.links.size(), 0);
  int kept = 0, dropped = 0;
  while (s.generation < 60) {
    const auto before = s.links;
    const double best = s.best_fitness;
    Spso2011{}.step(s, box, evaluate_bowl);
    if (s.best_fitness < best) {
      ++kept;
      ASSERT_EQ(s.links.rows(), 3);
      ASSERT_TRUE(before.size() == 0 || s.links == before);
    } else {
      ++dropped;
      ASSERT_EQ(s.links.size(), 0);
    }
  }
  EXPECT_GT(kept, 5);
  EXPECT_GT(dropped, 5);
}

// What was loaded is checked: each member of another size, and links to particles that are not there.
TEST(Spso2011, InconsistentStatesAreSeen) {
  const Spso2011::State made = two_particles(1, true);
  EXPECT_TRUE(made.consistent());
  for (MatrixX Swarm::*member : {&Swarm::positions, &Swarm::velocities, &Swarm::best_positions})
    for (const auto& [rows, cols] : {std::pair<Index, Index>{2, 3}, {3, 2}}) {
      Spso2011::State s = made;
      s.*member = MatrixX::Zero(rows, cols);
      EXPECT_FALSE(s.consistent()) << rows << " x " << cols;
    }
  for (VectorX Swarm::*member : {&Swarm::fitness, &Swarm::best_values, static_cast<VectorX Swarm::*>(&Swarm::best)}) {
    Spso2011::State s = made;
    s.*member = VectorX::Zero(3);
    EXPECT_FALSE(s.consistent());
  }
  Spso2011::State s = made;
  s.links(0, 1) = 2;
  EXPECT_FALSE(s.consistent());
  s.links(0, 1) = -1;
  EXPECT_FALSE(s.consistent());
  s.links.setZero(1, 3);
  EXPECT_FALSE(s.consistent());
  s.links.resize(0, 0);  // to be drawn
  EXPECT_TRUE(s.consistent());
}

}  // namespace
}  // namespace vernier::spso2011_test
