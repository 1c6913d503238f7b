// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// CMA-ES: covariance matrix adaptation evolution strategy.

#include <cstdint>
#include <vector>

#include "vernier/search/state.hpp"

namespace vernier {

/// Recombination weights and learning rates of CMA-ES for a dimension and a population; the names are Hansen's.
/// @cite Hansen 2016
struct CmaEsConstants {
  VectorX weights;       ///< of the ranks, the best first; the better half sums to 1, the worse half is not positive
  Index mu;              ///< number of positive weights
  double mu_eff;         ///< variance effective selection mass
  double c_sigma;        ///< learning rate of the step size's path
  double d_sigma;        ///< damping of the step size
  double c_c;            ///< learning rate of the covariance's path
  double c_1;            ///< of the rank-one update
  double c_mu;           ///< of the rank-mu update
  double expected_norm;  ///< E|N(0, I)|

  /// For `individuals` in `dimension`s, with negative weights for the worse half (active CMA).
  VERNIER_API CmaEsConstants(Index dimension, Index individuals);
};

/// Covariance matrix adaptation: points are drawn from a normal distribution whose mean, step size and covariance adapt
/// to the ranks of the points evaluated; worse ranks have negative weights (active CMA). Invariant under rotations and
/// under increasing transformations of the objective.
///
/// - box: the search is unbounded, in coordinates in which the box is [0, 1] in every dimension; a point outside is
///   evaluated at its reflection inside;
/// - start: a mean uniform in the box;
/// - a run has converged when the best values of the last 10 + 30 n / lambda generations and those of the last
///   population lie within `tolerance_f`, all standard deviations and the path fall below `tolerance_x`, or the
///   covariance is numerically singular. Then, up to `restarts` times, another run starts elsewhere with a population
///   `growth` times as large (IPOP); a start is part of the first generation of its run.
/// @cite Hansen and Ostermeier 2001; Hansen 2016; Auger and Hansen 2005
struct CmaEs {
  int individuals = 0;         ///< lambda of the first run; 0: 4 + floor(3 ln n)
  Index generations = 1000;    ///< after the first population, of all runs together
  double sigma = 0.3;          ///< initial standard deviation, relative to the width of the box
  int restarts = 0;            ///< after converged runs
  double growth = 2;           ///< factor of the population size from run to run
  double tolerance_x = 1e-12;  ///< relative to the width of the box
  double tolerance_f = 1e-12;  ///< in units of the objective

  /// The distribution between two generations, in coordinates of the unit box.
  struct State : CommonState {
    VectorX mean;            ///< of the next population
    double sigma = 0;        ///< step size
    MatrixX covariance;      ///< C, without the step size
    MatrixX basis;           ///< eigenvectors of C, columns
    VectorX scales;          ///< square roots of its eigenvalues
    VectorX path_c;          ///< evolution path of C
    VectorX path_sigma;      ///< evolution path of the step size
    VectorX history;         ///< best values of the last generations, the latest last
    Index individuals = 0;   ///< lambda of this run
    Index updates = 0;       ///< of this run
    Index decomposed = 0;    ///< update after which `basis` was computed
    Index run = 0;           ///< number of runs before this one
    bool converged = false;  ///< whether this run has

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      CommonState::each_member(s, visit);
      visit("mean", s.mean);
      visit("sigma", s.sigma);
      visit("covariance", s.covariance);
      visit("basis", s.basis);
      visit("scales", s.scales);
      visit("path_c", s.path_c);
      visit("path_sigma", s.path_sigma);
      visit("history", s.history);
      visit("individuals", s.individuals);
      visit("updates", s.updates);
      visit("decomposed", s.decomposed);
      visit("run", s.run);
      visit("converged", s.converged);
    }

    /// Whether the sizes of the members agree.
    VERNIER_API bool consistent() const;
  };

  /// The first population, drawn about a mean uniform in the box.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped, or the last run has converged.
  bool done(const State& s) const { return s.generation >= generations || (s.converged && s.run >= restarts); }

  /// The population of this run, or where that has converged of the next one.
  Index next_evaluations(const State& s) const {
    return s.converged ? population_size(s.mean.size(), s.run + 1) : s.individuals;
  }

  /// Lambda of a run, counted from 0.
  VERNIER_API Index population_size(Index dimension, Index run) const;

  /// Updates the distribution from an evaluated generation.
  /// @param s     the state
  /// @param z     the standard normal draws, dimension x lambda
  /// @param order their columns, the best first
  VERNIER_API static void update(State& s, const MatrixX& z, const std::vector<Index>& order);

 private:
  VERNIER_API static MatrixX stretched(const State& s, const MatrixX& z);
  VERNIER_API void begin_run(State& s) const;
  VERNIER_API void sample_and_update(State& s, const Box& box, Evaluate evaluate) const;
  VERNIER_API void check_convergence(State& s, double best, double worst) const;
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/cma_es.ipp"
#endif
