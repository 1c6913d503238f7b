#pragma once

/// @file
/// The steps of an identification.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "vernier/ceres/problem.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identifiability.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/plan.hpp"

namespace vernier {

namespace detail {

/// The steps of `identify`, in the order in which they are taken.
template <int N, class Convention, class Data>
class Identification {
  using Chain = DhChain<N, Convention>;
  using Arm = Framed<Chain>;
  using Plan = IdentificationPlan<N, Convention>;

 public:
  Identification(const Chain& nominal, const Data& data, const IdentifyOptions& options)
      : nominal_(nominal),
        data_(data),
        options_(options),
        plan_(nominal, options),
        start_(starting_frames(nominal, data, options.base_start.value_or(Isometry3::Identity()),
                               options.tool_start.value_or(Isometry3::Identity()), options.base_free(),
                               options.tool_free())),
        problem_(start_, data, options, plan_.sizes) {}

  Identified<Chain> run() {
    // Frames alone first: a good start, and the honest "before".
    problem_.set_free(select(plan_.frames).kept);
    bool solved = problem_.solve();
    problem_.anchor_here();
    const Arm registered = problem_.arm();

    // Then all that the measurements tell apart. What is dependent exactly at nominal may not be so at the solution.
    std::vector<Index> order = plan_.wanted;
    Selection columns = select(order);
    for (int round = 0; round < 3; ++round) {
      problem_.set_free(columns.kept);
      solved = problem_.solve();
      order = columns.kept;
      for (const auto& d : columns.dependent) order.push_back(d.parameter);
      Selection again = select(order);
      if (again.kept.size() <= columns.kept.size()) break;
      columns = again;
    }
    problem_.set_free(columns.kept);
    const std::vector<bool> weak = restrain_weak(solved);

    const Arm arm = problem_.arm();
    const Linearisation& at = problem_.linearise();
    const Precision precision(at.jacobian, row_variance(at), problem_.prior());
    Identified<Chain> out{.model = Calibrated<Chain>(arm, nominal_),
                          .status = IdentifyStatus::converged,
                          .message = problem_.message(),
                          .rms_before = position_rms(registered),
                          .rms_after = position_rms(arm),
                          .rotation_rms_after = problem_.oriented() ? rotation_rms(arm) : 0,
                          .parameters = {},
                          .free = problem_.free(),
                          .covariance = {},
                          .rank = precision.rank,
                          .condition = precision.condition,
                          .iterations = problem_.iterations(),
                          .observability = precision.singular_values.size() > 0
                                               ? Observability::of(precision.singular_values, data_.size())
                                               : Observability{}};
    report(out, precision, weak);
    if (!columns.dependent.empty()) explain(out, registered, columns);
    const auto moved = static_cast<Index>(out.free.size());
    if (problem_.rows() <= moved) out.status = IdentifyStatus::underdetermined;
    if (out.status == IdentifyStatus::underdetermined)
      out.message = message(data_.size(), " poses give ", problem_.rows(), " measured values, which determine only ",
                            moved, " of the ", static_cast<Index>(plan_.wanted.size()), " parameters asked for");
    if (!solved) {
      out.status = IdentifyStatus::not_converged;
      out.message = problem_.message();
    }
    return out;
  }

 private:
  /// `IndependentColumns` in terms of parameters.
  struct Selection {
    struct Dependent {
      Index parameter;
      std::vector<Index> absorbed_by;
    };
    std::vector<Index> kept;
    std::vector<Dependent> dependent;

    Selection(const std::vector<Index>& candidates, const MatrixX& jacobian) {
      const IndependentColumns columns(jacobian);
      const auto parameters = [&](const std::vector<Index>& which) {
        std::vector<Index> out;
        for (const Index k : which) out.push_back(candidates[static_cast<std::size_t>(k)]);
        return out;
      };
      kept = parameters(columns.kept);
      for (const auto& d : columns.dependent)
        dependent.push_back({candidates[static_cast<std::size_t>(d.column)], parameters(d.absorbed_by)});
    }
  };

  /// Tells the candidates apart where the problem stands; leaves them free.
  Selection select(const std::vector<Index>& candidates) {
    problem_.set_free(candidates);
    return Selection(candidates, problem_.linearise().jacobian);
  }

  /// Variance of whitened rows, one factor a sensor, from residuals; the sensors' own where nothing is left over.
  VectorX row_variance(const Linearisation& at) const {
    const Index rows = at.residuals.size(), n = at.group * data_.size();
    VectorX out = VectorX::Ones(rows);
    const double degrees = static_cast<double>(rows) - static_cast<double>(problem_.free().size());
    if (degrees < 1) return out;
    const auto variance = [&](const Eigen::Ref<const VectorX>& part) {
      const double mean_square = part.squaredNorm() / static_cast<double>(part.size());
      const double robust = options_.loss == Loss::squared ? 0 : robust_scale(part);
      return (options_.loss == Loss::squared ? mean_square : robust * robust) * static_cast<double>(rows) / degrees;
    };
    out.head(n).setConstant(variance(at.residuals.head(n)));
    if (problem_.oriented()) out.tail(n).setConstant(variance(at.residuals.tail(n)));
    return out;
  }

  /// Gives chain parameters whose deviation exceeds their expected size a prior, and solves again. How loose the prior
  /// is (1, 3 or 10 sizes) is decided by leave-one-pose-out: the tightest within 1 % of the best.
  std::vector<bool> restrain_weak(bool& solved) {
    const auto moved = static_cast<Index>(problem_.free().size());
    std::vector<bool> weak(static_cast<std::size_t>(moved), false);
    if (!options_.priors || moved == 0) return weak;
    const Linearisation& at = problem_.linearise();
    const VectorX variance = row_variance(at);
    const Precision free(at.jacobian, variance, problem_.prior());
    VectorX weight = VectorX::Zero(moved);
    for (Index k = 0; k < moved; ++k) {
      if (!Plan::in_chain(problem_.free()[static_cast<std::size_t>(k)])) continue;
      if (free.covariance.size() > 0 && free.covariance(k, k) <= 1) continue;
      weak[static_cast<std::size_t>(k)] = true;
      weight(k) = std::max(variance(0), 1e-12);
    }
    if (weight.maxCoeff() <= 0) return weak;

    struct Candidate {
      double error, scale;
      VectorX prior;
      typename Arm::Parameters values;
      bool solved;
    };
    std::vector<Candidate> candidates;
    const auto start = problem_.values();
    for (const double scale : {1.0, 3.0, 10.0}) {
      problem_.set_values(start);
      problem_.set_prior(weight / (scale * scale));
      const bool converged = problem_.solve();
      const Linearisation& there = problem_.linearise();
      const Precision precision(there.jacobian, row_variance(there), problem_.prior());
      candidates.push_back({leave_one_pose_out(there, data_.size(), precision.inverse), scale, problem_.prior(),
                            problem_.values(), converged});
    }
    double best = candidates.front().error;
    for (const auto& c : candidates) best = std::min(best, c.error);
    const auto chosen = std::find_if(candidates.begin(), candidates.end(),
                                     [&](const Candidate& c) { return !(c.error > 1.01 * best); });
    looseness_ = chosen->scale;
    problem_.set_prior(chosen->prior);
    problem_.set_values(chosen->values);
    solved = chosen->solved;
    return weak;
  }

  /// Of positions, or of distances.
  double position_rms(const Arm& arm) const {
    const PointRows points = positions(arm, data_.joints());
    if constexpr (of_distances)
      return std::sqrt((points.rowwise().norm() - data_.lengths()).squaredNorm() / size());
    else
      return std::sqrt((points - data_.positions()).squaredNorm() / size());
  }

  double rotation_rms(const Arm& arm) const {
    double sum = 0;
    if constexpr (!of_distances)
      for (Index i = 0; i < data_.size(); ++i)
        sum += log_so3(arm.pose(data_.joints(i)).linear() * data_.orientation(i).transpose()).squaredNorm();
    return std::sqrt(sum / size());
  }

  double size() const { return static_cast<double>(data_.size()); }

  void report(Identified<Chain>& out, const Precision& precision, const std::vector<bool>& weak) const {
    const auto before = start_.parameters();
    for (Index k = 0; k < before.size(); ++k)
      out.parameters.push_back({plan_.names[static_cast<std::size_t>(k)],
                                plan_.kinds[static_cast<std::size_t>(k)],
                                before(k),
                                problem_.values()(k),
                                0,
                                ParameterState::fixed,
                                {},
                                plan_.sizes(k)});
    if (precision.covariance.size() > 0)
      out.covariance = problem_.sizes().asDiagonal() * precision.covariance * problem_.sizes().asDiagonal();
    for (std::size_t k = 0; k < out.free.size(); ++k) {
      ParameterEstimate& p = out.parameters[static_cast<std::size_t>(out.free[k])];
      p.state = weak[k] ? ParameterState::weak : ParameterState::identified;
      if (weak[k]) p.prior = looseness_ * p.size;
      if (out.covariance.size() > 0) p.std = std::sqrt(out.covariance(static_cast<Index>(k), static_cast<Index>(k)));
    }
  }

  /// Why some did not move: by the structure of arm and sensor (so at random poses too), or for want of poses?
  void explain(Identified<Chain>& out, const Arm& arm, const Selection& columns) const {
    Rng rng(0);
    JointRows<N> joints(100, N);
    for (auto& q : joints.reshaped()) q = rng.uniform(-3, 3);
    const auto measured = [&] {  // without errors
      const PointRows points = positions(arm, joints);
      if constexpr (of_distances) {
        return Data(joints, points.rowwise().norm());
      } else {
        PointRows turns(problem_.oriented() ? joints.rows() : 0, 3);
        for (Index i = 0; i < turns.rows(); ++i)
          turns.row(i) = log_so3(arm.pose(joints.row(i).transpose()).linear()).transpose();
        return Data(joints, points, turns);
      }
    };
    VectorX sizes(static_cast<Index>(plan_.wanted.size()));
    for (Index k = 0; k < sizes.size(); ++k) sizes(k) = plan_.sizes(plan_.wanted[static_cast<std::size_t>(k)]);
    Linearisation ideal;
    ideal.evaluate(arm, measured(), problem_.oriented(), options_.position_sigma, options_.orientation_sigma,
                   plan_.wanted, sizes, true);
    const Selection structure(plan_.wanted, ideal.jacobian);

    for (const auto& d : columns.dependent) {
      ParameterEstimate& p = out.parameters[static_cast<std::size_t>(d.parameter)];
      p.state = ParameterState::not_identifiable;
      const auto structural = std::find_if(structure.dependent.begin(), structure.dependent.end(),
                                           [&](const auto& s) { return s.parameter == d.parameter; });
      const bool always = structural != structure.dependent.end();
      if (!always) out.status = IdentifyStatus::underdetermined;
      const auto& others = always ? structural->absorbed_by : d.absorbed_by;
      if (others.empty()) {
        p.remark = always ? "no effect on what was measured" : "no effect at these poses";
        continue;
      }
      p.remark = always ? "absorbed by " : "at these poses not told apart from ";
      for (std::size_t j = 0; j < others.size() && j < 4; ++j)
        p.remark += (j > 0 ? ", " : "") + plan_.names[static_cast<std::size_t>(others[j])];
      if (others.size() > 4) p.remark += ", ...";
    }
  }

  static constexpr bool of_distances = std::same_as<Data, Distances<N>>;

  const Chain& nominal_;
  const Data& data_;
  const IdentifyOptions& options_;
  Plan plan_;
  Arm start_;
  IdentificationProblem<Arm, Data> problem_;
  double looseness_ = 1;  // of the priors of weak parameters, in expected sizes
};

}  // namespace detail

}  // namespace vernier
