#pragma once

/// @file
/// Identification of an arm's geometry and frames by nonlinear least squares in Ceres.

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identifiability.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/linearisation.hpp"
#include "vernier/identification/options.hpp"

namespace vernier {

namespace detail {

/// One identification: a framed model, data, and the parameters that may move, as a Ceres problem of one parameter
/// block whose unit is the expected size of each parameter. Poses are linearised together before each evaluation; cost
/// functions hand out rows.
template <ParametricModel Arm>
class IdentificationProblem {
 public:
  static constexpr int dof = Arm::dof;
  using Parameters = typename Arm::Parameters;

  IdentificationProblem(const Arm& start, const Dataset<dof>& data, const IdentifyOptions& options)
      : start_(start), start_values_(start.parameters()), data_(&data), options_(&options) {}

  bool oriented() const { return options_->use_orientations && data_->has_orientations(); }
  Index rows() const { return (oriented() ? 6 : 3) * data_->size(); }
  const std::vector<Index>& free() const { return free_; }
  const VectorX& sizes() const { return sizes_; }
  const VectorX& prior() const { return prior_; }

  /// Names the parameters that may move, in units of `sizes`; none has a prior yet.
  void set_free(std::vector<Index> free, const VectorX& all_sizes) {
    free_ = std::move(free);
    sizes_.resize(static_cast<Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) sizes_(static_cast<Index>(k)) = all_sizes(free_[k]);
    prior_ = VectorX::Zero(sizes_.size());
    steps_ = VectorX::Zero(sizes_.size());
  }
  /// Weight of the prior of the k-th free parameter: inverse squared deviation, in units of its size.
  void set_prior(Index k, double weight) { prior_(k) = weight; }

  Arm arm(const VectorX& steps) const {
    Parameters p = start_values_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      p(free_[k]) += sizes_(static_cast<Index>(k)) * steps(static_cast<Index>(k));
    return start_.with_parameters(p);
  }
  Arm arm() const { return arm(steps_); }

  Linearisation linearise(const VectorX& steps, bool with_jacobian) const {
    Linearisation out;
    out.evaluate(arm(steps), *data_, oriented(), options_->position_sigma, options_->orientation_sigma, free_, sizes_,
                 with_jacobian);
    return out;
  }
  Linearisation linearise() const { return linearise(steps_, true); }

  /// Minimises from where it stands. `scale` > 0 is the residual size at which a robust loss starts to bend.
  ceres::Solver::Summary solve(double position_scale, double orientation_scale) {
    ceres::Solver::Summary summary;
    if (free_.empty()) return summary;
    Preparation preparation{*this};
    ceres::Problem::Options problem_options;
    problem_options.evaluation_callback = &preparation;
    ceres::Problem problem(problem_options);
    problem.AddParameterBlock(steps_.data(), static_cast<int>(steps_.size()));
    for (Index row = 0; row < rows(); row += 3)
      problem.AddResidualBlock(new Rows(preparation, row),
                               loss(row < 3 * data_->size() ? position_scale : orientation_scale), steps_.data());
    if (prior_.maxCoeff() > 0) problem.AddResidualBlock(new PriorRows(prior_), nullptr, steps_.data());
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = options_->max_iterations;
    solver.function_tolerance = 1e-14;  // Ceres' default of 1e-6 stops short of the sensor's noise
    solver.gradient_tolerance = 1e-16;
    solver.parameter_tolerance = 1e-13;
    solver.logging_type = ceres::SILENT;
    ceres::Solve(solver, &problem, &summary);
    return summary;
  }

 private:
  /// The linearisation shared by all cost functions of an evaluation.
  struct Preparation : ceres::EvaluationCallback {
    explicit Preparation(IdentificationProblem& owner) : problem(owner) {}
    void PrepareForEvaluation(bool with_jacobian, bool new_point) override {
      if (new_point || (with_jacobian && !has_jacobian)) {
        at = problem.linearise(problem.steps_, with_jacobian);
        has_jacobian = with_jacobian;
      }
    }
    IdentificationProblem& problem;
    Linearisation at;
    bool has_jacobian = false;
  };

  /// Three rows of the shared linearisation.
  class Rows : public ceres::CostFunction {
   public:
    Rows(const Preparation& preparation, Index row) : preparation_(preparation), row_(row) {
      set_num_residuals(3);
      mutable_parameter_block_sizes()->push_back(static_cast<int>(preparation.problem.steps_.size()));
    }
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
      Eigen::Map<Vector3>{residuals} = preparation_.at.residuals.template segment<3>(row_);
      if (jacobians != nullptr && jacobians[0] != nullptr)
        Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(
            jacobians[0], 3, preparation_.at.jacobian.cols()) = preparation_.at.jacobian.template middleRows<3>(row_);
      return Eigen::Map<const Vector3>(residuals).allFinite();
    }

   private:
    const Preparation& preparation_;
    Index row_;
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

  ceres::LossFunction* loss(double scale) const {
    if (options_->loss == Loss::squared || !(scale > 0)) return nullptr;
    if (options_->loss == Loss::huber) return new ceres::HuberLoss(scale);
    return new ceres::CauchyLoss(scale);
  }

  Arm start_;
  Parameters start_values_;
  const Dataset<dof>* data_;
  const IdentifyOptions* options_;
  std::vector<Index> free_;
  VectorX sizes_, prior_, steps_;
};

/// Robust scale of the components of whitened 3-vector residuals: 1.4826 times the median absolute value.
inline double robust_scale(const Eigen::Ref<const VectorX>& residuals) {
  std::vector<double> sizes(static_cast<std::size_t>(residuals.size()));
  for (Index i = 0; i < residuals.size(); ++i) sizes[static_cast<std::size_t>(i)] = std::abs(residuals(i));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return sizes.empty() ? 0 : 1.4826 * *middle;
}

}  // namespace detail

/// Identify the geometry of an arm and its base and tool frames from measured poses (Levenberg-Marquardt).
///
/// Parameters that cannot be told apart from others by these measurements keep their values and are named; those that
/// are hardly determined get a prior of physical size, so that nothing runs off; a problem with too little data says
/// so.
/// @param nominal the arm as designed
/// @param data    n >= 1 samples; joints in rad (or m), positions in m. Orientations count where there are any. Read
/// only, not kept.
/// @param options which parameters may move, sigmas, loss, priors
/// @return        model, status, rms before and after [m], rank, condition, named covariance (empty when
/// rank-deficient)
/// @throws std::invalid_argument on no data or an unusable option, never for poor data
/// @complexity    O(n * free^2) per iteration; allocates
/// @cite Hayati and Mirmirani 1985; Everett, Driels and Mooring 1987; Schroer 1997
template <int N, class Convention>
Identified<DhChain<N, Convention>> identify(const DhChain<N, Convention>& nominal, const Dataset<N>& data,
                                            const IdentifyOptions& options = {}) {
  using Chain = DhChain<N, Convention>;
  using Arm = Framed<Chain>;
  constexpr Index chain_begin = 6, chain_end = 6 + Chain::num_parameters;
  const std::vector<std::string> names = Arm::parameter_names();
  const std::vector<ParameterKind> kinds = Arm::parameter_kinds();
  options.validate(names);
  require(data.size() >= 1, "identify: no samples");
  const bool oriented = options.use_orientations && data.has_orientations();

  // Expected sizes, and what may move in which order of preference: frames first, so that the ends of the chain give
  // way.
  VectorX sizes(Arm::num_parameters);
  std::vector<bool> wanted(static_cast<std::size_t>(Arm::num_parameters), false);
  for (Index k = 0; k < Arm::num_parameters; ++k) {
    const bool length = kinds[static_cast<std::size_t>(k)] == ParameterKind::length;
    const bool chain = k >= chain_begin && k < chain_end;
    const auto parameter = static_cast<DhParameter>((k - chain_begin) % 5);
    sizes(k) = length                                     ? options.length_size
               : chain && parameter == DhParameter::theta ? options.joint_zero_size
                                                          : options.angle_size;
    if (!chain) sizes(k) = 10e-3;
    wanted[static_cast<std::size_t>(k)] = chain             ? options.geometry && parameter != DhParameter::beta
                                          : k < chain_begin ? options.base_free()
                                                            : options.tool_free();
  }
  if (options.hayati && options.geometry)
    for (const int row : parallel_rows(nominal)) {
      wanted[static_cast<std::size_t>(chain_begin + 5 * row + static_cast<int>(DhParameter::beta))] = true;
      wanted[static_cast<std::size_t>(chain_begin + 5 * row + static_cast<int>(DhParameter::d))] = false;
    }
  for (const auto& name : options.fixed)
    wanted[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())] = false;
  std::vector<Index> frames, all;
  for (const auto& [begin, end] :
       {std::pair{Index{0}, chain_begin}, {chain_end, Index{Arm::num_parameters}}, {chain_begin, chain_end}})
    for (Index k = begin; k < end; ++k)
      if (wanted[static_cast<std::size_t>(k)]) {
        all.push_back(k);
        if (k < chain_begin || k >= chain_end) frames.push_back(k);
      }

  const Arm start =
      starting_frames(nominal, data, options.base_start.value_or(Isometry3::Identity()),
                      options.tool_start.value_or(Isometry3::Identity()), options.base_free(), options.tool_free());
  int iterations = 0;

  // Frames alone first: a good start, and the honest "before".
  detail::IdentificationProblem<Arm> problem(start, data, options);
  const auto independent = [&](const std::vector<Index>& candidates) {
    problem.set_free(candidates, sizes);
    return detail::IndependentColumns(problem.linearise().jacobian);
  };
  const auto pick = [](const std::vector<Index>& from, const std::vector<Index>& which) {
    std::vector<Index> out;
    for (const Index k : which) out.push_back(from[static_cast<std::size_t>(k)]);
    return out;
  };
  const auto position_scale = [&](const detail::Linearisation& at) {
    return 2.8 * detail::robust_scale(at.residuals.head(3 * data.size()));
  };
  const auto orientation_scale = [&](const detail::Linearisation& at) {
    return oriented ? 2.8 * detail::robust_scale(at.residuals.tail(3 * data.size())) : 0.0;
  };
  bool solved = true;
  std::string solver_message = "nothing to move";
  const auto solve = [&] {
    for (int round = 0; round < (options.loss == Loss::squared ? 1 : 4);
         ++round) {  // a robust scale settles in a few rounds
      const detail::Linearisation at = problem.linearise();
      const auto summary = round == 0 ? problem.solve(0, 0) : problem.solve(position_scale(at), orientation_scale(at));
      iterations += static_cast<int>(summary.iterations.size());
      solved = problem.free().empty() || summary.termination_type == ceres::CONVERGENCE;
      if (!problem.free().empty()) solver_message = summary.message;
    }
  };
  problem.set_free(pick(frames, independent(frames).kept), sizes);
  solve();
  const Arm registered = problem.arm();
  const auto position_rms = [&](const Arm& arm) {
    return std::sqrt((positions(arm, data.joints()) - data.positions()).rowwise().squaredNorm().mean());
  };

  // Then everything that the measurements can tell apart.
  problem = detail::IdentificationProblem<Arm>(registered, data, options);
  const detail::IndependentColumns columns = independent(all);
  problem.set_free(pick(all, columns.kept), sizes);
  solve();

  // Deviations from the residuals; what is hardly determined gets a prior, and the rest is solved again.
  const Index n = data.size(), moved = static_cast<Index>(problem.free().size());
  const auto row_variance = [&](const detail::Linearisation& at) {
    VectorX out = VectorX::Ones(at.residuals.size());
    const double degrees = static_cast<double>(at.residuals.size() - moved);
    if (degrees < 1) return out;  // nothing left to estimate it from: the sensor's sigmas
    const double correction = static_cast<double>(at.residuals.size()) / degrees;
    const auto variance = [&](Index begin) {
      const auto part = at.residuals.segment(begin, 3 * n);
      const double scale = options.loss == Loss::squared
                               ? std::sqrt(part.squaredNorm() / static_cast<double>(part.size()))
                               : detail::robust_scale(part);
      return correction * scale * scale;
    };
    out.head(3 * n).setConstant(variance(0));
    if (oriented) out.tail(3 * n).setConstant(variance(3 * n));
    return out;
  };
  detail::Linearisation at = problem.linearise();
  detail::Precision precision(at.jacobian, row_variance(at), problem.prior());
  std::vector<bool> weak(static_cast<std::size_t>(moved), false);
  for (int round = 0; options.priors && round < 3; ++round) {
    bool more = false;
    const double variance = row_variance(at)(0);
    for (Index k = 0; k < moved; ++k) {
      const Index parameter = problem.free()[static_cast<std::size_t>(k)];
      if (weak[static_cast<std::size_t>(k)] || parameter < chain_begin || parameter >= chain_end) continue;
      if (precision.covariance.size() > 0 && precision.covariance(k, k) <= 1) continue;
      weak[static_cast<std::size_t>(k)] = more = true;
      problem.set_prior(k, std::max(variance, 1e-12));
    }
    if (!more) break;
    solve();
    at = problem.linearise();
    precision = detail::Precision(at.jacobian, row_variance(at), problem.prior());
  }

  const Arm arm = problem.arm();
  Identified<Chain> out{Calibrated<Chain>(arm, nominal),
                        IdentifyStatus::converged,
                        solver_message,
                        position_rms(registered),
                        position_rms(arm),
                        0,
                        {},
                        problem.free(),
                        {},
                        precision.rank,
                        precision.condition,
                        iterations};
  if (oriented) {
    double sum = 0;
    for (Index i = 0; i < n; ++i)
      sum += log_so3(arm.pose(data.joints(i)).linear() * data.orientation(i).transpose()).squaredNorm();
    out.rotation_rms_after = std::sqrt(sum / static_cast<double>(n));
  }
  const auto before = start.parameters(), after = arm.parameters();
  for (Index k = 0; k < Arm::num_parameters; ++k)
    out.parameters.push_back({names[static_cast<std::size_t>(k)],
                              kinds[static_cast<std::size_t>(k)],
                              before(k),
                              after(k),
                              0,
                              ParameterState::fixed,
                              {}});
  if (precision.covariance.size() > 0)
    out.covariance = problem.sizes().asDiagonal() * precision.covariance * problem.sizes().asDiagonal();
  for (Index k = 0; k < moved; ++k) {
    ParameterEstimate& p = out.parameters[static_cast<std::size_t>(problem.free()[static_cast<std::size_t>(k)])];
    p.state = weak[static_cast<std::size_t>(k)] ? ParameterState::weak : ParameterState::identified;
    if (out.covariance.size() > 0) p.std = std::sqrt(out.covariance(k, k));
  }

  // Why the others did not move: by the structure of arm and sensor, or for want of poses?
  if (!columns.dependent.empty()) {
    Rng rng(20);
    JointRows<N> anywhere(100, N);
    for (Index i = 0; i < anywhere.rows(); ++i)
      for (int j = 0; j < N; ++j) anywhere(i, j) = rng.uniform(-3, 3);
    const Dataset<N> everywhere(anywhere, PointRows::Zero(100, 3),
                                data.has_orientations() ? PointRows(PointRows::Zero(100, 3)) : PointRows(0, 3));
    detail::Linearisation ideal;
    VectorX all_sizes(static_cast<Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k) all_sizes(static_cast<Index>(k)) = sizes(all[k]);
    ideal.evaluate(registered, everywhere, false, options.position_sigma, options.orientation_sigma, all, all_sizes,
                   true);
    if (oriented) {
      detail::Linearisation turned;
      turned.jacobian.resize(600, all_sizes.size());
      turned.jacobian.topRows(300) = ideal.jacobian;
      for (Index i = 0; i < 100; ++i) {
        const auto rates = registered.parameter_jacobian(everywhere.joints(i));
        for (std::size_t k = 0; k < all.size(); ++k)
          turned.jacobian.block<3, 1>(300 + 3 * i, static_cast<Index>(k)) =
              rates.col(all[k]).template tail<3>() * (all_sizes(static_cast<Index>(k)) / options.orientation_sigma);
      }
      ideal = turned;
    }
    const detail::IndependentColumns structure(ideal.jacobian);
    const auto structural = [&](Index column) {
      return std::any_of(structure.dependent.begin(), structure.dependent.end(),
                         [&](const auto& d) { return d.column == column; });
    };
    for (const auto& d : columns.dependent) {
      ParameterEstimate& p = out.parameters[static_cast<std::size_t>(all[static_cast<std::size_t>(d.column)])];
      p.state = ParameterState::not_identifiable;
      if (d.absorbed_by.empty()) {
        p.remark = structural(d.column) ? "no effect on what was measured" : "no effect on these poses";
        continue;
      }
      p.remark = structural(d.column) ? "absorbed by " : "by these poses not told apart from ";
      for (std::size_t j = 0; j < d.absorbed_by.size() && j < 4; ++j)
        p.remark += (j ? ", " : "") + names[static_cast<std::size_t>(all[static_cast<std::size_t>(d.absorbed_by[j])])];
      if (d.absorbed_by.size() > 4) p.remark += ", ...";
      if (!structural(d.column)) out.status = IdentifyStatus::underdetermined;
    }
  }
  if (problem.rows() <= moved) out.status = IdentifyStatus::underdetermined;
  if (out.status == IdentifyStatus::underdetermined)
    out.message = message(n, " poses give ", problem.rows(), " measured values; they determine only ", moved,
                          " of the ", static_cast<Index>(all.size()), " parameters asked for");
  if (!solved) {
    out.status = IdentifyStatus::not_converged;
    out.message = solver_message;
  }
  return out;
}

}  // namespace vernier
