#pragma once

/// @file
/// Standard PSO 2011: a swarm that does not care how the axes lie.

#include <numbers>
#include <vector>

#include "vernier/search/swarm.hpp"

namespace vernier {

/// Standard particle swarm optimization of 2011. A particle at x that remembers p, and whose best informant remembers
/// l, draws a point from the ball around the centre of x, x + c (p - x) and x + c (l - x) (of the first two, where it
/// is its own best informant) that passes through x: a direction uniform on the sphere, a radius uniform up to the
/// ball's. Velocity: w times the old one, plus the way from x to that point.
///
/// - informants: each particle informs itself and `informed` others drawn at random, drawn anew after every iteration
///   that did not better the best of all;
/// - a coordinate that would leave the box stops at the bound, half its velocity turned back.
///
/// All particles move, then all are evaluated (synchronous).
/// @cite Clerc 2012; Zambrano-Bigiarini 2013
struct Spso2011 {
  int particles = 40;                                       ///< at least 1
  Index iterations = 375;                                   ///< generations after the first population
  int informed = 3;                                         ///< particles that each one informs, drawn with repeats
  double inertia = 1 / (2 * std::numbers::ln2_v<double>);   ///< w
  double acceleration = 0.5 + std::numbers::ln2_v<double>;  ///< c

  /// A swarm between two iterations.
  struct State : Swarm {
    /// informed x particles: column k has the particles that k informs; drawn anew in the next step where empty.
    Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic> links;

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      Swarm::each_member(s, visit);
      visit("links", s.links);
    }

    /// Whether the sizes of the members agree.
    bool consistent() const {
      return Swarm::consistent() && (links.size() == 0 || (links.cols() == positions.cols() && links.minCoeff() >= 0 &&
                                                           links.maxCoeff() < positions.cols()));
    }
  };

  /// Positions uniform in the box, velocities such that one step stays in it.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.rng = Rng(seed);
    const auto velocity = [&](Index d, double x) { return s.rng.uniform(box.lower(d) - x, box.upper(d) - x); };
    s.place(box, particles, velocity, evaluate);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const Index dimension = s.positions.rows(), n = s.positions.cols();
    if (s.links.size() == 0) {
      s.links.resize(informed, n);
      for (auto& link : s.links.reshaped()) link = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(n)));
    }
    const auto leaders = best_informants(s.best_values, s.links);
    VectorX direction(dimension), centre(dimension);
    for (Index k = 0; k < n; ++k) {
      auto x = s.positions.col(k);
      auto v = s.velocities.col(k);
      const Index leader = leaders[static_cast<std::size_t>(k)];
      centre = (acceleration / (leader == k ? 2 : 3)) * (s.best_positions.col(k) - x);  // relative to x
      if (leader != k) centre += (acceleration / 3) * (s.best_positions.col(leader) - x);
      for (Index d = 0; d < dimension; ++d) direction(d) = s.rng.normal();
      const double length = direction.norm(), radius = s.rng.uniform() * centre.norm();
      v = inertia * v + centre;
      if (length > 0) v += (radius / length) * direction;
      x += v;
      for (Index d = 0; d < dimension; ++d) {
        if (x(d) >= box.lower(d) && x(d) <= box.upper(d)) continue;
        x(d) = x(d) < box.lower(d) ? box.lower(d) : box.upper(d);
        v(d) *= -0.5;
      }
    }
    const double before = s.best_fitness;
    s.look(evaluate);
    if (!(s.best_fitness < before)) s.links.resize(0, 0);
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= iterations; }

  /// For every particle the one with the best memory among itself and those that inform it.
  static std::vector<Index> best_informants(const VectorX& values,
                                            const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>& links) {
    std::vector<Index> leaders(static_cast<std::size_t>(values.size()));
    for (Index k = 0; k < values.size(); ++k) leaders[static_cast<std::size_t>(k)] = k;
    for (Index k = 0; k < links.cols(); ++k)
      for (Index i = 0; i < links.rows(); ++i) {
        Index& leader = leaders[static_cast<std::size_t>(links(i, k))];
        if (values(k) < values(leader)) leader = k;
      }
    return leaders;
  }

 private:
  void validate() const {
    require(particles >= 1, "Spso2011: particles is ", particles, ", must be at least 1");
    require(iterations >= 0, "Spso2011: iterations is ", iterations, ", must not be negative");
    require(informed >= 1, "Spso2011: informed is ", informed, ", must be at least 1");
    require(inertia >= 0 && inertia <= 1 && acceleration >= 0 && acceleration <= 10, "Spso2011: inertia ", inertia,
            " must lie in [0, 1] and acceleration ", acceleration, " in [0, 10]");
  }
};

}  // namespace vernier
