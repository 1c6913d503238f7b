#pragma once

/// @file
/// Fits geometry, frames and joint errors together, to poses measured from one place or several.

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "vernier/identification/error_model_options.hpp"
#include "vernier/identification/error_model_problem.hpp"
#include "vernier/identification/fitted_error_model.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identified.hpp"

namespace vernier {

namespace detail {

/// The steps of `fit_error_model`, in the order in which they are taken.
template <class Chain>
class ErrorModelFit {
 public:
  static constexpr int N = Chain::dof;

  ErrorModelFit(const Identified<Chain>& start, std::span<const Dataset<N>> stations, const ErrorModelOptions& options)
      : nominal_(start.model.reference().model()),
        options_(options),
        stations_(stations),
        problem_(ErrorModelDesign<Chain>(arms(start, stations), unknowns(start, stations.size(), options)),
                 sensors(stations, options), options.loss),
        stride_(std::max<Index>(1, problem_.poses() / options.left_out)) {}

  FittedErrorModel<Chain> run() {
    FittedErrorModel<Chain> out{.design = problem_.design};
    out.converged = problem_.solve();
    for (int s = 0; s < problem_.design.stations(); ++s) out.geometry.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> few;
    few.gear_ratio = options_.gear_ratio;
    few.coupling = options_.coupling;
    if (options_.compliance) few.gravity.emplace(nominal_, options_.down);
    if (few.size() > 0) add(out, "elastic", few);
    for (int s = 0; s < problem_.design.stations(); ++s) out.elastic.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> all = few;
    const auto coverage = JointCoverage<N>::covering(all_joints());
    for (int j = 0; j < N; ++j) all.transmission[static_cast<std::size_t>(j)] = basis(j);
    const bool jointwise = all.size() > few.size() && add(out, "jointwise", all);
    if (jointwise && few.size() > 0) {  // sag shows better once the rest is clean
      const BlockChoice again = choose("elastic", 0, few.size());
      out.converged = problem_.solve() && out.converged;
      out.blocks.back().with = again.with;
    }
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
  /// The identified arm in every station's own base.
  static std::vector<Framed<Chain>> arms(const Identified<Chain>& start, std::span<const Dataset<N>> stations) {
    const Framed<Chain>& first = start.model.actual();
    std::vector<Framed<Chain>> out;
    for (const Dataset<N>& data : stations) {
      require(data.size() >= 1, "fit_error_model: a station without poses");
      if (stations.size() == 1) {
        out.push_back(first);
        break;
      }
      const Framed<Chain> unregistered(first.model(), {}, first.tool());
      out.emplace_back(first.model(), register_points(positions(unregistered, data.joints()), data.positions()),
                       first.tool());
    }
    return out;
  }

  static std::vector<GeometricUnknown> unknowns(const Identified<Chain>& start, std::size_t stations,
                                                const ErrorModelOptions& options) {
    std::vector<GeometricUnknown> out;
    const auto own = [&](Index k) {
      return k < 6 || (options.own_tools && k >= 6 + Chain::num_parameters);  // a base, or a tool
    };
    for (const Index k : start.free) {
      const ParameterEstimate& p = start.parameters[static_cast<std::size_t>(k)];
      const bool of_chain = k >= 6 && k < 6 + Chain::num_parameters;
      // thirty expected sizes bind nothing that is determined
      const double deviation = std::isfinite(p.prior) ? p.prior / p.size : 30;
      const double precision = of_chain ? 1 / (deviation * deviation) : 0;
      const std::size_t copies = own(k) ? stations : 1;
      for (std::size_t s = 0; s < copies; ++s)
        out.push_back({k, copies > 1 ? static_cast<int>(s) : -1, p.size, precision});
    }
    return out;
  }

  static std::vector<Station<N>> sensors(std::span<const Dataset<N>> stations, const ErrorModelOptions& options) {
    std::vector<Station<N>> out;
    for (const Dataset<N>& data : stations)
      out.push_back({&data, options.use_orientations && data.has_orientations(), options.position_sigma,
                     options.orientation_sigma, options.joint_sigma});
    return out;
  }

  JointRows<N> all_joints() const {
    JointRows<N> out(problem_.poses(), N);
    for (Index b = 0; b < out.rows(); ++b) out.row(b) = problem_.joints(b).transpose();
    return out;
  }

  AngleBasis basis(int joint) const {
    if (nominal_.row(joint).joint != JointType::revolute) return Fourier{0};
    if (options_.joint_nodes == 0) return Fourier{options_.harmonics};
    const auto column = all_joints().col(joint).eval();
    const double lower = column.minCoeff(), upper = column.maxCoeff();
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
    VectorX precisions = VectorX::Ones(terms.size());
    precisions.head(old) = before.precisions().tail(old);
    problem_.design.set_terms(terms, sizes(terms), precisions);
    out.blocks.push_back(choose(name, old, terms.size() - old));
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
      double turned = 0, turned_values = 0;
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
        if (b % stride_ != 0) continue;
        rows.expand(system.functions_of, all);
        const MatrixX position = rows.unit * (rows.root * all).topRows<3>();
        const MatrixX joint = rows.unit * (rows.root * rows.joint).topRows<3>();
        visits.push_back(
            {left.col(b / stride_), position * out.covariance * position.transpose(), joint * joint.transpose()});
      }
      if (turned_values > 0) out.orientation_sigma = std::sqrt(turned / turned_values * values / freedom);
      const VisitNoise noise = visit_noise(visits);
      out.position_sigma = noise.position;
      out.joint_sigma = noise.joint;
      out.covariance *= noise.model;
    });
  }

  Chain nominal_;
  ErrorModelOptions options_;
  std::span<const Dataset<N>> stations_;
  ErrorModelProblem<Chain> problem_;
  Index stride_;
};

}  // namespace detail

/// Geometry, frames and joint errors of an arm in one regularised least-squares problem, solved by Gauss-Newton on its
/// normal equations. Blocks that leave-one-pose-out does not support are left out.
/// @param start    an identified arm; its free parameters move again, its weak ones keep their priors
/// @param stations measured poses, one set a place of the sensor: the chain is shared, every base its own
/// @param options  which joint errors there may be, how large they are expected
/// @throws std::invalid_argument on an unusable option or no poses
/// @complexity O(n u^2 / 6) an iteration for n poses and u unknowns, memory O(u^2)
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, std::span<const Dataset<Chain::dof>> stations,
                                        const ErrorModelOptions& options = {}) {
  options.validate();
  require(!stations.empty(), "fit_error_model: no stations");
  return detail::ErrorModelFit<Chain>(start, stations, options).run();
}

/// The same from one station.
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, const Dataset<Chain::dof>& data,
                                        const ErrorModelOptions& options = {}) {
  return fit_error_model(start, std::span<const Dataset<Chain::dof>>(&data, 1), options);
}

}  // namespace vernier
