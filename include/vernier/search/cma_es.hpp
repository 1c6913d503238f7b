#pragma once

/// @file
/// CMA-ES: a normal distribution that learns the shape of the objective.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vernier/core/argsort.hpp"
#include "vernier/search/bounds.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// Recombination weights and learning rates of CMA-ES for a dimension and a population; the names are Hansen's.
/// @cite Hansen 2016
struct CmaEsConstants {
  VectorX weights;       ///< of the ranks, the best first; the better half sums to 1, the worse half is not positive
  Index mu;              ///< how many weights are positive
  double mu_eff;         ///< variance effective selection mass
  double c_sigma;        ///< learning rate of the step size's path
  double d_sigma;        ///< damping of the step size
  double c_c;            ///< learning rate of the covariance's path
  double c_1;            ///< of the rank-one update
  double c_mu;           ///< of the rank-mu update
  double expected_norm;  ///< E|N(0, I)|

  /// For `individuals` in `dimension`s, with negative weights for the worse half (active CMA).
  CmaEsConstants(Index dimension, Index individuals) : weights(individuals), mu(individuals / 2) {
    const auto n = static_cast<double>(dimension);
    for (Index i = 0; i < individuals; ++i)
      weights(i) = std::log((static_cast<double>(individuals) + 1) / 2) - std::log(static_cast<double>(i + 1));
    const auto effective = [](const auto& w) { return w.sum() * w.sum() / w.squaredNorm(); };
    auto better = weights.head(mu);
    auto worse = weights.tail(individuals - mu);
    mu_eff = effective(better);
    c_c = (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n);
    c_1 = 2 / ((n + 1.3) * (n + 1.3) + mu_eff);
    c_mu = std::min(1 - c_1, 2 * (0.25 + mu_eff + 1 / mu_eff - 2) / ((n + 2) * (n + 2) + mu_eff));
    c_sigma = (mu_eff + 2) / (n + mu_eff + 5);
    d_sigma = 1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_sigma;
    expected_norm = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
    better /= better.sum();
    if (const double sum = -worse.sum(); sum > 0) {
      const double of_worse = effective(worse);
      worse *=
          std::max(0.0, std::min({1 + c_1 / c_mu, 1 + 2 * of_worse / (of_worse + 2), (1 - c_1 - c_mu) / (n * c_mu)})) /
          sum;
    }
  }
};

/// Covariance matrix adaptation: points are drawn from a normal distribution whose mean, step size and covariance
/// follow the ranks of what was found; worse ranks count negatively (active CMA). Independent of rotations and of
/// rising transformations of the objective.
///
/// - box: the search lives in all space, in coordinates in which the box is [0, 1] everywhere; what stands outside is
///   evaluated at its mirror image inside, every bound being a mirror;
/// - start: a mean uniform in the box;
/// - a run has converged when the best values of the last 10 + 30 n / lambda generations and those of the last
///   population lie within `tolerance_f`, all standard deviations and the path fall below `tolerance_x`, or the
///   covariance is not to be told from a singular one. Then, up to `restarts` times, another one starts elsewhere with
///   a population `growth` times as large (IPOP); a start is part of the first generation of its run.
/// @cite Hansen and Ostermeier 2001; Hansen 2016; Auger and Hansen 2005
struct CmaEs {
  int individuals = 0;         ///< lambda of the first run; 0: 4 + floor(3 ln n)
  Index generations = 1000;    ///< after the first population, of all runs together
  double sigma = 0.3;          ///< first standard deviation, relative to the width of the box
  int restarts = 0;            ///< of converged runs
  double growth = 2;           ///< of the population from run to run
  double tolerance_x = 1e-12;  ///< relative to the width of the box
  double tolerance_f = 1e-12;  ///< in units of the objective

  /// The distribution between two generations, in coordinates of the unit box.
  struct State : CommonState {
    VectorX mean;            ///< where the next population is drawn
    double sigma = 0;        ///< step size
    MatrixX covariance;      ///< C, without the step size
    MatrixX basis;           ///< eigenvectors of C, columns
    VectorX scales;          ///< roots of its eigenvalues
    VectorX path_c;          ///< evolution path of C
    VectorX path_sigma;      ///< evolution path of the step size
    VectorX history;         ///< best values of the last generations, the newest last
    Index individuals = 0;   ///< lambda of this run
    Index updates = 0;       ///< of this run
    Index decomposed = 0;    ///< update at which `basis` was found
    Index run = 0;           ///< runs before this one
    bool converged = false;  ///< this run

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
    bool consistent() const {
      const Index n = best.size();
      const auto square = [n](const MatrixX& m) { return m.rows() == n && m.cols() == n; };
      return square(covariance) && square(basis) && mean.size() == n && scales.size() == n && path_c.size() == n &&
             path_sigma.size() == n && individuals >= 2;
    }
  };

  /// The first population, drawn about a mean uniform in the box.
  template <class = void>
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.rng = Rng(seed);
    begin(s, box);
    generate(s, box, evaluate);
    return s;
  }

  /// One generation.
  template <class = void>
  void step(State& s, const Box& box, Evaluate evaluate) const {
    if (s.converged) {
      ++s.run;
      begin(s, box);
    }
    generate(s, box, evaluate);
    ++s.generation;
  }

  /// Whether all generations of the schedule were stepped, or the last run has converged.
  bool done(const State& s) const { return s.generation >= generations || (s.converged && s.run >= restarts); }

  /// Takes an evaluated generation in: `z` are the standard normal draws, dimension x lambda, `order` their columns,
  /// the best first.
  template <class = void>
  static void update(State& s, const MatrixX& z, const std::vector<Index>& order) {
    const Index n = s.mean.size(), lambda = z.cols();
    const CmaEsConstants c(n, lambda);
    MatrixX sorted(n, lambda);
    for (Index i = 0; i < lambda; ++i) sorted.col(i) = z.col(order[static_cast<std::size_t>(i)]);
    const VectorX z_mean = sorted.leftCols(c.mu) * c.weights.head(c.mu);
    const VectorX y_mean = s.basis * s.scales.cwiseProduct(z_mean);
    s.mean += s.sigma * y_mean;
    ++s.updates;

    s.path_sigma = (1 - c.c_sigma) * s.path_sigma +
                   std::sqrt(c.c_sigma * (2 - c.c_sigma) * c.mu_eff) * (s.basis * z_mean);  // C^-1/2 y = B z
    const double length = s.path_sigma.norm();
    const double settled = std::sqrt(1 - std::pow(1 - c.c_sigma, 2.0 * static_cast<double>(s.updates)));
    const bool moderate = length / settled < (1.4 + 2 / (static_cast<double>(n) + 1)) * c.expected_norm;
    s.path_c *= 1 - c.c_c;
    if (moderate) s.path_c += std::sqrt(c.c_c * (2 - c.c_c) * c.mu_eff) * y_mean;

    VectorX weights = c.weights;  // worse points count by direction, not by length: C stays positive definite
    for (Index i = c.mu; i < lambda; ++i)
      weights(i) *= static_cast<double>(n) / std::max(sorted.col(i).squaredNorm(), 1e-300);
    const MatrixX y = s.basis * (s.scales.asDiagonal() * sorted);
    s.covariance *= 1 - c.c_1 - c.c_mu * c.weights.sum() + (moderate ? 0 : c.c_1 * c.c_c * (2 - c.c_c));
    s.covariance.noalias() += c.c_1 * (s.path_c * s.path_c.transpose());
    s.covariance.noalias() += (y * (c.c_mu * weights).asDiagonal()) * y.transpose();
    s.sigma *= std::exp(std::min(1.0, c.c_sigma / c.d_sigma * (length / c.expected_norm - 1)));

    if (static_cast<double>(s.updates - s.decomposed) > 1 / ((c.c_1 + c.c_mu) * static_cast<double>(n) * 10)) {
      const Eigen::SelfAdjointEigenSolver<MatrixX> eigen(s.covariance);
      const VectorX& values = eigen.eigenvalues();
      if (eigen.info() != Eigen::Success || !(values(0) > 1e-14 * values(n - 1))) {
        s.converged = true;
        return;
      }
      s.basis = eigen.eigenvectors();
      s.scales = values.cwiseSqrt();
      s.decomposed = s.updates;
    }
  }

 private:
  /// A run from scratch.
  void begin(State& s, const Box& box) const {
    const Index n = box.dimension();
    const auto first =
        individuals > 0 ? static_cast<double>(individuals) : 4 + std::floor(3 * std::log(static_cast<double>(n)));
    s.individuals = std::lround(first * std::pow(growth, static_cast<double>(s.run)));
    s.mean.resize(n);
    for (auto& coordinate : s.mean) coordinate = s.rng.uniform();
    s.sigma = sigma;
    s.covariance = s.basis = MatrixX::Identity(n, n);
    s.scales = VectorX::Ones(n);
    s.path_c = s.path_sigma = VectorX::Zero(n);
    s.history.resize(0);
    s.updates = s.decomposed = 0;
    s.converged = false;
  }

  /// Draws, evaluates, learns.
  template <class = void>
  void generate(State& s, const Box& box, Evaluate evaluate) const {
    const Index n = s.mean.size(), lambda = s.individuals;
    MatrixX z(n, lambda);
    for (Index i = 0; i + 1 < z.size(); i += 2) normal_pair(s.rng, z.data() + i);
    if (z.size() % 2 != 0) z.data()[z.size() - 1] = s.rng.normal();
    MatrixX points = s.basis * (s.scales.asDiagonal() * z);
    for (Index k = 0; k < lambda; ++k)
      for (Index d = 0; d < n; ++d) {
        const double at = reflected(s.mean(d) + s.sigma * points(d, k), 0, 1);
        points(d, k) = std::clamp(box.lower(d) + (box.upper(d) - box.lower(d)) * at, box.lower(d), box.upper(d));
      }
    VectorX fitness;
    evaluate(points, fitness);
    s.keep_best(points, fitness);
    const auto order = argsort(fitness);
    update(s, z, order);
    look_for_convergence(s, fitness(order.front()), fitness(order.back()));
  }

  void look_for_convergence(State& s, double best, double worst) const {
    const Index n = s.mean.size(), length = 10 + (30 * n + s.individuals - 1) / s.individuals;
    if (s.history.size() == length) std::copy(s.history.begin() + 1, s.history.end(), s.history.begin());
    if (s.history.size() < length) s.history.conservativeResize(s.history.size() + 1);
    s.history(s.history.size() - 1) = best;
    const auto within = [&](double a, double b) { return a == b || std::abs(a - b) <= tolerance_f; };
    const bool flat =
        s.history.size() == length && within(s.history.minCoeff(), s.history.maxCoeff()) && within(best, worst);
    const double spread =
        s.sigma * std::max(s.path_c.cwiseAbs().maxCoeff(), std::sqrt(s.covariance.diagonal().maxCoeff()));
    s.converged = s.converged || flat || !(spread >= tolerance_x) || !(spread < 1e6);
  }

  /// Two standard normal numbers, by Marsaglia's polar method.
  static void normal_pair(Rng& rng, double* out) {
    for (;;) {
      const double u = rng.uniform(-1, 1), v = rng.uniform(-1, 1), r = u * u + v * v;
      if (!(r > 0 && r < 1)) continue;
      const double scale = std::sqrt(-2 * std::log(r) / r);
      out[0] = scale * u;
      out[1] = scale * v;
      return;
    }
  }

  void validate() const {
    require(individuals == 0 || individuals >= 2, "CmaEs: individuals is ", individuals, ", must be 0 or at least 2");
    require(generations >= 0, "CmaEs: generations is ", generations, ", must not be negative");
    require(sigma > 0 && sigma <= 100, "CmaEs: sigma is ", sigma, ", must lie in (0, 100]");
    require(restarts >= 0 && restarts <= 30, "CmaEs: restarts is ", restarts, ", must lie in 0..30");
    require(growth >= 1 && growth <= 10, "CmaEs: growth is ", growth, ", must lie in [1, 10]");
    require(tolerance_x >= 0 && tolerance_f >= 0, "CmaEs: tolerance_x ", tolerance_x, " and tolerance_f ", tolerance_f,
            " must not be negative");
  }
};

}  // namespace vernier
