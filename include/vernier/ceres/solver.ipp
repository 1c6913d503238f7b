// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The geometry solver of identification: the only file that includes Ceres.

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <utility>

#include "vernier/ceres/solver.hpp"

namespace vernier::detail {

/// A calibration problem as Ceres sees it: one parameter block, the steps of the estimated parameters. All rows are
/// linearised together before each evaluation; cost functions copy theirs.
class CeresProblem {
 public:
  VERNIER_LOCAL CeresProblem(CalibrationProblem& problem)
      : problem_(problem), steps_(problem.arm.steps()), evaluation_(*this) {}

  /// Minimises from the present values.
  /// @param thresholds of the loss, of positions, orientations and distances; null for least squares
  VERNIER_LOCAL SolverSummary solve(const std::array<double, 3>* thresholds, int max_iterations) {
    steps_ = problem_.arm.steps();
    ceres::Problem::Options options;
    options.evaluation_callback = &evaluation_;
    ceres::Problem ceres_problem(options);
    ceres_problem.AddParameterBlock(steps_.data(), static_cast<int>(steps_.size()));
    problem_.stack(true, rows_);
    if (thresholds == nullptr) {  // all in one: then linear algebra is what remains
      ceres_problem.AddResidualBlock(new Rows(*this, 0, rows_.residuals.size()), nullptr, steps_.data());
    } else {
      for (Index row = 0; row < rows_.residuals.size();) {
        const auto i = static_cast<std::size_t>(row);
        const MeasuredSet& set = problem_.set_of(rows_.block[i]);
        const bool projected = set.projected(), together = set.correlated() && set.oriented();
        const Index count = projected ? 1 : together ? 6 : 3;
        double threshold = (*thresholds)[projected ? 2 : rows_.of_orientation[i] ? 1 : 0];
        if (together) threshold *= std::sqrt(2.0);  // a norm of six rows, see `reweight`
        ceres_problem.AddResidualBlock(new Rows(*this, row, count), loss(threshold), steps_.data());
        row += count;
      }
    }
    const VectorX precisions = problem_.arm.precisions();
    if (precisions.maxCoeff() > 0) ceres_problem.AddResidualBlock(new PriorRows(precisions), nullptr, steps_.data());
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // columns are scaled and independent
    solver.max_num_iterations = max_iterations;
    solver.function_tolerance = 1e-12;  // Ceres' default of 1e-6 stops short of the sensor's noise
    solver.gradient_tolerance = 1e-16;
    solver.parameter_tolerance = 1e-13;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &ceres_problem, &summary);
    move_to(steps_);
    return {summary.termination_type == ceres::CONVERGENCE, static_cast<int>(summary.iterations.size()),
            summary.message};
  }

 private:
  VERNIER_LOCAL void move_to(const VectorX& steps) { problem_.arm.move(steps - problem_.arm.steps()); }

  /// Linearises all rows at a new point; with the Jacobian always: most steps are accepted, and then it is needed.
  struct Evaluation : ceres::EvaluationCallback {
    explicit Evaluation(CeresProblem& owner) : problem(owner) {}
    void PrepareForEvaluation(bool, bool new_point) override {
      if (!new_point) return;
      problem.move_to(problem.steps_);
      problem.problem_.stack(true, problem.rows_);
    }
    CeresProblem& problem;
  };

  /// Some rows of the shared linearisation.
  class Rows : public ceres::CostFunction {
   public:
    Rows(const CeresProblem& problem, Index row, Index count) : problem_(problem), row_(row), count_(count) {
      set_num_residuals(static_cast<int>(count));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.steps_.size()));
    }
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
      const StackedRows& rows = problem_.rows_;
      bool finite = true;
      for (Index i = 0; i < count_; ++i) {
        residuals[i] = rows.residuals(row_ + i);
        finite = finite && std::isfinite(residuals[i]);
      }
      if (jacobians != nullptr && jacobians[0] != nullptr) {
        const Index columns = rows.jacobian.cols();
        for (Index k = 0; k < columns; ++k)
          for (Index i = 0; i < count_; ++i) jacobians[0][i * columns + k] = rows.jacobian(row_ + i, k);
      }
      return finite;
    }

   private:
    const CeresProblem& problem_;
    Index row_, count_;
  };

  /// Steps weighted by their priors.
  class PriorRows : public ceres::CostFunction {
   public:
    explicit PriorRows(const VectorX& precisions) : root_(precisions.cwiseSqrt()) {
      set_num_residuals(static_cast<int>(root_.size()));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(root_.size()));
    }
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
      const Index n = root_.size();
      for (Index k = 0; k < n; ++k) residuals[k] = root_(k) * parameters[0][k];
      if (jacobians != nullptr && jacobians[0] != nullptr)
        for (Index k = 0; k < n * n; ++k) jacobians[0][k] = k % (n + 1) == 0 ? root_(k / (n + 1)) : 0;
      return true;
    }

   private:
    VectorX root_;
  };

  VERNIER_LOCAL ceres::LossFunction* loss(double threshold) const {
    if (!(threshold > 0)) return nullptr;
    if (problem_.loss() == Loss::huber) return new ceres::HuberLoss(threshold);
    return new ceres::CauchyLoss(threshold);
  }

  CalibrationProblem& problem_;
  VectorX steps_;
  StackedRows rows_;
  Evaluation evaluation_;
};

VERNIER_IMPL SolverSummary CeresSolver::operator()(CalibrationProblem& problem, int max_iterations) const {
  CeresProblem ceres_problem(problem);
  SolverSummary out = ceres_problem.solve(nullptr, max_iterations);
  for (int round = 0; problem.loss() != Loss::squared && round < 4; ++round) {  // the scale of the loss settles
    const std::array<double, 3> thresholds = problem.thresholds();
    const SolverSummary more = ceres_problem.solve(&thresholds, max_iterations);
    out = {more.converged, out.iterations + more.iterations, more.message};
  }
  if (out.converged) out.message = "the steps vanished";
  return out;
}

}  // namespace vernier::detail
