// SPDX-License-Identifier: BSD-3-Clause
// The four searches of the paper's experiment from data to compensation, against the same with the fitness in Eigen.

#include <Eigen/Cholesky>
#include <vector>

#include "program.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;
using vn::MatrixX;
using vn::VectorX;

namespace {

constexpr const char* about =
    R"(paper_benchmark: the experiment of Feng, Dong and Jin, from 5,000 poses to four fitted compensations

  experiment  labels by inverse kinematics, then joint-space GA-ELM (58 nodes, 100 individuals, 350 generations) and
              PSO-ELM (68, 40, 300), Cartesian GA-ELM (73, 80, 400) and PSO-ELM (65, 50, 300), each with a fiftieth of
              its generations, on one thread; against the same searches whose fitness is Eigen written out: hidden
              layer, Gram matrix + LLT, residual
  all of it   the same on two threads with a fifth of the generations, by the clock on the wall; no peer

Both searches must end at the same fitness, or nothing is timed. The fit at the end is the same code for both.)";

/// An ELM whose fitness is what one writes in Eigen.
struct PlainElm : vn::Elm {
  template <class X, class Y>
  auto objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets) const {
    const MatrixX mapped = layer().map(inputs);
    return [layer = layer(), lambda = fitness_lambda, features = layer().scaling(mapped).apply(mapped),
            t = MatrixX(vn::ColumnScaling::fit(targets, target_scaling).apply(targets))](
               const Eigen::Ref<const MatrixX>& population, Eigen::Ref<VectorX> fitness) {
      const vn::Index f = features.cols();
      for (vn::Index k = 0; k < population.cols(); ++k) {
        const Eigen::Map<const MatrixX> weights(population.col(k).data(), f + 1, layer.nodes);
        const MatrixX z = (features * weights.topRows(f)).rowwise() + weights.row(f);
        const MatrixX h = (1 + (-z.array()).exp()).inverse();
        MatrixX gram = h.transpose() * h;
        const double ridge = lambda * gram.trace() / layer.nodes;
        gram.diagonal().array() += ridge;
        const MatrixX beta = gram.llt().solve(h.transpose() * t);
        fitness(k) = ((h * beta - t).squaredNorm() + ridge * beta.squaredNorm()) / static_cast<double>(t.rows());
      }
    };
  }
};
static_assert(vn::TunableRegressor<PlainElm>);

/// The best fitness of each of the four.
using Found = std::array<double, 4>;

class Experiment {
 public:
  Experiment()
      : train_(vn::abb_irb120_operating_region().sample(nominal_, 5000, 1)), measured_(vn::measure(actual_, train_)) {}

  template <class E>
  Found run(int part, vn::ExecutorRef executor = {}) const {
    const auto elm = [](int nodes) {
      E out;
      out.hidden_nodes = nodes;
      return out;
    };
    const auto ga = [&](int individuals, vn::Index generations) {
      return vn::GeneticAlgorithm{.individuals = individuals, .generations = generations / part};
    };
    const auto pso = [&](int particles, vn::Index iterations) {
      return vn::Pso{.particles = particles, .iterations = iterations / part};
    };
    Found best{};
    const auto options = [&](std::size_t which, const auto& watch) {
      return vn::FitOptions{.seed = which, .executor = executor, .observer = watch};
    };
    const auto labels = vn::joint_error_labels(nominal_, actual_, train_);
    const auto joint = [&](std::size_t which, const auto& regressor) {
      const auto watch = [&](const vn::Progress& p) { best[which] = p.best; };
      return vn::JointCompensation{regressor}.fit(nominal_, labels, options(which, watch)).correct(train_.row(0));
    };
    const auto cartesian = [&](std::size_t which, const auto& regressor) {
      const auto watch = [&](const vn::Progress& p) { best[which] = p.best; };
      return vn::CartesianCompensation{regressor}
          .fit(nominal_, measured_, options(which, watch))
          .correct(train_.row(0));
    };
    joint(0, vn::Tuned{elm(58), ga(100, 350)});
    joint(1, vn::Tuned{elm(68), pso(40, 300)});
    cartesian(2, vn::Tuned{elm(73), ga(80, 400)});
    cartesian(3, vn::Tuned{elm(65), pso(50, 300)});
    return best;
  }

 private:
  vn::DhChain<6> nominal_ = vn::robots::abb_irb120().chain;
  vn::DhChain<6> actual_ = vn::with_geometric_errors(nominal_, {}, 1);
  vn::JointRows<6> train_;
  vn::Dataset<6> measured_;
};

int work(bench::Program& program, int argc, char** argv) {
  const Experiment experiment;
  const Found ours = experiment.run<vn::Elm>(50), plain = experiment.run<PlainElm>(50);
  for (std::size_t k = 0; k < ours.size(); ++k)
    bench::require_agreement("best fitness, relative,", std::abs(ours[k] / plain[k] - 1), 1e-5);
  program.measure("experiment", "vernier", [=](std::size_t) { return experiment.run<vn::Elm>(50); });
  program.measure("experiment", "fitness in Eigen", [=](std::size_t) { return experiment.run<PlainElm>(50); });
  const vn::ThreadExecutor two(2);
  program.measure_wall("all of it", "vernier", [=](std::size_t) { return experiment.run<vn::Elm>(5, two); });
  return program.run(argc, argv, 3);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
