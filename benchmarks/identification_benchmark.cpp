// SPDX-License-Identifier: BSD-3-Clause
// Identification from 200 positions, against the same least squares in Ceres with dual numbers.

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "program.hpp"
#include "vernier/ceres.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;

namespace {

constexpr const char* about =
    R"(identification_benchmark: an ABB IRB 120 from 200 positions with 0.03 mm noise, base and tool frames and geometry free

  identify             vernier::identify with priors off: closed-form frames, which parameters the data tell apart, the
                       solves, covariance; against one Ceres solve with an AutoDiffCostFunction a pose, through the
                       templated pose, that is told which parameters to free and starts from the same closed-form
                       frames. Same scaling of parameters, same tolerances, same linear solver, one thread.
                       "vernier, priors" is identify with its defaults, where weak parameters are restrained too.
  200 pose jacobians   derivatives of 200 positions with respect to the parameters: parameter_jacobian (all 42) against
                       dual numbers (the free ones)

Both minimise the same sum. Their models are compared on fresh poses before anything is timed.)";

using Chain = vn::DhChain<6>;
using Arm = vn::Framed<Chain>;
using Joints = vn::JointVector<6>;

constexpr int free_parameters = 27;  // identifiable from this arm's tool positions, frames included; checked below
using Free = std::array<vn::Index, free_parameters>;
using Step = Eigen::Matrix<double, free_parameters, 1>;

/// Parameters of an arm as steps from a start.
struct Steps {
  Arm start;
  Free free;
  Step sizes;

  template <class T>
  Eigen::Matrix<T, Arm::num_parameters, 1> parameters(const T* steps) const {
    Eigen::Matrix<T, Arm::num_parameters, 1> p = start.parameters().cast<T>();
    for (int k = 0; k < free_parameters; ++k) p(free[static_cast<std::size_t>(k)]) += sizes(k) * steps[k];
    return p;
  }
};

/// One measured position, for dual numbers.
struct PositionError {
  const Steps& steps;
  Joints joints;
  vn::Vector3 measured;
  double sigma;

  template <class T>
  bool operator()(const T* at, T* residuals) const {
    const Eigen::Matrix<T, 6, 1> q = joints.cast<T>();
    const vn::IsometryOf<T> pose = steps.start.pose<T>(q, steps.parameters(at));
    for (int k = 0; k < 3; ++k) residuals[k] = (pose.translation()(k) - measured(k)) / sigma;
    return true;
  }
};

std::unique_ptr<ceres::CostFunction> dual_cost(const Steps& steps, const vn::Dataset<6>& data, vn::Index i,
                                               double sigma) {
  return std::make_unique<ceres::AutoDiffCostFunction<PositionError, 3, free_parameters>>(
      new PositionError{steps, data.joints(i), data.position(i), sigma});
}

/// What the peer finds.
struct DualResult {
  Arm arm;
  int iterations;
};

DualResult identify_with_dual_numbers(const Chain& nominal, const vn::Dataset<6>& data,
                                      const vn::IdentifyOptions& options, const Free& free, const Step& sizes) {
  const Steps steps{vn::starting_frames(nominal, data, true, true), free, sizes};
  Step at = Step::Zero();
  ceres::Problem problem;
  for (vn::Index i = 0; i < data.size(); ++i)
    problem.AddResidualBlock(dual_cost(steps, data, i, vn::SensorModel{}.position_sigma).release(), nullptr, at.data());
  ceres::Solver::Options solver;  // as Vernier sets it
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-14;
  solver.gradient_tolerance = 1e-16;
  solver.parameter_tolerance = 1e-13;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return {steps.start.with_parameters(steps.parameters(at.data())), static_cast<int>(summary.iterations.size())};
}

double rms(const Arm& arm, const vn::Dataset<6>& data) {
  return std::sqrt((vn::positions(arm, data.joints()) - data.positions()).rowwise().squaredNorm().mean());
}

int work(bench::Program& program, int argc, char** argv) {
  const Chain nominal = vn::robots::abb_irb120().chain;
  vn::Isometry3 base = vn::Isometry3::Identity(), tool = vn::Isometry3::Identity();
  base.translation() << 0.4, -0.3, 0.1;
  base.linear() = vn::exp_so3(vn::Vector3(0.1, -0.2, 1.0));
  tool.translation() << 0.03, 0.02, 0.1;  // off the last axis
  const Arm actual(vn::with_geometric_errors(nominal, {}, 1), base, tool);
  const auto region = vn::abb_irb120_operating_region();
  const vn::MeasurementNoise noise{.position = 0.03e-3, .with_orientations = false};
  const vn::Dataset<6> data = vn::measure(actual, region.sample(nominal, 200, 1), noise, 2);
  const vn::JointRows<6> fresh = region.sample(nominal, 1000, 3);

  vn::IdentifyOptions options{.frames = vn::Frames::base_and_tool, .priors = false};
  vn::IdentifyOptions defaults{.frames = vn::Frames::base_and_tool};
  const auto ours = vn::identify(nominal, data, options);
  if (!ours.converged()) throw std::runtime_error("identify: " + ours.message);
  if (ours.free.size() != free_parameters)
    throw std::runtime_error("identify moves " + std::to_string(ours.free.size()) +
                             " parameters, this program expects " + std::to_string(free_parameters));
  const vn::VectorX all_sizes = vn::detail::IdentificationPlan(vn::ArmGeometry(vn::in_frames(nominal)), options).scales;
  Free free{};
  Step sizes;
  for (int k = 0; k < free_parameters; ++k) {
    free[static_cast<std::size_t>(k)] = ours.free[static_cast<std::size_t>(k)];
    sizes(k) = all_sizes(free[static_cast<std::size_t>(k)]);
  }
  const DualResult theirs = identify_with_dual_numbers(nominal, data, options, free, sizes);
  const auto restrained = vn::identify(nominal, data, defaults);

  const vn::PointRows at_ours = vn::positions(ours.model, fresh), at_theirs = vn::positions(theirs.arm, fresh);
  const double apart = (at_ours - at_theirs).rowwise().norm().maxCoeff();
  bench::require_agreement("identified models [m]", apart, 1e-7);

  program.measure("identify", "vernier", [=](std::size_t) { return vn::identify(nominal, data, options); });
  program.measure("identify", "Ceres, dual numbers",
                  [=](std::size_t) { return identify_with_dual_numbers(nominal, data, options, free, sizes); });
  program.measure("identify", "vernier, priors", [=](std::size_t) { return vn::identify(nominal, data, defaults); });

  const Arm arm = ours.model.identified();
  program.measure("200 pose jacobians", "vernier", [=](std::size_t) {
    double sum = 0;
    for (vn::Index i = 0; i < data.size(); ++i) {
      auto jacobian = arm.parameter_jacobian(data.joints(i));
      benchmark::DoNotOptimize(jacobian);
      sum += jacobian(0, 0);
    }
    return sum;
  });
  const auto steps = std::make_shared<Steps>(Steps{arm, free, sizes});
  std::vector<std::shared_ptr<ceres::CostFunction>> costs;
  for (vn::Index i = 0; i < data.size(); ++i) costs.push_back(dual_cost(*steps, data, i, 1));
  program.measure("200 pose jacobians", "dual numbers", [=](std::size_t) {
    const Step at = Step::Zero();
    const double* blocks[] = {at.data()};
    double sum = 0;
    for (const auto& cost : costs) {
      vn::Vector3 residuals;
      Eigen::Matrix<double, 3, free_parameters, Eigen::RowMajor> jacobian;
      double* jacobians[] = {jacobian.data()};
      cost->Evaluate(blocks, residuals.data(), jacobians);
      benchmark::DoNotOptimize(jacobian);
      sum += jacobian(0, 0);
    }
    return sum + steps->sizes(0);
  });

  if (const int status = program.run(argc, argv); status != 0) return status;
  const auto fresh_error = [&](const vn::PointRows& at) {
    return (at - vn::positions(actual, fresh)).rowwise().norm().mean() * 1e3;
  };
  std::printf("\nfree parameters %d; the two models lie at most %.1e m apart on 1,000 fresh poses\n", free_parameters,
              apart);
  std::printf("%-22s %12s %18s %18s\n", "", "iterations", "rms [mm]", "fresh mean [mm]");
  const auto line = [&](const char* who, int iterations, const Arm& model) {
    std::printf("%-22s %12d %18.6f %18.6f\n", who, iterations, rms(model, data) * 1e3,
                fresh_error(vn::positions(model, fresh)));
  };
  line("vernier (all solves)", ours.iterations, ours.model.identified());
  line("Ceres, dual numbers", theirs.iterations, theirs.arm);
  line("vernier, priors", restrained.iterations, restrained.model.identified());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
