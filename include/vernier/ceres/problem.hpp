#pragma once

/// @file
/// An identification as a Ceres problem.

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/identification/linearisation.hpp"

namespace vernier::detail {

/// Robust scale of the components of whitened residuals: 1.4826 times the median absolute value.
inline double robust_scale(const Eigen::Ref<const VectorX>& residuals) {
  std::vector<double> sizes(static_cast<std::size_t>(residuals.size()));
  for (Index i = 0; i < residuals.size(); ++i) sizes[static_cast<std::size_t>(i)] = std::abs(residuals(i));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return sizes.empty() ? 0 : 1.4826 * *middle;
}

/// Whether orientations were measured.
template <class Data>
bool has_orientations(const Data& data) {
  if constexpr (requires { data.has_orientations(); }) return data.has_orientations();
  return false;
}

/// A parametric arm, data, and the parameters that may move: one Ceres parameter block whose unit is the expected size
/// of each parameter. Poses are linearised together before each evaluation; cost functions hand out rows of that.
/// @tparam Data `Dataset` or `Distances` of the arm's joints
template <ParametricModel Arm, class Data>
class IdentificationProblem {
 public:
  static constexpr int dof = Arm::dof;
  static constexpr int group = std::same_as<Data, Distances<dof>> ? 1 : 3;  ///< rows that belong together
  using Parameters = typename Arm::Parameters;

  /// @param start  where to begin, and what priors pull towards
  /// @param sizes  expected size of each of its parameters
  IdentificationProblem(const Arm& start, const Data& data, const IdentifyOptions& options, VectorX sizes)
      : anchor_(start),
        values_(start.parameters()),
        data_(data),
        options_(options),
        oriented_(options.use_orientations && has_orientations(data)),
        all_sizes_(std::move(sizes)) {}

  bool oriented() const { return oriented_; }
  Index rows() const { return (oriented_ ? 2 : 1) * group * data_.size(); }
  const std::vector<Index>& free() const { return free_; }  ///< parameters that move
  const VectorX& sizes() const { return sizes_; }           ///< of the free ones
  const VectorX& prior() const { return prior_; }           ///< inverse squared deviations, in steps of the sizes
  Arm arm() const { return anchor_.with_parameters(values_); }
  const Parameters& values() const { return values_; }
  void set_values(const Parameters& values) { values_ = values; }

  /// The present values become what priors pull towards.
  void anchor_here() { anchor_ = arm(); }

  /// Names what may move; the present values stay, priors go.
  void set_free(std::vector<Index> free) {
    free_ = std::move(free);
    sizes_.resize(static_cast<Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) sizes_(static_cast<Index>(k)) = all_sizes_(free_[k]);
    prior_ = VectorX::Zero(sizes_.size());
  }
  void set_prior(const VectorX& weights) { prior_ = weights; }

  /// Residuals and Jacobian at the present values; valid until the next call or solve.
  const Linearisation& linearise() { return linearise(values_, true); }

  /// Least squares from the present values; a robust loss settles its scale in further rounds.
  /// @return whether the solver converged
  bool solve() {
    if (free_.empty()) return true;
    bool converged = run(0, 0);
    for (int round = 0; options_.loss != Loss::squared && round < 4; ++round) {
      const Linearisation& at = linearise(values_, false);
      const Index n = group * data_.size();
      constexpr double bend = group == 1 ? 1.345 : 2.8;  // of a number, or of the norm of a 3-vector
      converged =
          run(bend * robust_scale(at.residuals.head(n)), oriented_ ? bend * robust_scale(at.residuals.tail(n)) : 0);
    }
    return converged;
  }

  int iterations() const { return iterations_; }           ///< of all solves
  const std::string& message() const { return message_; }  ///< of the last solve

 private:
  /// The linearisation shared by all cost functions of an evaluation.
  struct Preparation : ceres::EvaluationCallback {
    Preparation(IdentificationProblem& owner, const VectorX& point) : problem(owner), steps(point), at(owner.at_) {}
    /// With the Jacobian always: most steps are accepted, and then it is asked for.
    void PrepareForEvaluation(bool, bool new_point) override {
      if (new_point) problem.linearise(problem.values_at(steps), true);
    }
    IdentificationProblem& problem;
    const VectorX& steps;
    const Linearisation& at;
  };

  /// Some rows of the shared linearisation.
  class Rows : public ceres::CostFunction {
   public:
    Rows(const Preparation& preparation, Index row, Index count) : preparation_(preparation), row_(row), count_(count) {
      set_num_residuals(static_cast<int>(count));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(preparation.steps.size()));
    }
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<VectorX> out(residuals, count_);
      out = preparation_.at.residuals.segment(row_, count_);
      if (jacobians != nullptr && jacobians[0] != nullptr)
        Eigen::Map<RowMajor>(jacobians[0], count_, preparation_.steps.size()) =
            preparation_.at.jacobian.middleRows(row_, count_);
      return out.allFinite();
    }

   private:
    const Preparation& preparation_;
    Index row_, count_;
  };

  /// Steps weighed by their priors.
  class PriorRows : public ceres::CostFunction {
   public:
    explicit PriorRows(const VectorX& weights) : root_(weights.cwiseSqrt()) {
      set_num_residuals(static_cast<int>(root_.size()));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(root_.size()));
    }
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
      const Index n = root_.size();
      Eigen::Map<VectorX>(residuals, n) = root_.cwiseProduct(Eigen::Map<const VectorX>(parameters[0], n));
      if (jacobians != nullptr && jacobians[0] != nullptr) Eigen::Map<MatrixX>(jacobians[0], n, n) = root_.asDiagonal();
      return true;
    }

   private:
    VectorX root_;
  };

  Parameters values_at(const VectorX& steps) const {
    Parameters p = values_;
    const Parameters anchor = anchor_.parameters();
    for (std::size_t k = 0; k < free_.size(); ++k)
      p(free_[k]) = anchor(free_[k]) + sizes_(static_cast<Index>(k)) * steps(static_cast<Index>(k));
    return p;
  }

  const Linearisation& linearise(const Parameters& values, bool with_jacobian) {
    at_.evaluate(anchor_.with_parameters(values), data_, oriented_, options_.position_sigma, options_.orientation_sigma,
                 free_, sizes_, with_jacobian);
    return at_;
  }

  /// One solve; a scale above zero is the residual size at which a robust loss starts to bend.
  bool run(double position_scale, double orientation_scale) {
    VectorX steps(sizes_.size());
    const Parameters anchor = anchor_.parameters();
    for (std::size_t k = 0; k < free_.size(); ++k)
      steps(static_cast<Index>(k)) = (values_(free_[k]) - anchor(free_[k])) / sizes_(static_cast<Index>(k));
    Preparation preparation(*this, steps);
    ceres::Problem::Options problem_options;
    problem_options.evaluation_callback = &preparation;
    ceres::Problem problem(problem_options);
    problem.AddParameterBlock(steps.data(), static_cast<int>(steps.size()));
    if (options_.loss == Loss::squared) {  // all in one: then linear algebra is what remains
      problem.AddResidualBlock(new Rows(preparation, 0, rows()), nullptr, steps.data());
    } else {
      for (Index row = 0; row < rows(); row += group)
        problem.AddResidualBlock(new Rows(preparation, row, group),
                                 loss(row < group * data_.size() ? position_scale : orientation_scale), steps.data());
    }
    if (prior_.maxCoeff() > 0) problem.AddResidualBlock(new PriorRows(prior_), nullptr, steps.data());
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // columns are scaled and told apart before
    solver.max_num_iterations = options_.max_iterations;
    solver.function_tolerance = 1e-12;  // Ceres' default of 1e-6 stops short of the sensor's noise
    solver.gradient_tolerance = 1e-16;
    solver.parameter_tolerance = 1e-13;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    values_ = values_at(steps);
    iterations_ += static_cast<int>(summary.iterations.size());
    const bool converged = summary.termination_type == ceres::CONVERGENCE;
    message_ = converged ? vernier::message("the steps died away after ", iterations_, " iterations") : summary.message;
    return converged;
  }

  ceres::LossFunction* loss(double scale) const {
    if (options_.loss == Loss::squared || !(scale > 0)) return nullptr;
    if (options_.loss == Loss::huber) return new ceres::HuberLoss(scale);
    return new ceres::CauchyLoss(scale);
  }

  Arm anchor_;
  Parameters values_;
  const Data& data_;
  const IdentifyOptions& options_;
  bool oriented_;
  VectorX all_sizes_;
  std::vector<Index> free_;
  VectorX sizes_, prior_;
  Linearisation at_;  // kept for its storage
  int iterations_ = 0;
  std::string message_ = "nothing to move";
};

}  // namespace vernier::detail
