#pragma once

/// @file
/// Fits geometry, frames and joint errors together, to poses and distances measured from one place or several.

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "vernier/identification/error_model_options.hpp"
#include "vernier/identification/error_model_problem.hpp"
#include "vernier/identification/error_model_start.hpp"
#include "vernier/identification/fitted_error_model.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/prior_objective.hpp"

namespace vernier {

namespace detail {

/// The steps of `fit_error_model`, in the order in which they are taken.
template <class Chain>
class ErrorModelFit {
 public:
  static constexpr int N = Chain::dof;

  ErrorModelFit(const Identified<Chain>& start, std::span<const Dataset<N>> stations,
                std::span<const Distances<N>> distances, const ErrorModelOptions& options)
      : nominal_(start.model.reference().model()),
        options_(options),
        problem_(ErrorModelDesign<Chain>(
                     starting_arms(start, stations, distances),
                     geometric_unknowns(start, stations.size(), stations.size() + distances.size(), options)),
                 sensors<N>(stations, distances, options), options.loss),
        stride_(std::max<Index>(1, problem_.judged() / options.left_out)) {
    joints_.resize(problem_.poses(), N);
    for (Index b = 0; b < joints_.rows(); ++b) joints_.row(b) = problem_.joints(b).transpose();
  }

  FittedErrorModel<Chain> run(PriorSearch search) {
    FittedErrorModel<Chain> out{.design = problem_.design};
    out.converged = problem_.solve();
    for (int s = 0; s < problem_.design.stations(); ++s) out.geometry.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> few;
    if (options_.compliance) few.gravity.emplace(nominal_, options_.down);
    if (few.size() > 0) add(out, "elastic", few);
    for (int s = 0; s < problem_.design.stations(); ++s) out.elastic.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> all = few;
    for (int j = 0; j < N; ++j) all.transmission[static_cast<std::size_t>(j)] = basis(j);
    const bool jointwise = all.size() > few.size() && add(out, "jointwise", all);
    if (jointwise) {
      out.fallback_error = out.blocks.back().without;
      if (few.size() > 0) {  // sag shows better once the rest is clean
        out.blocks.push_back(choose("elastic_with_jointwise", 0, few.size()));
        out.converged = problem_.solve() && out.converged;
      }
      // linear in the joints, so they would go far beyond the measured ranges: they come with the terms that do not
      all.gear_ratio = options_.gear_ratio;
      all.coupling = options_.coupling;
      if (all.gear_ratio || all.coupling) add(out, "gears", all);
      if (search) out.converged = tune(out, search) && out.converged;
    }
    const auto coverage = JointCoverage<N>::covering(joints_);
    for (int s = 0; s < problem_.design.stations(); ++s) {
      if (jointwise)
        out.models.push_back(
            {nominal_, problem_.design.arm(s), out.elastic[static_cast<std::size_t>(s)].arm(), coverage});
      else
        out.models.push_back(out.elastic[static_cast<std::size_t>(s)]);
    }
    out.design = problem_.design;
    assess(out);
    return out;
  }

 private:
  AngleBasis basis(int joint) const {
    if (nominal_.row(joint).joint != JointType::revolute) return Fourier{0};
    if (options_.joint_nodes == 0) return Fourier{options_.harmonics};
    const double lower = joints_.col(joint).minCoeff(), upper = joints_.col(joint).maxCoeff();
    return upper - lower > 1e-6 ? AngleBasis(JointNodes::spread(options_.joint_nodes, lower, upper))
                                : AngleBasis(Fourier{0});
  }

  /// Expected sizes of the coefficients of some terms.
  VectorX sizes(const JointTerms<Chain>& terms) const {
    VectorX out(terms.size());
    Index at = 0;
    const auto fill = [&](Index count, double size) {
      out.segment(at, count).setConstant(size);
      at += count;
    };
    if (terms.gear_ratio) fill(N, options_.gear_ratio_size);
    if (terms.coupling) fill(N - 1, options_.coupling_size);
    if (terms.gravity) fill(GravityCompliance<Chain>::size, options_.compliance_size);
    for (const AngleBasis& basis : terms.transmission)
      std::visit(
          [&](const auto& b) {
            for (Index k = 0; k < b.size(); ++k) out(at++) = options_.transmission_size * b.relative_size(k);
          },
          basis);
    return out;
  }

  /// Puts terms in if leave-one-pose-out supports those beyond the present ones.
  bool add(FittedErrorModel<Chain>& out, const char* name, const JointTerms<Chain>& terms) {
    const auto before = problem_.design;
    const Index old = before.terms().size();
    const bool in_front =
        terms.few() > before.terms().few() && old > 0;  // the order of terms: gears, sag, transmission
    VectorX precisions = VectorX::Ones(terms.size());
    precisions.segment(in_front ? terms.size() - old : 0, old) = before.precisions().tail(old);
    problem_.design.set_terms(terms, sizes(terms), precisions);
    out.blocks.push_back(choose(name, in_front ? 0 : old, terms.size() - old));
    if (!out.blocks.back().used) {
      problem_.design = before;
      return false;
    }
    out.converged = problem_.solve() && out.converged;
    return true;
  }

  /// Settles the prior of some coefficients by leave-one-pose-out.
  BlockChoice choose(const char* name, Index first, Index count) {
    VectorX precisions = problem_.design.precisions();
    const Index at = static_cast<Index>(problem_.design.geometric().size()) + first;
    const PriorChoice choice = problem_.with_system([&](const PoseSystem& system) {
      return choose_prior(system, PoseNormalEquations(system), precisions, problem_.design.steps(), at, count, stride_);
    });
    precisions.segment(at, count).setConstant(choice.tightness);
    problem_.design.set_precisions(precisions.tail(problem_.design.terms().size()));
    const bool used = choice.tightness < nothing_left;
    return {name, choice.without, used ? choice.with : choice.best, used, choice.tightness};
  }

  /// Priors of the joint errors by a search over the left-out errors; kept where they are better than those there were.
  bool tune(FittedErrorModel<Chain>& out, PriorSearch search) {
    VectorX relative(problem_.design.size() - problem_.design.dense());
    Index at = 0;
    for (const AngleBasis& basis : problem_.design.terms().transmission)
      std::visit(
          [&](const auto& b) {
            for (Index k = 0; k < b.size(); ++k) relative(at++) = b.relative_size(k);
          },
          basis);
    const VectorX found = problem_.with_system([&](const PoseSystem& system) {
      const PoseNormalEquations normal(system);
      const VectorX before = problem_.design.precisions();
      const PriorObjective objective(system, normal, before, problem_.design.steps(), problem_.design.terms().few(),
                                     relative, stride_);
      const VectorX after = objective.precisions(search(objective, objective.box()));
      const double without = objective.error(before), with = objective.error(after);
      out.blocks.push_back({"tuned_priors", without, with, with < without, 1});
      return VectorX(with < without ? after : before);
    });
    problem_.design.set_precisions(found.tail(problem_.design.terms().size()));
    return problem_.solve();
  }

  /// Covariance of the unknowns, and what no unknown explains.
  void assess(FittedErrorModel<Chain>& out) const {
    problem_.with_system([&](const PoseSystem& system) {
      const PoseNormalEquations normal(system);
      const VectorX precisions = problem_.design.precisions();
      const FactorisedSystem solved(normal, precisions, problem_.design.steps());
      const Index p = system.unknowns();
      out.covariance = solved.factor.solve(MatrixX::Identity(p, p));
      const double explained = static_cast<double>(p) - out.covariance.diagonal().dot(precisions);
      const double values = static_cast<double>(problem_.measured_values());
      const double freedom = std::max(1.0, values - explained);
      out.covariance *= normal.cost / freedom;

      // left-out errors hold the noise of a visit and the uncertainty of the unknowns
      PoseRows rows;
      Rows6 all(6, p);
      double turned = 0, turned_values = 0, distances_square_sum = 0;
      std::vector<LeftOutVisit> visits;
      const Eigen::Matrix3Xd left = left_out_errors(system, solved, stride_);
      for (Index b = 0; b < system.poses; ++b) {
        system.rows(b, rows);
        const Station<N>& station = problem_.station_of(b);
        if (station.oriented) {
          turned += (rows.root * rows.residual).tail<3>().squaredNorm() * station.orientation_sigma *
                    station.orientation_sigma;
          turned_values += 3;
        }
        if (b % stride_ != 0 || b >= system.judged) continue;
        if (station.distances != nullptr) {
          distances_square_sum += left.col(b / stride_).squaredNorm();
          continue;
        }
        rows.expand(system.functions_of, all);
        const MatrixX position = rows.unit * (rows.root * all).topRows<3>();
        const MatrixX joint = rows.unit * (rows.root * rows.joint).topRows<3>();
        visits.push_back(
            {left.col(b / stride_), position * out.covariance * position.transpose(), joint * joint.transpose()});
      }
      if (turned_values > 0) out.orientation_sigma = std::sqrt(turned / turned_values * values / freedom);
      if (visits.empty()) {
        out.position_sigma = std::sqrt(distances_square_sum / static_cast<double>(left.cols()));
        return;
      }
      const VisitNoise noise = visit_noise(visits);
      out.position_sigma = noise.position;
      out.joint_sigma = noise.joint;
      out.covariance *= noise.model;
    });
  }

  Chain nominal_;
  ErrorModelOptions options_;
  ErrorModelProblem<Chain> problem_;
  Index stride_;
  JointRows<N> joints_;  // of all samples
};

}  // namespace detail

/// Geometry, frames and joint errors of an arm in one regularised least-squares problem, solved by Gauss-Newton on its
/// normal equations. Blocks that leave-one-pose-out does not support are left out.
/// @param start     an identified arm; its free parameters move again, its weak ones keep their priors
/// @param stations  measured poses, one set a place of the sensor: the chain is shared, every base its own
/// @param distances measured distances, one set a fixed point, which need not be known; either of the two may be empty
/// @param options   which joint errors there may be, how large they are expected
/// @param search    tunes the priors of the joint errors, e.g. by a metaheuristic; by default they are chosen from a
/// few
/// @throws std::invalid_argument on an unusable option or no measurements
/// @complexity O(n u^2 / 6) an iteration for n poses and u unknowns, memory O(u^2)
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, std::span<const Dataset<Chain::dof>> stations,
                                        std::span<const Distances<Chain::dof>> distances,
                                        const ErrorModelOptions& options = {}, PriorSearch search = {}) {
  options.validate();
  require(stations.size() + distances.size() > 0, "fit_error_model: no stations");
  return detail::ErrorModelFit<Chain>(start, stations, distances, options).run(search);
}

/// The same from poses alone.
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, std::span<const Dataset<Chain::dof>> stations,
                                        const ErrorModelOptions& options = {}, PriorSearch search = {}) {
  return fit_error_model(start, stations, std::span<const Distances<Chain::dof>>(), options, search);
}

/// The same from one station.
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, const Dataset<Chain::dof>& data,
                                        const ErrorModelOptions& options = {}, PriorSearch search = {}) {
  return fit_error_model(start, std::span<const Dataset<Chain::dof>>(&data, 1), options, search);
}

}  // namespace vernier
