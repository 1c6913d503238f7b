// SPDX-License-Identifier: BSD-3-Clause
// What a search over an ELM's hidden weights pays: the fitness of one particle, against Eigen written out.

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/detail/layer_equations.hpp"
#include "vernier/regression/detail/tile_product.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;
using vn::MatrixX;
using vn::VectorX;

namespace {

constexpr const char* about =
    R"(elm_benchmark: extreme learning machines of 65 sigmoid nodes, 6 joint angles in, 3 position errors out, 5,000 samples

  fitness         of one particle of PSO-ELM (Elm::objective): hidden layer, output weights, training error; against
                  Eigen written out, each with its own hidden layer and residual:
                    Eigen Gram + LLT    H'H + lambda I, the same lambda
                    Eigen Householder   QR of H, no ridge
                    Eigen BDCSVD        minimum norm
  kernel          its hidden layer and normal equations alone, with the widest instructions of this machine; with AVX2,
                  and with those the compiler was told of
  leave-one-out   fitness of RidgeElm (sines and cosines in) over 25 ridges and the mean alone: one BDCSVD of the
                  centred H, leverages written out
  generation      of 50 particles, as a search evaluates it: two threads against one, by the clock on the wall. Two cores
                  that have nothing else to do halve it.
  predict         one sample; against a 65-node layer in dynamic Eigen matrices
  correct         the joint command of CartesianCompensation{Elm} at one pose; no peer

All compute from the same samples, scaled alike, and are compiled with the same flags: Eigen uses the instructions the
compiler was told of (SSE2 on x86-64 unless told more), Vernier's fitness those of the machine, which the last line names.
Results are compared before anything is timed.)";

constexpr vn::Index samples = 5000;
constexpr int nodes = 65;

using Inputs = vn::JointRows<6>;
using Targets = vn::PointRows;

/// The hidden layer as one writes it.
MatrixX hidden(const MatrixX& features, const VectorX& theta) {
  const vn::Index f = features.cols();
  const Eigen::Map<const MatrixX> weights(theta.data(), f + 1, nodes);
  const MatrixX z = (features * weights.topRows(f)).rowwise() + weights.row(f);
  return (1 + (-z.array()).exp()).inverse();
}

double gram_fitness(const MatrixX& features, const MatrixX& targets, const VectorX& theta) {
  const MatrixX h = hidden(features, theta);
  MatrixX gram = h.transpose() * h;
  const double lambda = 1e-10 * gram.trace() / nodes;
  gram.diagonal().array() += lambda;
  const MatrixX beta = gram.llt().solve(h.transpose() * targets);
  return ((h * beta - targets).squaredNorm() + lambda * beta.squaredNorm()) / samples;
}

double householder_fitness(const MatrixX& features, const MatrixX& targets, const VectorX& theta) {
  const MatrixX h = hidden(features, theta);
  const MatrixX beta = h.householderQr().solve(targets);
  return (h * beta - targets).squaredNorm() / samples;
}

double svd_fitness(const MatrixX& features, const MatrixX& targets, const VectorX& theta) {
  const MatrixX h = hidden(features, theta);
  const MatrixX beta = h.bdcSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(targets);
  return (h * beta - targets).squaredNorm() / samples;
}

/// Leave-one-out error of a ridge with a free mean, least over the ridges that Vernier tries.
double leave_one_out(const MatrixX& features, const MatrixX& targets, const VectorX& theta) {
  MatrixX h = hidden(features, theta);
  h.rowwise() -= h.colwise().mean().eval();
  const MatrixX t = targets.rowwise() - targets.colwise().mean();
  const Eigen::BDCSVD<MatrixX> svd(h, Eigen::ComputeThinU);
  const MatrixX projected = svd.matrixU().transpose() * t, squares = svd.matrixU().cwiseAbs2();
  const Eigen::ArrayXd s2 = svd.singularValues().array().square();
  double best = (t * (samples / (samples - 1.0))).squaredNorm() / samples;
  for (int exponent = 0; exponent >= -24; --exponent) {
    const VectorX share = s2 / (s2 + s2(0) * std::pow(10.0, exponent / 2.0));
    const MatrixX residual = t - svd.matrixU() * (share.asDiagonal() * projected);
    const VectorX rest = (1 - 1.0 / samples - (squares * share).array()).matrix();
    best = std::min(best, (residual.array().colwise() / rest.array()).matrix().squaredNorm() / samples);
  }
  return best;
}

/// Multiply-adds that wait for nothing, as wide as the machine has them: what it can do at most.
template <int W>
VERNIER_INLINE void multiply_add(double* sums, vn::Index rounds) {
  constexpr int chains = 12;
  typename vn::detail::Simd<W>::Double sum[chains], factor, step;
  vn::detail::load<W>(factor, sums);
  step = factor + 1.0;
  for (int k = 0; k < chains; ++k) sum[k] = step * static_cast<double>(k);
  for (vn::Index i = 0; i < rounds; ++i) {
    VERNIER_UNROLL
    for (int k = 0; k < chains; ++k) sum[k] = sum[k] * factor + step;
  }
  for (int k = 1; k < chains; ++k) sum[0] += sum[k];
  vn::detail::store<W>(sums, sum[0]);
}
#if defined(__x86_64__)
__attribute__((target("avx512f,avx512dq,fma"))) void multiply_add_avx512(double* s, vn::Index n) {
  multiply_add<8>(s, n);
}
__attribute__((target("avx2,fma"))) void multiply_add_avx2(double* s, vn::Index n) { multiply_add<4>(s, n); }
#endif

/// Operations of a number of rounds; two a multiply-add.
double run_multiply_add(vn::Index rounds) {
  double sums[8] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
  int width = 2;
  switch (vn::widest_instruction_set()) {
#if defined(__x86_64__)
    case vn::InstructionSet::avx512: multiply_add_avx512(sums, rounds), width = 8; break;
    case vn::InstructionSet::avx2: multiply_add_avx2(sums, rounds), width = 4; break;
#endif
    default: multiply_add<2>(sums, rounds);
  }
  benchmark::DoNotOptimize(sums);
  return 2.0 * 12 * width * static_cast<double>(rounds);
}

/// A predictor in dynamic matrices, scalings folded in as far as Vernier's.
struct PlainPredictor {
  VectorX offset, factor, bias, mean;
  MatrixX weights, beta;  // nodes x inputs, outputs x nodes
  VectorX operator()(const VectorX& x) const {
    const VectorX z = weights * (x - offset).cwiseProduct(factor) + bias;
    return mean + beta * (1 + (-z.array()).exp()).inverse().matrix();
  }
};

int work(bench::Program& program, int argc, char** argv) {
  const auto arm = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(arm, {}, 1);
  const Inputs x = vn::abb_irb120_operating_region().sample(arm, samples, 1);
  const vn::Dataset<6> data = vn::measure(actual, x);
  const Targets y = vn::positions(arm, x) - data.positions();

  const vn::Elm elm{.hidden_nodes = nodes};
  const vn::RidgeElm ridge{.hidden_nodes = nodes};
  const MatrixX features = vn::ColumnScaling::fit(x, vn::Scaling::min_max).apply(x);
  const MatrixX targets = vn::ColumnScaling::fit(y, vn::Scaling::min_max).apply(y);
  const MatrixX sines = ridge.layer().map(x);

  constexpr std::size_t particles = 16, mask = particles - 1;
  std::vector<VectorX> theta, wide;
  for (std::size_t k = 0; k < particles; ++k) {
    theta.push_back(elm.layer().draw(6, k));
    wide.push_back(ridge.layer().draw(6, k));
  }
  const auto ours = [objective = elm.objective(x, y)](const VectorX& at) {
    VectorX fitness(1);
    objective(at, fitness);
    return fitness(0);
  };
  const auto our_leave_one_out = [objective = ridge.objective(x, y)](const VectorX& at) {
    VectorX fitness(1);
    objective(at, fitness);
    return fitness(0);
  };
  const auto predictor = elm.fit_at(x, y, theta[0]);
  PlainPredictor plain{predictor.scaling().offset,  predictor.scaling().factor, {}, predictor.offset(), {},
                       predictor.beta().transpose()};
  const VectorX weights = predictor.theta();
  plain.weights = Eigen::Map<const MatrixX>(weights.data(), 7, nodes).topRows(6).transpose();
  plain.bias = Eigen::Map<const MatrixX>(weights.data(), 7, nodes).row(6).transpose();
  std::vector<vn::JointVector<6>> at;
  std::vector<VectorX> plain_at;
  for (vn::Index i = 0; i < 1024; ++i) {
    at.push_back(x.row(i).transpose());
    plain_at.emplace_back(x.row(i).transpose());
  }

  // All compute the same? Fitness without the ridge differs by what the ridge costs.
  const auto relative = [](double a, double b) { return std::abs(a - b) / std::abs(b); };
  double by_gram = 0, by_qr = 0, by_svd = 0, by_loo = 0, by_plain = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    by_gram = std::max(by_gram, relative(ours(theta[k]), gram_fitness(features, targets, theta[k])));
    by_qr = std::max(by_qr, relative(ours(theta[k]), householder_fitness(features, targets, theta[k])));
    by_svd = std::max(by_svd, relative(ours(theta[k]), svd_fitness(features, targets, theta[k])));
    by_loo = std::max(by_loo, relative(our_leave_one_out(wide[k]), leave_one_out(sines, y, wide[k])));
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    by_plain = std::max(by_plain, (predictor.predict(at[i]) - plain(plain_at[i])).norm());
  bench::require_agreement("fitness and Gram + LLT", by_gram, 1e-6);
  bench::require_agreement("fitness and Householder QR", by_qr, 1e-2);
  bench::require_agreement("fitness and BDCSVD", by_svd, 1e-2);
  bench::require_agreement("leave-one-out errors", by_loo, 1e-6);
  bench::require_agreement("predictions [m]", by_plain, 1e-9);

  program.measure("fitness", "vernier", [=](std::size_t i) { return ours(theta[i & mask]); });
  program.measure("fitness", "Eigen Gram + LLT",
                  [=](std::size_t i) { return gram_fitness(features, targets, theta[i & mask]); });
  program.measure("fitness", "Eigen Householder",
                  [=](std::size_t i) { return householder_fitness(features, targets, theta[i & mask]); });
  program.measure("fitness", "Eigen BDCSVD",
                  [=](std::size_t i) { return svd_fitness(features, targets, theta[i & mask]); });

  const auto kernel = [&](const char* who, vn::InstructionSet set) {
    if (set > vn::widest_instruction_set()) return;
    const auto kept = std::make_shared<std::pair<MatrixX, MatrixX>>(features, targets);  // the equations refer to them
    const auto equations = std::make_shared<vn::detail::LayerEquations>(elm.layer(), kept->first, kept->second, set);
    program.measure("kernel", who, [=, keep = kept](std::size_t i) {
      equations->form(theta[i & mask]);
      return keep->first(0);
    });
  };
  kernel("vernier", vn::widest_instruction_set());
  kernel("AVX2", vn::InstructionSet::avx2);
  kernel("those of the compiler", vn::InstructionSet::baseline);

  program.measure("leave-one-out", "vernier", [=](std::size_t i) { return our_leave_one_out(wide[i & mask]); });
  program.measure("leave-one-out", "Eigen BDCSVD",
                  [=](std::size_t i) { return leave_one_out(sines, y, wide[i & mask]); });

  MatrixX swarm(elm.dimension(6), 50);
  for (vn::Index k = 0; k < swarm.cols(); ++k) swarm.col(k) = elm.layer().draw(6, static_cast<std::uint64_t>(k));
  const auto generation = [=, objective = elm.objective(x, y)](const auto& executor) {
    VectorX fitness(swarm.cols());
    executor.for_ranges(swarm.cols(), [&](vn::Index begin, vn::Index end) {
      objective(swarm.middleCols(begin, end - begin), fitness.segment(begin, end - begin));
    });
    return fitness;
  };
  const vn::ThreadExecutor two(2);
  bench::require_agreement("fitness on one thread and on two",
                           (generation(vn::SequentialExecutor{}) - generation(two)).cwiseAbs().maxCoeff(), 0);
  program.measure_wall("generation", "vernier", [=](std::size_t) { return generation(two); });
  program.measure_wall("generation", "one thread", [=](std::size_t) { return generation(vn::SequentialExecutor{}); });

  program.measure("predict", "vernier", [=](std::size_t i) { return predictor.predict(at[i & 1023]); });
  program.measure("predict", "Eigen, dynamic matrices", [=](std::size_t i) { return plain(plain_at[i & 1023]); });

  const auto compensation = vn::CartesianCompensation{elm}.fit(arm, data, {.seed = 1});
  program.measure("correct", "vernier", [=](std::size_t i) { return compensation.correct(at[i & 1023]); });

  // how much of the machine's peak the symmetric product of a tile reaches, and how a fitness grows
  constexpr vn::Index peak_rounds = 100000, stride = 72, tile = 40;
  program.measure("peak", "multiply-adds", [](std::size_t) { return run_multiply_add(peak_rounds); });
  std::vector<double> rows(tile * stride, 0.5), scaled(rows), ones(tile, 1.0), products(stride * stride, 0.0);
  program.measure("symmetric product", "a tile", [=](std::size_t) mutable {
    vn::detail::add_weighted_product({.left = rows.data(),
                                      .right = rows.data(),
                                      .weights = ones.data(),
                                      .tile = scaled.data(),
                                      .products = products.data(),
                                      .samples = tile,
                                      .stride = stride,
                                      .tile_samples = tile,
                                      .symmetric = true},
                                     vn::widest_instruction_set());
    return products[0];
  });
  const std::array<std::pair<vn::Index, int>, 5> sizes{{{1250, 65}, {5000, 33}, {5000, 65}, {5000, 130}, {20000, 65}}};
  const auto size_name = [](vn::Index n, int h) { return "n = " + std::to_string(n) + ", h = " + std::to_string(h); };
  for (const auto& [n, h] : sizes) {
    const vn::Elm of_size{.hidden_nodes = h};
    const Inputs q = vn::abb_irb120_operating_region().sample(arm, n, 2);
    const Targets error = vn::positions(arm, q) - vn::positions(actual, q);
    program.measure("growth", size_name(n, h),
                    [objective = of_size.objective(q, error), at = of_size.layer().draw(6, 1)](std::size_t) {
                      VectorX fitness(1);
                      objective(at, fitness);
                      return fitness(0);
                    });
  }

  for (const vn::Index particles_of : {10, 50, 250})
    program.measure("growth", std::to_string(particles_of) + " particles",
                    [objective = elm.objective(x, y),
                     all = MatrixX(swarm.leftCols(10).replicate(1, particles_of / 10))](std::size_t) {
                      VectorX fitness(all.cols());
                      objective(all, fitness);
                      return fitness(0);
                    });

  if (const int status = program.run(argc, argv); status != 0) return status;
  if (const double peak = program.median("peak", "multiply-adds"),
      ours_ns = program.median("symmetric product", "a tile");
      peak > 0 && ours_ns > 0) {
    const double most = run_multiply_add(peak_rounds) / peak;  // operations a nanosecond
    const double useful = static_cast<double>(tile * stride * (stride + 1)) / ours_ns;
    std::printf(
        "\nsymmetric product of a tile: %.1f GFLOP/s, %.0f %% of the %.1f that this machine's multiply-adds reach\n",
        useful, 100 * useful / most, most);
    for (const auto& [n, h] : sizes)
      if (const double t = program.median("growth", size_name(n, h)); t > 0)
        std::printf("fitness, %-18s %10.3f ms, %.1f GFLOP/s in the symmetric product alone\n", size_name(n, h).c_str(),
                    t * 1e-6, static_cast<double>(n) * (h + 3) * (h + 4) / t);
  }
  std::printf("\nfitness against Gram + LLT, Householder, BDCSVD: relative difference at most %.1e, %.1e, %.1e\n",
              by_gram, by_qr, by_svd);
  const char* sets[] = {"those of the compiler", "AVX2", "AVX-512"};
  std::printf("instructions: Eigen %s; Vernier's fitness %s\n", Eigen::SimdInstructionSetsInUse(),
              sets[static_cast<int>(vn::widest_instruction_set())]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
