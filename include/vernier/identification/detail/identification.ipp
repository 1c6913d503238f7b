// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/frame_sharing.hpp"
#include "vernier/identification/detail/identification.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/detail/parameter_selection.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/least_squares/estimate_covariance.hpp"
#include "vernier/least_squares/evidence.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// The steps of `identify_geometry`.
class IdentificationRun {
 public:
  VERNIER_LOCAL IdentificationRun(const ArmGeometry& nominal, std::vector<MeasuredSet> sets,
                                  const IdentifyOptions& options, const SensorModel& sensors, GeometrySolver solver,
                                  bool own_tools)
      : options_(options),
        solver_(solver),
        plan_(nominal, options),
        starts_(starts(nominal, sets, options, own_tools)),
        problem_(ArmParameterisation(starts_, {}), std::move(sets), sensors.loss, sensors.joint_sigma) {
    problem_.joint_columns = false;
    const auto bases = frame_of_sets(problem_.sets(), true, own_tools, problem_.sets().size()),
               tools = frame_of_sets(problem_.sets(), false, own_tools, problem_.sets().size());
    for (const Index k : plan_.candidates) {
      const std::vector<GeometricUnknown> shared_by_all(1);
      for (GeometricUnknown one : plan_.in_chain(k) ? shared_by_all : k < plan_.chain_begin ? bases : tools) {
        one.parameter = k;
        one.scale = plan_.scales(k);
        all_.push_back(static_cast<Index>(candidates_.size()));
        if (!plan_.in_chain(k)) frames_.push_back(all_.back());
        candidates_.push_back(std::move(one));
      }
    }
  }

  VERNIER_LOCAL IdentifiedGeometry run() {
    // Frames alone first: a good start, and a fair figure of the nominal arm.
    estimate(select(frames_).base);
    solve();
    const ArmParameterisation registered = problem_.arm;
    const Rms rms_before = rms();

    // Then all that this arm with nominal links shows. What is dependent there on links alone may not be so at the
    // solution, where priors hold it. What is dependent on a frame is held: frames have no priors, and would move by
    // metres along what milliradians of found tilt show.
    ParameterSelection columns = select(all_);
    for (int round = 0; round < 3; ++round) {
      estimate(columns.base);
      solve();
      std::vector<Index> order = columns.base;
      std::vector<ParameterSelection::Dependent> held;
      for (const auto& d : columns.dependent)
        if (of_links(d))
          order.push_back(d.parameter);
        else
          held.push_back(d);
      ParameterSelection again = select(order);
      if (again.base.size() <= columns.base.size()) break;
      again.dependent.insert(again.dependent.end(), held.begin(), held.end());
      columns = std::move(again);
    }
    estimate(columns.base);
    const auto wanted = static_cast<Index>(columns.base.size());
    choose_links(registered);
    if (links_as_designed_)
      std::erase_if(columns.base, [&](Index k) { return plan_.in_chain(candidates_[at(k)].parameter); });

    const ArmGeometry identified = problem_.arm.geometry(0);
    const StackedRows rows = problem_.stacked(true);
    const EstimateCovariance covariance(rows.jacobian, row_variance(rows), problem_.arm.precisions(),
                                        VectorX::Constant(problem_.arm.size(), prior_scale_ * prior_scale_));
    IdentifiedGeometry out{identified, {}};
    IdentificationReport& report = out.report;
    report.message = message(summary_.message, " after ", iterations_, " iterations");
    report.rms_before = rms_before.length;
    report.rms_after = rms().length;
    report.rotation_rms_after = rms().angle;
    report.links_as_designed = links_as_designed_;
    report.residual_variance = variance_.size() > 0 ? variance_(0) : row_variance(rows)(0);
    report.rank = covariance.rank;
    report.condition = covariance.condition;
    report.iterations = iterations_;
    if (covariance.singular_values.size() > 0)
      report.observability = Observability::of(covariance.singular_values, problem_.num_blocks());
    describe_parameters(report, columns.base, identified, covariance);
    if (!columns.dependent.empty()) explain(report, registered, columns);
    report.too_few = problem_.measured_values() <= wanted;
    if (report.too_few) report.status = IdentifyStatus::underdetermined;
    if (report.status == IdentifyStatus::underdetermined)
      report.message =
          message(counted(problem_.num_blocks(), "pose gives ", "poses give "), problem_.measured_values(),
                  " measured values, which determine only ", wanted, " of the ", static_cast<Index>(candidates_.size()),
                  " parameters to be estimated", held_.empty() ? "" : "; held where they were: " + held_);
    if (!summary_.converged) {
      report.status = IdentifyStatus::not_converged;
      report.message = summary_.message;
    }
    return out;
  }

 private:
  static std::size_t at(Index k) { return static_cast<std::size_t>(k); }
  std::size_t num_free() const { return problem_.arm.geometric().size(); }

  /// The nominal arm in frames that roughly fit each set; a shared base, or tool, is that of the first.
  VERNIER_LOCAL static std::vector<ArmGeometry> starts(const ArmGeometry& nominal, std::vector<MeasuredSet>& sets,
                                                       const IdentifyOptions& options, bool own_tools) {
    std::vector<ArmGeometry> out;
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const std::size_t base = first_of_place(sets, s), tool = first_of_point(sets, s, own_tools);
      const ArmGeometry known = nominal.with_frames(base == s ? nominal.base() : out[base].base(),
                                                    tool == s ? nominal.tool() : out[tool].tool());
      out.push_back(
          starting_frames(known, sets[s], options.base_free() && base == s, options.tool_free() && tool == s));
    }
    return out;
  }

  /// Names the candidates to be estimated; present values stay, priors go.
  VERNIER_LOCAL void estimate(const std::vector<Index>& candidates) {
    std::vector<GeometricUnknown> unknowns;
    for (const Index k : candidates) unknowns.push_back(candidates_[at(k)]);
    problem_.arm.set_geometric(std::move(unknowns));
    weak_.assign(candidates.size(), false);
  }

  VERNIER_LOCAL void solve() {
    if (num_free() == 0) return;
    summary_ = solver_(problem_, options_.max_iterations);
    iterations_ += summary_.iterations;
  }

  /// Separates independent from dependent candidates at the present values.
  VERNIER_LOCAL ParameterSelection select(const std::vector<Index>& candidates) {
    estimate(candidates);
    return ParameterSelection(candidates, problem_.stacked(true).jacobian);
  }

  /// Whether a parameter and all that it depends on are of links.
  VERNIER_LOCAL bool of_links(const ParameterSelection::Dependent& d) const {
    const auto link = [&](Index k) { return plan_.in_chain(candidates_[at(k)].parameter); };
    return link(d.parameter) && std::all_of(d.absorbed_by.begin(), d.absorbed_by.end(), link);
  }

  /// Variance of whitened rows, one factor a sensor, from residuals; the sensors' own where there is no redundancy.
  VERNIER_LOCAL VectorX row_variance(const StackedRows& rows) const {
    const Index n = rows.residuals.size();
    VectorX out = VectorX::Ones(n);
    const double degrees = static_cast<double>(n) - static_cast<double>(num_free());
    if (degrees < 1) return out;
    for (const bool orientation : {false, true}) {
      double square_sum = 0, count = 0;
      std::vector<double> squares(at(problem_.num_blocks()), 0.0);
      for (Index i = 0; i < n; ++i) {
        if (rows.of_orientation[static_cast<std::size_t>(i)] != orientation) continue;
        const double square = rows.residuals(i) * rows.residuals(i);
        square_sum += square;
        ++count;
        squares[static_cast<std::size_t>(rows.block[static_cast<std::size_t>(i)])] += square;
      }
      if (count < 1) continue;
      double variance = square_sum / count;
      if (problem_.loss() != Loss::squared) {
        for (double& square : squares) square = std::sqrt(square);
        const double sigma = robust_sigma(std::move(squares), problem_.sets().front().projected() ? 1 : 3);
        variance = sigma * sigma;
      }
      for (Index i = 0; i < n; ++i)
        if (rows.of_orientation[static_cast<std::size_t>(i)] == orientation)
          out(i) = variance * static_cast<double>(n) / degrees;
    }
    return out;
  }

  /// Gives the links priors around nominal, and solves again. How wide these are, in expected sizes, follows from
  /// evidence, or is more where left-out poses support that. Whether the links stay as designed is decided by
  /// leave-one-pose-out errors, unless evidence speaks clearly.
  /// @param registered the arm as designed, its frames estimated
  VERNIER_LOCAL void choose_links(const ArmParameterisation& registered) {
    constexpr double first_scale = 3, clear_evidence = 3;  // twenty to one
    std::vector<GeometricUnknown> unknowns = problem_.arm.geometric();
    UnknownGroup links;
    for (std::size_t k = 0; k < unknowns.size(); ++k)
      if (plan_.in_chain(unknowns[k].parameter)) links.push_back(static_cast<Index>(k));
    if (!options_.priors || links.empty()) return;
    const StackedRows rows = problem_.stacked(true);
    variance_ = row_variance(rows);
    const VectorX none = VectorX::Zero(problem_.arm.size());
    const EstimateCovariance free(rows.jacobian, variance_, none, none);
    const double variance = (std::max)(variance_(0), 1e-12);
    for (const Index k : links) {
      weak_[at(k)] = !(free.covariance.size() > 0 && free.covariance(k, k) <= 1);
      unknowns[at(k)].precision = variance / (first_scale * first_scale);
    }
    problem_.arm.set_geometric(std::move(unknowns));
    solve();
    const NormalEquations normal(problem_.system());
    problem_.arm.set_precisions(
        scale_priors(normal, problem_.arm.precisions(), problem_.arm.steps(), problem_.measured_values(), links));
    const VectorX likely = problem_.arm.precisions();

    // Some links of an arm may be off by more than the rest: wider priors where left-out poses support them clearly.
    std::vector<ArmParameterisation> arms;
    std::vector<PriorTrial> trials;
    std::vector<double> evidences;
    for (const double wider : {10.0, 3.0, 1.0}) {
      problem_.arm.set_precisions(likely / (wider * wider));
      solve();
      auto [errors, evidence] = left_out();
      trials.push_back({1 / (wider * wider), std::move(errors)});
      evidences.push_back(evidence);
      arms.push_back(problem_.arm);
    }
    const std::size_t chosen = one_standard_error_rule(trials);
    const ArmParameterisation& estimated = arms[chosen];
    const VectorX& errors = trials[chosen].errors;
    prior_scale_ = std::sqrt(variance / estimated.precisions()(links.front()));
    problem_.arm = registered;
    const auto [errors_as_designed, evidence_as_designed] = left_out();
    const bool better = one_standard_error_rule({{0, errors}, {1, errors_as_designed}}) == 0;
    const bool clear =
        errors.mean() < errors_as_designed.mean() && evidences.back() > evidence_as_designed + clear_evidence;
    links_as_designed_ = !better && !clear;
    if (!links_as_designed_) {
      problem_.arm = estimated;
      return;
    }
    weak_.assign(registered.geometric().size(), false);
    summary_ = {true, 0, "the links stay as designed"};
  }

  /// Leave-one-pose-out errors of the problem as it is, and its evidence; infinite where nothing is estimated, so that
  /// errors alone decide.
  VERNIER_LOCAL std::pair<VectorX, double> left_out() {
    if (num_free() == 0) return {residual_norms(), std::numeric_limits<double>::infinity()};
    const VectorX precisions = problem_.arm.precisions(), steps = problem_.arm.steps();
    const NormalEquations unweighted(problem_.system());
    const double evidence = log_evidence(unweighted, FactorisedEquations(unweighted, precisions, steps), precisions,
                                         steps, problem_.measured_values());
    if (problem_.loss() != Loss::squared) problem_.reweight();
    const BlockSystem system = problem_.system();
    const NormalEquations normal(system);
    const FactorisedEquations solved(normal, precisions, steps);
    VectorX errors = error_norms(leave_one_out(system, solved, 1));
    problem_.reset_weights();
    return {std::move(errors), evidence};
  }

  /// Norms of the measured lengths' residuals [m]: where nothing is estimated, those of left-out poses.
  VERNIER_LOCAL VectorX residual_norms() const {
    VectorX out(problem_.num_blocks());
    SensedRows sensed;
    Index block = 0;
    for (int s = 0; s < problem_.arm.stations(); ++s) {
      const MeasuredSet& set = problem_.sets()[static_cast<std::size_t>(s)];
      const auto poses_of = [&](const MatrixX& joints) { return problem_.arm.geometry(s).poses(joints); };
      const std::vector<Isometry3> poses = set.seen_poses(poses_of);
      for (Index i = 0; i < set.size(); ++i) {
        set.sense(i, poses[at(i)], sensed);
        out(block++) = sensed.residual.head<3>().norm();
      }
    }
    return out;
  }

  /// Of the measured lengths [m] and angles [rad], 0 where there are none.
  struct Rms {
    double length = 0, angle = 0;
  };
  VERNIER_LOCAL Rms rms() const {
    Rms sum;
    SensedRows sensed;
    for (int s = 0; s < problem_.arm.stations(); ++s) {
      const MeasuredSet& set = problem_.sets()[static_cast<std::size_t>(s)];
      const auto poses_of = [&](const MatrixX& joints) { return problem_.arm.geometry(s).poses(joints); };
      const std::vector<Isometry3> poses = set.seen_poses(poses_of);
      for (Index i = 0; i < set.size(); ++i) {
        set.sense(i, poses[at(i)], sensed);
        sum.length += VERNIER_LATER(sensed.residual).template head<3>().squaredNorm();
        sum.angle += VERNIER_LATER(sensed.residual).template tail<3>().squaredNorm();
      }
    }
    const auto n = static_cast<double>(problem_.num_blocks());
    return {std::sqrt(sum.length / n), std::sqrt(sum.angle / n)};
  }

  /// Parameters of the arm in the frame of the first set.
  /// @param estimated candidates, in the order of the covariance
  VERNIER_LOCAL void describe_parameters(IdentificationReport& report, const std::vector<Index>& estimated,
                                         const ArmGeometry& identified, const EstimateCovariance& covariance) const {
    const VectorX before = starts_.front().parameters(), now = identified.parameters();
    for (Index k = 0; k < before.size(); ++k)
      report.parameters.push_back(
          {plan_.names[at(k)], plan_.kinds[at(k)], before(k), now(k), 0, ParameterState::fixed, {}, plan_.scales(k)});
    std::vector<Index> places;  // of those in the covariance
    for (std::size_t k = 0; k < estimated.size(); ++k) {
      const GeometricUnknown& candidate = candidates_[at(estimated[k])];
      if (candidate.station > 0) continue;
      report.free.push_back(candidate.parameter);
      places.push_back(static_cast<Index>(k));
    }
    const bool known = covariance.covariance.size() > 0;
    const auto n = static_cast<Index>(places.size());
    if (known) report.covariance.resize(n, n);
    for (Index a = 0; known && a < n; ++a)
      for (Index b = 0; b < n; ++b)
        report.covariance(a, b) = covariance.covariance(places[at(a)], places[at(b)]) *
                                  plan_.scales(report.free[at(a)]) * plan_.scales(report.free[at(b)]);
    for (Index k = 0; k < n; ++k) {
      ParameterEstimate& p = report.parameters[at(report.free[at(k)])];
      const bool weak = weak_[at(places[at(k)])];
      p.state = weak ? ParameterState::weak : ParameterState::identified;
      if (plan_.in_chain(report.free[at(k)]) && variance_.size() > 0) p.prior_std = prior_scale_ * p.scale;
      if (known) p.std = std::sqrt(report.covariance(k, k));
    }
  }

  /// Why parameters are dependent: by the structure of arm and sensor, so at random poses too, or for want of poses.
  VERNIER_LOCAL void explain(IdentificationReport& report, const ArmParameterisation& arm,
                             const ParameterSelection& columns) {
    Rng rng(0);
    std::vector<MeasuredSet> sets;
    std::vector<ArmGeometry> arms;
    for (int s = 0; s < arm.stations(); ++s) {
      MatrixX joints(100, arm.geometry(s).joints());
      for (Index k = 0; k < joints.size(); ++k) joints.data()[k] = rng.uniform(-3, 3);
      sets.push_back(problem_.sets()[static_cast<std::size_t>(s)].at_joints(std::move(joints)));
      arms.push_back(arm.geometry(s));
    }
    const CalibrationProblem random_poses(ArmParameterisation(std::move(arms), candidates_), std::move(sets),
                                          Loss::squared);
    const ParameterSelection structure(all_, random_poses.stacked(true).jacobian);

    for (const auto& d : columns.dependent) {
      const auto structural = std::find_if(structure.dependent.begin(), structure.dependent.end(),
                                           [&](const auto& s) { return s.parameter == d.parameter; });
      const bool always = structural != structure.dependent.end();
      if (!always) report.status = IdentifyStatus::underdetermined;
      if (candidates_[at(d.parameter)].station > 0) continue;
      ParameterEstimate& p = report.parameters[at(candidates_[at(d.parameter)].parameter)];
      p.state = ParameterState::not_identifiable;
      const auto& others = always ? structural->absorbed_by : d.absorbed_by;
      if (others.empty()) {
        if (!always) held_ += (held_.empty() ? "" : ", ") + p.name;
        p.remark = always ? "no effect on what was measured" : "no effect at these poses";
        continue;
      }
      if (!always) held_ += (held_.empty() ? "" : ", ") + p.name;
      p.remark = always ? "absorbed by " : "at these poses indistinguishable from ";
      for (std::size_t j = 0; j < others.size() && j < 4; ++j)
        p.remark += (j > 0 ? ", " : "") + plan_.names[at(candidates_[at(others[j])].parameter)];
      if (others.size() > 4) p.remark += ", ...";
    }
  }

  const IdentifyOptions& options_;
  GeometrySolver solver_;
  IdentificationPlan plan_;
  std::vector<GeometricUnknown> candidates_{};  // to be estimated, as the plan orders them
  std::vector<Index> all_{}, frames_{};         // numbers of the candidates, and of those of frames
  std::vector<ArmGeometry> starts_;             // of each set
  CalibrationProblem problem_;
  std::vector<bool> weak_;          // of the estimated candidates
  VectorX variance_{};              // of whitened rows, where the links have priors
  double prior_scale_ = 1;          // standard deviations of the priors of links, in expected sizes
  bool links_as_designed_ = false;  // left-out poses support no others
  std::string held_{};              // names of what these poses do not determine, but others would
  int iterations_ = 0;
  SolverSummary summary_{true, 0, "nothing to estimate"};
};

VERNIER_IMPL SolverSummary OwnSolver::operator()(CalibrationProblem& problem, int max_iterations) const {
  const IterationEnd end = problem.solve(max_iterations, 1e-14);
  problem.reset_weights();
  return {end.converged, end.iterations,
          end.converged ? "the steps vanished"
          : end.usable  ? "the steps did not vanish"
                        : "the normal equations have no solution"};
}

VERNIER_IMPL IdentifiedGeometry identify_geometry(const ArmGeometry& nominal, std::vector<MeasuredSet> sets,
                                                  const IdentifyOptions& options, const SensorModel& sensors,
                                                  GeometrySolver solver, bool own_tools) {
  demand(!sets.empty(), "identify: no measurements");
  for (const MeasuredSet& set : sets) demand(set.size() >= 1, "identify: no samples");
  sensors.validate();
  return IdentificationRun(nominal, std::move(sets), options, sensors, solver, own_tools).run();
}

}  // namespace vernier::detail
