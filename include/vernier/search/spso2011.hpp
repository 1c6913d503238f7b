// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Standard PSO 2011: a swarm whose steps do not depend on the orientation of the axes.

#include <numbers>
#include <vector>

#include "vernier/search/swarm.hpp"

namespace vernier {

/// Standard particle swarm optimization of 2011. A particle at x with the best position p, whose best informant has the
/// best position l, draws a point from the ball about the centre of x, x + c (p - x) and x + c (l - x) (of the first
/// two, where it is its own best informant) that passes through x: a direction uniform on the sphere, a radius uniform
/// up to the ball's. The new velocity is w times the old one plus the displacement from x to that point.
///
/// - informants: each particle informs itself and `informed` others drawn at random, drawn anew after every iteration
///   that did not improve the best of all;
/// - a coordinate that would leave the box stops at the bound, its velocity multiplied by -1/2.
///
/// All particles move, then all are evaluated (synchronous).
/// @cite Clerc 2012; Zambrano-Bigiarini 2013
struct Spso2011 {
  int particles = 40;      ///< at least 1
  Index iterations = 375;  ///< generations after the first population

  static constexpr int informed = 3;  ///< number of particles each one informs, drawn with repeats
  static constexpr double inertia = 1 / (2 * std::numbers::ln2_v<double>);   ///< w
  static constexpr double acceleration = 0.5 + std::numbers::ln2_v<double>;  ///< c

  /// Particle indices, informed x particles: column k has the particles that k informs.
  using Links = Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>;

  /// A swarm between two iterations.
  struct State : Swarm {
    Links links;  ///< drawn anew in the next step where empty

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      Swarm::each_member(s, visit);
      visit("links", s.links);
    }

    /// Whether the sizes of the members agree.
    VERNIER_API bool consistent() const;
  };

  /// Positions uniform in the box, velocities such that one step stays in it.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= iterations; }

  /// All particles.
  Index next_evaluations(const State& s) const { return s.positions.cols(); }

  /// For every particle the one with the best memory among itself and those that inform it.
  VERNIER_API static std::vector<Index> best_informants(const VectorX& values, const Links& links);

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/spso2011.ipp"
#endif
