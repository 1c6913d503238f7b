// SPDX-License-Identifier: BSD-3-Clause
// Least squares with many local unknowns: the Schur complement against sparse Cholesky factorisations of everything.

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "program.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#ifdef VERNIER_HAS_CHOLMOD
#include <Eigen/CholmodSupport>

#include "vernier/cholmod.hpp"
#endif

namespace {

namespace vn = vernier;
using vn::Index;
using Sparse = Eigen::SparseMatrix<double>;

constexpr const char* about =
    R"(least_squares_benchmark: calibrations whose sensor frame drifts, against sparse Cholesky factorisations of everything

40 parameters of an arm, and six of the sensor's frame at every knot of a random walk, two poses from knot to knot: 167,
1,667 and 16,667 knots, which are 1,002 to 100,002 local unknowns. Rows are random numbers.

  normal equations   from the rows of all poses: NormalEquations, which copies them block by block, against J'J of a
                     sparse J in Eigen
  step               from the normal equations to the Gauss-Newton step of all unknowns: FactorisedEquations, which
                     eliminates the local ones, against one SimplicialLLT (and a supernodal factorisation by CHOLMOD,
                     where that is installed) of the whole matrix, its ordering included. "vernier, CHOLMOD" has
                     CholmodSolver for the local unknowns.

All steps are compared before anything is timed.)";

constexpr Index dense = 40, local_size = 6, poses_per_knot = 2;

/// A calibration under drift.
struct Drift {
  Index knots, local;
  std::vector<vn::RowBlock> rows;
  std::vector<vn::LocalPrior> priors;  // the random walk, and the first knot near zero
  vn::VectorX precisions = vn::VectorX::Constant(dense, 1);

  explicit Drift(Index all_knots) : knots(all_knots), local(knots * local_size) {
    vn::Rng rng(1);
    const auto fill = [&rng](auto& m, double scale) {
      for (double& value : m.reshaped()) value = scale * rng.normal();
    };
    rows.resize(static_cast<std::size_t>(poses_per_knot * (knots - 1)));
    for (std::size_t b = 0; b < rows.size(); ++b) {
      vn::RowBlock& row = rows[b];
      row.dense.resize(6, dense);
      row.factor.resize(6, 0);
      fill(row.dense, 1);
      fill(row.residual, 1);
      row.unwhiten.setIdentity();
      vn::Matrix6 frame;
      fill(frame, 0.3);
      frame.diagonal().array() += 1;
      const double share = (static_cast<double>(b % poses_per_knot) + 0.5) / poses_per_knot;
      const Index before = static_cast<Index>(b) / poses_per_knot;
      row.local = {vn::RowBlock::Local{before, (1 - share) * frame}, {before + 1, share * frame}};
    }
    const vn::MatrixX walk = 100 * vn::Matrix6::Identity();
    priors.push_back({0, 0, walk});
    for (Index k = 0; k + 1 < knots; ++k) {
      priors.push_back({k, k, walk});
      priors.push_back({k, k + 1, -walk});
      priors.push_back({k + 1, k + 1, walk});
    }
  }

  vn::NormalEquations normal_equations() const {
    const auto evaluate = [this](Index first, Index count, vn::RowBlock* out) {
      std::copy_n(rows.begin() + first, count, out);
    };
    const auto blocks = static_cast<Index>(rows.size());
    return vn::NormalEquations(vn::BlockSystem{blocks, blocks, dense, {}, evaluate, knots, local_size}, priors);
  }
  Index unknowns() const { return local + dense; }

  /// The same as one sparse matrix, local unknowns first.
  Sparse jacobian() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t b = 0; b < rows.size(); ++b)
      for (int r = 0; r < 6; ++r) {
        const int at = 6 * static_cast<int>(b) + r;
        for (const auto& part : rows[b].local)
          for (int c = 0; c < local_size; ++c)
            entries.emplace_back(at, static_cast<int>(part.state * local_size) + c, part.columns(r, c));
        for (int c = 0; c < dense; ++c) entries.emplace_back(at, static_cast<int>(local) + c, rows[b].dense(r, c));
      }
    Sparse out(6 * static_cast<Index>(rows.size()), unknowns());
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  }
  vn::VectorX residuals() const {
    vn::VectorX out(6 * static_cast<Index>(rows.size()));
    for (std::size_t b = 0; b < rows.size(); ++b) out.segment<6>(6 * static_cast<Index>(b)) = rows[b].residual;
    return out;
  }
  Sparse prior_matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](Index row, Index column, double value) {
      entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
    };
    for (const vn::LocalPrior& p : priors)
      for (Index k = 0; k < local_size; ++k) {  // precisions are diagonal
        add(p.first * local_size + k, p.second * local_size + k, p.precision(k, k));
        if (p.first != p.second) add(p.second * local_size + k, p.first * local_size + k, p.precision(k, k));
      }
    for (Index k = 0; k < dense; ++k) add(local + k, local + k, precisions(k));
    Sparse out(unknowns(), unknowns());
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  }
};

vn::VectorX schur_step(const vn::NormalEquations& normal, const Drift& drift,
                       vn::SparseSolve solve = vn::eigen_sparse_solver) {
  const vn::FactorisedEquations solved(normal, drift.precisions, vn::VectorX::Zero(dense), {}, solve);
  if (!solved.usable()) throw std::runtime_error("the Schur complement has no solution");
  return (vn::VectorX(drift.unknowns()) << solved.local_step(), solved.step()).finished();
}

template <class Factorisation>
vn::VectorX sparse_step(const Sparse& matrix, const vn::VectorX& gradient) {
  const Factorisation factor(matrix);
  if (factor.info() != Eigen::Success) throw std::runtime_error("the whole matrix is not positive definite");
  return factor.solve(-gradient);
}

void measure(bench::Program& program, Index knots, const std::string& size) {
  const auto drift = std::make_shared<Drift>(knots);
  const auto normal = std::make_shared<vn::NormalEquations>(drift->normal_equations());
  const auto jacobian = std::make_shared<Sparse>(drift->jacobian());
  const Sparse prior = drift->prior_matrix();
  const auto matrix = std::make_shared<Sparse>(Sparse(jacobian->transpose() * *jacobian) + prior);
  const vn::VectorX gradient = jacobian->transpose() * drift->residuals();

  const vn::VectorX ours = schur_step(*normal, *drift);
  const auto agree = [&](const char* who, const vn::VectorX& theirs) {
    bench::require_agreement(who, (ours - theirs).norm() / ours.norm(), 1e-9);
  };
  agree("steps by SimplicialLLT", sparse_step<Eigen::SimplicialLLT<Sparse>>(*matrix, gradient));

  program.measure("normal equations, " + size, "vernier", [=](std::size_t) { return drift->normal_equations(); });
  program.measure("normal equations, " + size, "sparse J'J, Eigen",
                  [=](std::size_t) { return Sparse(Sparse(jacobian->transpose() * *jacobian) + prior); });
  program.measure("step, " + size, "vernier", [=](std::size_t) { return schur_step(*normal, *drift); });
  program.measure("step, " + size, "SimplicialLLT, Eigen",
                  [=](std::size_t) { return sparse_step<Eigen::SimplicialLLT<Sparse>>(*matrix, gradient); });
#ifdef VERNIER_HAS_CHOLMOD
  static const vn::CholmodSolver cholmod;
  agree("steps with CHOLMOD inside", schur_step(*normal, *drift, cholmod));
  program.measure("step, " + size, "vernier, CHOLMOD",
                  [=](std::size_t) { return schur_step(*normal, *drift, cholmod); });
  agree("steps by CHOLMOD", sparse_step<Eigen::CholmodSupernodalLLT<Sparse>>(*matrix, gradient));
  program.measure("step, " + size, "CHOLMOD, supernodal",
                  [=](std::size_t) { return sparse_step<Eigen::CholmodSupernodalLLT<Sparse>>(*matrix, gradient); });
#endif
}

int work(bench::Program& program, int argc, char** argv) {
  measure(program, 167, "1,000");
  measure(program, 1667, "10,000");
  measure(program, 16667, "100,000");
  return program.run(argc, argv, 3);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
