#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/identification.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identifiable_parameters.hpp"
#include "vernier/least_squares/estimate_covariance.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// `IdentifiableParameters` by parameter.
struct ParameterSelection {
  struct Dependent {
    Index parameter;
    std::vector<Index> absorbed_by;
  };
  std::vector<Index> base;
  std::vector<Dependent> dependent;

  VERNIER_LOCAL ParameterSelection(const std::vector<Index>& candidates, const MatrixX& jacobian) {
    const IdentifiableParameters columns(jacobian);
    const auto parameters = [&](const std::vector<Index>& which) {
      std::vector<Index> out;
      for (const Index k : which) out.push_back(candidates[static_cast<std::size_t>(k)]);
      return out;
    };
    base = parameters(columns.base);
    for (const auto& d : columns.dependent)
      dependent.push_back({candidates[static_cast<std::size_t>(d.column)], parameters(d.absorbed_by)});
  }
};

/// The steps of `identify_geometry`.
class IdentificationRun {
 public:
  VERNIER_LOCAL IdentificationRun(const ArmGeometry& nominal, const MeasuredSet& data, const IdentifyOptions& options,
                                  const SensorModel& sensors, GeometrySolver solver)
      : options_(options),
        solver_(solver),
        plan_(nominal, options),
        start_(starting_frames(nominal, data, options.base_free(), options.tool_free())),
        problem_(ArmParameterisation({start_}, {}), {data}, sensors.loss, sensors.joint_sigma) {
    problem_.joint_columns = false;
  }

  VERNIER_LOCAL IdentifiedGeometry run() {
    // Frames alone first: a good start, and a fair figure of the nominal arm.
    estimate(select(plan_.frames).base);
    solve();
    const ArmGeometry registered = problem_.arm.geometry(0);

    // Then all that this arm with nominal links shows. What is dependent there on links alone may not be so at the
    // solution, where priors hold it. What is dependent on a frame is held: frames have no priors, and would move by
    // metres along what milliradians of found tilt show.
    ParameterSelection columns = select(plan_.candidates);
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
    regularise_weak();

    const ArmGeometry identified = problem_.arm.geometry(0);
    const StackedRows rows = problem_.stacked(true);
    const EstimateCovariance covariance(rows.jacobian, row_variance(rows), problem_.arm.precisions(),
                                        VectorX::Constant(problem_.arm.size(), prior_scale_ * prior_scale_));
    IdentifiedGeometry out{identified, {}};
    IdentificationReport& report = out.report;
    report.message = message(summary_.message, " after ", iterations_, " iterations");
    report.rms_before = rms(registered).length;
    report.rms_after = rms(identified).length;
    report.rotation_rms_after = rms(identified).angle;
    report.free = columns.base;
    report.rank = covariance.rank;
    report.condition = covariance.condition;
    report.iterations = iterations_;
    if (covariance.singular_values.size() > 0)
      report.observability = Observability::of(covariance.singular_values, data().size());
    describe_parameters(report, identified, covariance);
    if (!columns.dependent.empty()) explain(report, registered, columns);
    const auto estimated = static_cast<Index>(report.free.size());
    if (problem_.measured_values() <= estimated) report.status = IdentifyStatus::underdetermined;
    if (report.status == IdentifyStatus::underdetermined)
      report.message = message(counted(data().size(), "pose gives ", "poses give "), problem_.measured_values(),
                               " measured values, which determine only ", estimated, " of the ",
                               static_cast<Index>(plan_.candidates.size()), " parameters to be estimated");
    if (!summary_.converged) {
      report.status = IdentifyStatus::not_converged;
      report.message = summary_.message;
    }
    return out;
  }

 private:
  const MeasuredSet& data() const { return problem_.sets().front(); }
  std::size_t num_free() const { return problem_.arm.geometric().size(); }

  /// Names the parameters to be estimated; present values stay, priors go.
  VERNIER_LOCAL void estimate(const std::vector<Index>& parameters) {
    std::vector<GeometricUnknown> unknowns;
    for (const Index k : parameters) unknowns.push_back({k, -1, plan_.scales(k), 0});
    problem_.arm.set_geometric(std::move(unknowns));
    weak_.assign(parameters.size(), false);
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
    const auto link = [&](Index k) { return plan_.in_chain(k); };
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
      std::vector<double> squares(static_cast<std::size_t>(data().size()), 0.0);
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
        const double sigma = robust_sigma(std::move(squares), data().projected() ? 1 : 3);
        variance = sigma * sigma;
      }
      for (Index i = 0; i < n; ++i)
        if (rows.of_orientation[static_cast<std::size_t>(i)] == orientation)
          out(i) = variance * static_cast<double>(n) / degrees;
    }
    return out;
  }

  /// Gives chain parameters whose standard deviation exceeds their expected size a prior, and solves again. How wide
  /// the prior is, 1, 3 or 10 sizes, is decided by leave-one-pose-out errors.
  VERNIER_LOCAL void regularise_weak() {
    if (!options_.priors || num_free() == 0) return;
    const std::vector<GeometricUnknown> unknowns = problem_.arm.geometric();
    const StackedRows rows = problem_.stacked(true);
    const VectorX variance = row_variance(rows), none = VectorX::Zero(problem_.arm.size());
    const EstimateCovariance free(rows.jacobian, variance, none, none);
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      const auto i = static_cast<Index>(k);
      weak_[k] = plan_.in_chain(unknowns[k].parameter) && !(free.covariance.size() > 0 && free.covariance(i, i) <= 1);
    }
    if (std::find(weak_.begin(), weak_.end(), true) == weak_.end()) return;

    struct Candidate {
      double prior_scale;
      ArmParameterisation arm;
      SolverSummary summary;
    };
    std::vector<Candidate> candidates;
    std::vector<PriorTrial> trials;
    const ArmParameterisation start = problem_.arm;
    for (const double prior_scale : {10.0, 3.0, 1.0}) {
      problem_.arm = start;
      std::vector<GeometricUnknown> regularised = unknowns;
      for (std::size_t k = 0; k < unknowns.size(); ++k)
        if (weak_[k]) regularised[k].precision = (std::max)(variance(0), 1e-12) / (prior_scale * prior_scale);
      problem_.arm.set_geometric(std::move(regularised));
      solve();
      if (problem_.loss() != Loss::squared) problem_.reweight();
      const BlockSystem system = problem_.system();
      const NormalEquations normal(system);
      const FactorisedEquations solved(normal, problem_.arm.precisions(), problem_.arm.steps());
      trials.push_back({1 / (prior_scale * prior_scale), error_norms(leave_one_out(system, solved, 1))});
      problem_.reset_weights();
      candidates.push_back({prior_scale, problem_.arm, summary_});
    }
    const Candidate& chosen = candidates[one_standard_error_rule(trials)];
    prior_scale_ = chosen.prior_scale;
    problem_.arm = chosen.arm;
    summary_ = chosen.summary;
  }

  /// Of the measured lengths [m] and angles [rad], 0 where there are none.
  struct Rms {
    double length = 0, angle = 0;
  };
  VERNIER_LOCAL Rms rms(const ArmGeometry& arm) const {
    Rms sum;
    SensedRows sensed;
    const auto poses_of = [&](const MatrixX& joints) { return arm.poses(joints); };
    const std::vector<Isometry3> poses = data().seen_poses(poses_of);
    for (Index i = 0; i < data().size(); ++i) {
      data().sense(i, poses[static_cast<std::size_t>(i)], sensed);
      sum.length += VERNIER_LATER(sensed.residual).template head<3>().squaredNorm();
      sum.angle += VERNIER_LATER(sensed.residual).template tail<3>().squaredNorm();
    }
    const auto n = static_cast<double>(data().size());
    return {std::sqrt(sum.length / n), std::sqrt(sum.angle / n)};
  }

  VERNIER_LOCAL void describe_parameters(IdentificationReport& report, const ArmGeometry& identified,
                                         const EstimateCovariance& covariance) const {
    const VectorX before = start_.parameters(), now = identified.parameters();
    for (Index k = 0; k < before.size(); ++k)
      report.parameters.push_back({plan_.names[static_cast<std::size_t>(k)],
                                   plan_.kinds[static_cast<std::size_t>(k)],
                                   before(k),
                                   now(k),
                                   0,
                                   ParameterState::fixed,
                                   {},
                                   plan_.scales(k)});
    const VectorX scales = problem_.arm.scales();
    if (covariance.covariance.size() > 0)
      report.covariance = rows_scaled(scales, columns_scaled(covariance.covariance, scales));
    for (std::size_t k = 0; k < report.free.size(); ++k) {
      ParameterEstimate& p = report.parameters[static_cast<std::size_t>(report.free[k])];
      p.state = weak_[k] ? ParameterState::weak : ParameterState::identified;
      if (weak_[k]) p.prior_std = prior_scale_ * p.scale;
      const auto i = static_cast<Index>(k);
      if (report.covariance.size() > 0) p.std = std::sqrt(report.covariance(i, i));
    }
  }

  /// Why parameters are dependent: by the structure of arm and sensor, so at random poses too, or for want of poses.
  VERNIER_LOCAL void explain(IdentificationReport& report, const ArmGeometry& arm, const ParameterSelection& columns) {
    Rng rng(0);
    MatrixX joints(100, arm.joints());
    for (Index k = 0; k < joints.size(); ++k) joints.data()[k] = rng.uniform(-3, 3);
    std::vector<GeometricUnknown> unknowns;
    for (const Index k : plan_.candidates) unknowns.push_back({k, -1, plan_.scales(k), 0});
    const CalibrationProblem random_poses(ArmParameterisation({arm}, std::move(unknowns)),
                                          {data().at_joints(std::move(joints))}, Loss::squared);
    const ParameterSelection structure(plan_.candidates, random_poses.stacked(true).jacobian);

    for (const auto& d : columns.dependent) {
      ParameterEstimate& p = report.parameters[static_cast<std::size_t>(d.parameter)];
      p.state = ParameterState::not_identifiable;
      const auto structural = std::find_if(structure.dependent.begin(), structure.dependent.end(),
                                           [&](const auto& s) { return s.parameter == d.parameter; });
      const bool always = structural != structure.dependent.end();
      if (!always) report.status = IdentifyStatus::underdetermined;
      const auto& others = always ? structural->absorbed_by : d.absorbed_by;
      if (others.empty()) {
        p.remark = always ? "no effect on what was measured" : "no effect at these poses";
        continue;
      }
      p.remark = always ? "absorbed by " : "at these poses indistinguishable from ";
      for (std::size_t j = 0; j < others.size() && j < 4; ++j)
        p.remark += (j > 0 ? ", " : "") + plan_.names[static_cast<std::size_t>(others[j])];
      if (others.size() > 4) p.remark += ", ...";
    }
  }

  const IdentifyOptions& options_;
  GeometrySolver solver_;
  IdentificationPlan plan_;
  ArmGeometry start_;
  CalibrationProblem problem_;
  std::vector<bool> weak_;  // of the estimated parameters
  double prior_scale_ = 1;  // standard deviations of the priors of weak parameters, in expected sizes
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

VERNIER_IMPL IdentifiedGeometry identify_geometry(const ArmGeometry& nominal, const MeasuredSet& data,
                                                  const IdentifyOptions& options, const SensorModel& sensors,
                                                  GeometrySolver solver) {
  demand(data.size() >= 1, "identify: no samples");
  sensors.validate();
  return IdentificationRun(nominal, data, options, sensors, solver).run();
}

}  // namespace vernier::detail
