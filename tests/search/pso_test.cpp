// SPDX-License-Identifier: BSD-3-Clause
// The update worked by hand, the inertia, the limits.

#include "vernier/search/pso.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "vernier/search/bounds.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/minimize.hpp"

namespace vernier::pso_test {
namespace {

/// Two coordinates of different width.
Box box2() { return {Eigen::Vector2d(-1, 10), Eigen::Vector2d(3, 20)}; }

double bowl(const VectorX& x) { return (x(0) - 1) * (x(0) - 1) + (x(1) - 12) * (x(1) - 12) / 4; }

const auto evaluate_bowl = [](const MatrixX& population, VectorX& fitness) {
  fitness.resize(population.cols());
  for (Index k = 0; k < population.cols(); ++k) fitness(k) = bowl(population.col(k));
};

// Positions and velocities in the order they are drawn: particle by particle, coordinate by coordinate, x then v.
TEST(Pso, FirstSwarmByHand) {
  const Pso pso{.particles = 2, .velocity_limit = 0.5};
  const Pso::State s = pso.start(box2(), 77, evaluate_bowl);
  Rng rng(77);
  for (Index k = 0; k < 2; ++k) {
    EXPECT_NEAR(s.positions(0, k), -1 + 4 * rng.uniform(), 1e-14);
    EXPECT_NEAR(s.velocities(0, k), -1 + 2 * rng.uniform(), 1e-14);  // half the half width
    EXPECT_NEAR(s.positions(1, k), 10 + 10 * rng.uniform(), 1e-14);
    EXPECT_NEAR(s.velocities(1, k), -2.5 + 5 * rng.uniform(), 1e-14);
  }
  const Index leader = bowl(s.positions.col(0)) <= bowl(s.positions.col(1)) ? 0 : 1;
  EXPECT_EQ(s.best, s.positions.col(leader));
  EXPECT_EQ(s.best_fitness, bowl(s.positions.col(leader)));
  EXPECT_EQ(s.generation, 0);
}

// Two particles, two coordinates, two iterations: every number from the formulas, with none of the library's code but
// the random numbers.
TEST(Pso, UpdatesByHand) {
  const double c1 = 1.7, c2 = 2.3, limits[2] = {2, 5};
  const Pso pso{
      .particles = 2, .iterations = 4, .inertia_start = 0.9, .inertia_end = 0.4, .cognitive = c1, .social = c2};
  Pso::State s = pso.start(box2(), 5, evaluate_bowl);
  Rng rng(5);
  double x[2][2], v[2][2], p[2][2], p_value[2];
  for (int k = 0; k < 2; ++k)
    for (int d = 0; d < 2; ++d) {
      x[k][d] = p[k][d] = (d == 0 ? -1 + 4 * rng.uniform() : 10 + 10 * rng.uniform());
      v[k][d] = -limits[d] + 2 * limits[d] * rng.uniform();
    }
  const auto value = [](const double* at) { return bowl(Eigen::Vector2d(at[0], at[1])); };
  for (int k = 0; k < 2; ++k) p_value[k] = value(x[k]);
  const double w[2] = {0.775, 0.65};  // 0.9 - 0.5 k / 4
  for (int iteration = 0; iteration < 2; ++iteration) {
    const int g = p_value[0] <= p_value[1] ? 0 : 1;
    const double leader[2] = {p[g][0], p[g][1]};
    for (int k = 0; k < 2; ++k)
      for (int d = 0; d < 2; ++d) {
        const double r1 = rng.uniform(), r2 = rng.uniform();
        v[k][d] = w[iteration] * v[k][d] + c1 * r1 * (p[k][d] - x[k][d]) + c2 * r2 * (leader[d] - x[k][d]);
        v[k][d] = std::min(std::max(v[k][d], -limits[d]), limits[d]);
        x[k][d] += v[k][d];
      }
    for (int k = 0; k < 2; ++k)
      if (value(x[k]) < p_value[k]) {
        p_value[k] = value(x[k]);
        std::copy(x[k], x[k] + 2, p[k]);
      }
    pso.step(s, box2(), evaluate_bowl);
    for (int k = 0; k < 2; ++k)
      for (int d = 0; d < 2; ++d) {
        EXPECT_NEAR(s.velocities(d, k), v[k][d], 1e-13) << iteration << " " << k << " " << d;
        EXPECT_NEAR(s.positions(d, k), x[k][d], 1e-13);
        EXPECT_NEAR(s.best_positions(d, k), p[k][d], 1e-13);
      }
    EXPECT_NEAR(s.best_fitness, std::min(p_value[0], p_value[1]), 1e-13);
    EXPECT_EQ(s.generation, iteration + 1);
  }
}

// One particle sits on its own best and on the swarm's: only inertia moves it, so w shows.
TEST(Pso, InertiaFallsLinearly) {
  const Pso pso;
  EXPECT_DOUBLE_EQ(pso.inertia(1), 0.9 - 0.5 / 300);
  EXPECT_DOUBLE_EQ(pso.inertia(150), 0.65);
  EXPECT_DOUBLE_EQ(pso.inertia(300), 0.4);
  EXPECT_DOUBLE_EQ(Pso{.iterations = 0}.inertia(1), 0.4);

  const Pso one{.particles = 1, .iterations = 10};
  const auto falling = [](const MatrixX& population, VectorX& fitness) { fitness = -population.row(0).transpose(); };
  Pso::State s = one.start(Box::cube(1, 0, 1), 1, falling);
  s.velocities(0, 0) = 0.1;  // uphill: every position is the best so far
  double expected = 0.1;
  for (Index k = 1; k <= 10; ++k) {
    one.step(s, Box::cube(1, 0, 1), falling);
    expected *= 0.9 - 0.05 * static_cast<double>(k);
    EXPECT_NEAR(s.velocities(0, 0), expected, 1e-15);
  }
  EXPECT_TRUE(one.done(s));
}

// Constants that would throw particles far away: the limit holds in every coordinate, and is reached.
TEST(Pso, VelocityStaysWithinItsLimit) {
  const Pso pso{.particles = 8, .iterations = 30, .cognitive = 20, .social = 20, .velocity_limit = 0.25};
  Pso::State s = pso.start(box2(), 3, evaluate_bowl);
  const Eigen::Vector2d limit(0.5, 1.25);
  double largest = 0;
  while (!pso.done(s)) {
    const MatrixX before = s.positions;
    pso.step(s, box2(), evaluate_bowl);
    const MatrixX relative = limit.cwiseInverse().asDiagonal() * s.velocities;
    EXPECT_LE(relative.cwiseAbs().maxCoeff(), 1);
    EXPECT_LT((s.positions - before - s.velocities).cwiseAbs().maxCoeff(), 1e-13);
    largest = std::max(largest, relative.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(s.generation, 30);
  EXPECT_EQ(largest, 1);
}

// Every particle is driven over the upper bound of coordinate 0: it stops there, its velocity zero, and the other
// coordinate goes on.
TEST(Pso, ClampedParticlesStopAtTheBound) {
  const Pso pso{.particles = 4, .iterations = 10, .cognitive = 0, .social = 0, .positions = PositionRule::clamped};
  Pso::State s = pso.start(box2(), 2, evaluate_bowl);
  s.positions.row(0).setConstant(2.9);
  s.velocities.row(0).setConstant(2);
  s.positions.row(1).setConstant(10.5);
  s.velocities.row(1) << 1, -1, 1, -1;
  pso.step(s, box2(), evaluate_bowl);
  const double w = 0.85;
  for (Index k = 0; k < 4; ++k) {
    EXPECT_NEAR(s.positions(0, k), 3, 1e-14);
    EXPECT_NEAR(s.velocities(0, k), 0, 1e-14);
  }
  EXPECT_NEAR(s.positions(1, 0), 10.5 + w, 1e-13);
  EXPECT_NEAR(s.velocities(1, 0), w, 1e-13);
  EXPECT_EQ(s.positions(1, 1), 10);
  EXPECT_EQ(s.velocities(1, 1), 0);
}

// Clerc and Kennedy's figures for phi = 4.1.
TEST(Pso, ConstrictionHasThePapersConstants) {
  const Pso pso = Pso::constriction();
  EXPECT_NEAR(pso.inertia(1), 0.72984, 5e-6);
  EXPECT_EQ(pso.inertia(1), pso.inertia(200));
  EXPECT_NEAR(pso.cognitive, 1.49618, 5e-6);
  EXPECT_EQ(pso.cognitive, pso.social);
}

/// Neighbours written out: cells of a grid of so many rows and columns that lie within a step on a torus.
std::vector<Index> neighbours_on_torus(Index k, Index rows, Index columns) {
  std::vector<Index> out;
  const auto apart = [](Index a, Index b, Index n) { return std::min((a - b + n) % n, (b - a + n) % n); };
  for (Index other = 0; other < rows * columns; ++other)
    if (apart(k / columns, other / columns, rows) + apart(k % columns, other % columns, columns) <= 1)
      out.push_back(other);
  return out;
}

// Of all orders of values the whole neighbourhood is asked: both sides of a ring, all four sides of a grid.
TEST(Pso, NeighbourhoodsAreWhole) {
  const Pso ring{.neighbourhood = Neighbourhood::ring}, grid{.neighbourhood = Neighbourhood::von_neumann};
  EXPECT_EQ(grid.grid_columns(50), 10);
  EXPECT_EQ(grid.grid_columns(36), 6);
  EXPECT_EQ(grid.grid_columns(13), 13);
  EXPECT_EQ(grid.grid_columns(1), 1);
  EXPECT_EQ(ring.grid_columns(50), 50);
  for (const auto& [n, columns] : {std::pair<Index, Index>{1, 1}, {2, 2}, {5, 5}, {12, 4}, {50, 10}, {50, 50}}) {
    for (Index k = 0; k < n; ++k) {
      const auto neighbours = neighbours_on_torus(k, n / columns, columns);
      for (Index better = 0; better < n; ++better) {
        VectorX values = VectorX::Ones(n);
        values(better) = 0;
        const bool near = std::find(neighbours.begin(), neighbours.end(), better) != neighbours.end();
        ASSERT_EQ(Pso::informant(values, k, columns), near ? better : k) << n << " " << columns << " " << k;
      }
    }
  }
}

// Neither inertia nor own memory: a particle of a ring moves by c2 r2 (best of its neighbours - x), r2 the second
// number drawn in each coordinate.
TEST(Pso, RingUpdatesByHand) {
  const Pso pso{.particles = 5,
                .iterations = 4,
                .inertia_start = 0,
                .inertia_end = 0,
                .cognitive = 0,
                .social = 0.5,
                .neighbourhood = Neighbourhood::ring};
  Pso::State s = pso.start(box2(), 8, evaluate_bowl);
  s.best_values << 3, 1, 4, 2, 5;
  const Index leader[5] = {1, 1, 1, 3, 3};
  Rng rng = s.rng;
  const Pso::State before = s;
  pso.step(s, box2(), evaluate_bowl);
  for (Index k = 0; k < 5; ++k)
    for (Index d = 0; d < 2; ++d) {
      rng.uniform();
      const double pull = 0.5 * rng.uniform() * (before.best_positions(d, leader[k]) - before.positions(d, k));
      EXPECT_NEAR(s.velocities(d, k), pull, 1e-14) << k;
    }
}

// 2.9 + 1.7 bounces off 3 to 1.4; -0.9 - 5.5 (of width 4) off -1 and then off 3 to 2.6 - 1 = 1.6: an odd number of
// bounces turns the velocity round, an even one does not.
TEST(Pso, ReflectedParticlesBounce) {
  const Pso pso{.particles = 3,
                .iterations = 10,
                .inertia_start = 1,
                .inertia_end = 1,
                .cognitive = 0,
                .social = 0,
                .velocity_limit = 10,
                .positions = PositionRule::reflected};
  Pso::State s = pso.start(box2(), 2, evaluate_bowl);
  s.positions.row(0) << 2.9, -0.9, 0;
  s.velocities.row(0) << 1.7, -5.5, 2.5;
  s.positions.row(1).setConstant(15);
  s.velocities.row(1) << -6, 4, 0;
  pso.step(s, box2(), evaluate_bowl);
  EXPECT_NEAR(s.positions(0, 0), 1.4, 1e-14);
  EXPECT_EQ(s.velocities(0, 0), -1.7);
  EXPECT_NEAR(s.positions(0, 1), 3 - (5.5 - 0.1 - 4), 1e-14);
  EXPECT_EQ(s.velocities(0, 1), -5.5);
  EXPECT_EQ(s.positions(0, 2), 2.5);
  EXPECT_EQ(s.velocities(0, 2), 2.5);
  EXPECT_NEAR(s.positions(1, 0), 11, 1e-14);
  EXPECT_EQ(s.velocities(1, 0), 6);
  EXPECT_EQ(s.positions(1, 1), 19);
}

TEST(Bounds, MirrorsAndMiddles) {
  for (const double x : {-1.0, 0.25, 3.0}) EXPECT_EQ(reflected(x, -1, 3), x);
  EXPECT_EQ(reflected(-1.5, -1, 3), -0.5);
  EXPECT_EQ(reflected(3.5, -1, 3), 2.5);
  EXPECT_EQ(reflected(7.5, -1, 3), -0.5);
  EXPECT_EQ(reflected(-6.5, -1, 3), 1.5);
  EXPECT_EQ(halfway(-2, 1, -1, 3), 0);
  EXPECT_EQ(halfway(5, 1, -1, 3), 2);
  EXPECT_EQ(halfway(2, 1, -1, 3), 2);
}

/// A hash of every coordinate a search evaluates.
template <class A>
std::uint64_t trace(const A& algorithm) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto objective = [&](const VectorX& x) {
    double sum = 0;
    for (Index i = 0; i < x.size(); ++i) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x(i))) * 0x100000001b3u;
      const double d = x(i) - 0.3 * static_cast<double>(i);
      sum += d * d * static_cast<double>(i + 1);
    }
    return sum;
  };
  minimize(algorithm, objective, Box::cube(5, -1, 2), {}, 7);
  return hash;
}

// What was found with a seed is found again: the numbers of version 0.1, to the bit.
TEST(Pso, OldSearchesKeepTheirBits) {
  EXPECT_EQ(trace(Pso{.particles = 12, .iterations = 40}), 0x8c85096c5a4f3e00u);
  EXPECT_EQ(trace(Pso{.particles = 12, .iterations = 40, .positions = PositionRule::clamped}), 0x560b23789fd41eb7u);
  EXPECT_EQ(trace(GeneticAlgorithm{.individuals = 13, .generations = 40, .elites = 2}), 0xd37703db4dc808e8u);
}

}  // namespace
}  // namespace vernier::pso_test
