#pragma once

/// @file
/// The linear algebra of error models: normal equations, steps and leave-one-pose-out errors. It knows poses as rows of
/// numbers, whatever the arm, so that it is compiled once for all numbers of joints. Templates where nothing else asks
/// for them: then including this costs nothing before it is used.
///
/// A transmission term reads one joint and acts through that joint's Jacobian column: its rows are `J_i(q) h_k(q_i)`.
/// So the three or six rows of a pose enter the normal equations as one row weighed by `J_i' J_j`: a sixth of the work,
/// and memory that does not grow with the number of poses.

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// A 6 x 6 matrix.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Six rows, any number of columns.
using Rows6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Whitened residual (model minus measured) of a pose, and what unit steps of the unknowns do to it.
struct PoseRows {
  Vector6 residual;
  Rows6 dense;        ///< of the unknowns that are no transmission terms
  Rows6 joint;        ///< of a unit error of each joint
  VectorX functions;  ///< of all transmissions at this pose, joint by joint
  Matrix6 root;       ///< takes whitened errors back to multiples of the sensor's sigmas
  double unit = 1;    ///< of the position rows then [m]

  /// All columns: `joint` column by column times the functions of that joint.
  void expand(const std::vector<Index>& functions_of, Eigen::Ref<Rows6> out) const {
    out.leftCols(dense.cols()) = dense;
    Index at = 0;
    for (std::size_t j = 0; j < functions_of.size(); ++j) {
      out.middleCols(dense.cols() + at, functions_of[j]).noalias() =
          joint.col(static_cast<Index>(j)) * functions.segment(at, functions_of[j]).transpose();
      at += functions_of[j];
    }
  }
};

/// Poses as rows of numbers.
struct PoseSystem {
  Index poses;                               ///< how many
  Index judged;                              ///< the first so many are left out to judge
  Index dense;                               ///< unknowns that are no transmission terms
  std::vector<Index> functions_of;           ///< transmission terms of each joint
  FunctionRef<void(Index, PoseRows&)> rows;  ///< fills in one pose; outlives this

  Index joints() const { return static_cast<Index>(functions_of.size()); }
  Index unknowns() const {
    Index sum = dense;
    for (const Index count : functions_of) sum += count;
    return sum;
  }
};

/// J'J and J'r of all poses; no priors.
struct PoseNormalEquations {
  MatrixX matrix;
  VectorX gradient;
  double cost = 0;  ///< r'r

  template <class System>
  explicit PoseNormalEquations(const System& system)
      : matrix(MatrixX::Zero(system.unknowns(), system.unknowns())), gradient(VectorX::Zero(system.unknowns())) {
    constexpr Index chunk = 256;
    const Index all = system.unknowns(), d = system.dense, joints = system.joints();
    PoseRows rows;
    MatrixX dense(6 * chunk, d), h(chunk, all - d), mixed(chunk, d * joints), scaled;
    MatrixX joint_residual(chunk, joints), joint_product(chunk, joints * joints);  // J_j' r and J_i' J_j of each pose
    VectorX residuals(6 * chunk);
    for (Index first = 0; first < system.poses; first += chunk) {
      const Index n = std::min(chunk, system.poses - first);
      for (Index b = 0; b < n; ++b) {
        system.rows(first + b, rows);
        if (d > 0) dense.middleRows(6 * b, 6) = rows.dense;
        residuals.segment(6 * b, 6) = rows.residual;
        if (all == d) continue;
        h.row(b) = rows.functions.transpose();
        joint_product.row(b) = MatrixX(rows.joint.transpose() * rows.joint).reshaped().transpose();
        if (d > 0) mixed.row(b) = MatrixX(rows.dense.transpose() * rows.joint).reshaped().transpose();
        joint_residual.row(b).noalias() = rows.residual.transpose() * rows.joint;
      }
      const auto dense_rows = dense.topRows(6 * n);
      matrix.topLeftCorner(d, d).noalias() += dense_rows.transpose() * dense_rows;
      gradient.head(d).noalias() += dense_rows.transpose() * residuals.head(6 * n);
      cost += residuals.head(6 * n).squaredNorm();
      Index to_j = 0;
      for (Index j = 0; j < joints && all > d; ++j) {
        const Index count_j = system.functions_of[static_cast<std::size_t>(j)];
        const auto h_j = h.block(0, to_j, n, count_j);
        gradient.segment(d + to_j, count_j).noalias() += h_j.transpose() * joint_residual.col(j).head(n);
        matrix.block(0, d + to_j, d, count_j).noalias() += mixed.block(0, j * d, n, d).transpose() * h_j;
        Index to_i = 0;
        for (Index i = 0; i <= j; ++i) {
          const Index count_i = system.functions_of[static_cast<std::size_t>(i)];
          scaled = joint_product.col(i + joints * j).head(n).asDiagonal() * h_j;
          matrix.block(d + to_i, d + to_j, count_i, count_j).noalias() +=
              h.block(0, to_i, n, count_i).transpose() * scaled;
          to_i += count_i;
        }
        to_j += count_j;
      }
    }
    matrix.triangularView<Eigen::StrictlyLower>() = matrix.transpose();
  }
};

/// Normal equations with priors, factorised. Unknowns that nothing determines stay where they are.
struct FactorisedSystem {
  Eigen::LLT<MatrixX> factor;
  VectorX step;  ///< of a Gauss-Newton iteration

  /// @param precisions of the priors
  /// @param steps      where the unknowns are, from where the priors pull to
  template <class Equations>
  FactorisedSystem(const Equations& normal, const VectorX& precisions, const VectorX& steps) {
    MatrixX matrix = normal.matrix;
    matrix.diagonal() += precisions;
    matrix.diagonal().array() += 1e-12 * normal.matrix.diagonal().maxCoeff();  // of the data alone: priors may be huge
    factor.compute(matrix);
    step = -factor.solve(normal.gradient + precisions.cwiseProduct(steps));
  }
  bool usable() const { return factor.info() == Eigen::Success && step.allFinite(); }
};

/// Position errors of poses left out one at a time, in closed form: `e_b = (I - H_bb)^-1 r_b`, at the solution of the
/// linearised problem with given priors; every `stride`-th of those judged, a column each [m].
/// @cite Allen 1974
template <class System>
Eigen::Matrix3Xd left_out_errors(const System& system, const FactorisedSystem& solved, Index stride) {
  Eigen::Matrix3Xd out(3, (system.judged + stride - 1) / stride);
  if (!solved.usable()) {
    out.setConstant(std::numeric_limits<double>::infinity());
    return out;
  }
  constexpr Index batch = 32;
  PoseRows rows;
  Rows6 expanded(6, system.unknowns());
  MatrixX block(system.unknowns(), 6 * batch), residuals(6, batch), roots(6, 6 * batch);
  VectorX units(batch);
  for (Index first = 0; first < out.cols(); first += batch) {
    const Index n = std::min(batch, out.cols() - first);
    for (Index b = 0; b < n; ++b) {
      system.rows((first + b) * stride, rows);
      rows.expand(system.functions_of, expanded);
      residuals.col(b) = rows.residual + expanded * solved.step;
      block.middleCols(6 * b, 6) = expanded.transpose();
      roots.middleCols(6 * b, 6) = rows.root;
      units(b) = rows.unit;
    }
    auto used = block.leftCols(6 * n);
    solved.factor.matrixL().solveInPlace(used);
    for (Index b = 0; b < n; ++b) {
      const auto z = block.middleCols(6 * b, 6);
      const Matrix6 rest = Matrix6::Identity() - z.transpose() * z;
      const Vector6 left = roots.middleCols(6 * b, 6) * rest.partialPivLu().solve(residuals.col(b));
      out.col(first + b) = left.head<3>() * units(b);
    }
  }
  return out;
}

/// What leave-one-pose-out says of a prior for some of the unknowns.
struct PriorChoice {
  double tightness;  ///< precision in units of sizes
  double with;       ///< mean left-out error with it [m]
  double best;       ///< the least mean left-out error of all that were tried [m]
  double without;    ///< the mean left-out error where the unknowns stay at zero [m]
};

/// A tightness that leaves nothing.
inline constexpr double nothing_left = 1e12;

/// Tries priors for unknowns `first .. first + count`, from somewhat looser than the expected sizes to none at all. The
/// tightest whose left-out errors are not worse than the best ones by more than a standard error of the difference
/// wins.
template <class System>
PriorChoice choose_prior(const System& system, const PoseNormalEquations& normal, VectorX precisions,
                         const VectorX& steps, Index first, Index count, Index stride) {
  struct Trial {
    double tightness;
    VectorX errors;
  };
  std::vector<Trial> trials;
  for (const double tightness : {0.3, 1.0, 3.0, 10.0, 100.0, 1e4, nothing_left}) {
    precisions.segment(first, count).setConstant(tightness);
    const FactorisedSystem solved(normal, precisions, steps);
    trials.push_back({tightness, left_out_errors(system, solved, stride).colwise().norm().transpose()});
  }
  const auto best = std::min_element(trials.begin(), trials.end(),
                                     [](const Trial& a, const Trial& b) { return a.errors.mean() < b.errors.mean(); });
  const auto chosen = std::find_if(trials.rbegin(), trials.rend(), [&](const Trial& t) {
    const VectorX worse = t.errors - best->errors;
    const double n = static_cast<double>(worse.size());
    return worse.mean() <= std::sqrt((worse.array() - worse.mean()).square().sum() / std::max(1.0, n * (n - 1)));
  });
  // errors that are not finite compare with nothing: then nothing is left
  const Trial& t = chosen == trials.rend() ? trials.back() : *chosen;
  return {t.tightness, t.errors.mean(), best->errors.mean(), trials.back().errors.mean()};
}

/// A pose left out: its error, the covariance that the unknowns give it, and the effect of joint noise of 1.
struct LeftOutVisit {
  Vector3 error;
  Matrix3 model, joint_noise;
};

/// The noise of a visit.
struct VisitNoise {
  double position = 0;  ///< standard deviation in space, per component [m]
  double joint = 0;     ///< of every joint [rad]
  double model = 1;     ///< factor on the covariances of the unknowns; below 1 where priors were wider than the truth
};

/// The most likely noise of visits: equal in space, and from joints that do not repeat; and how much of the unknowns'
/// covariance the errors bear out.
template <class Visit>
VisitNoise visit_noise(const std::vector<Visit>& visits) {
  double square_sum = 0, effect = 0;
  for (const Visit& v : visits) {
    square_sum += v.error.squaredNorm();
    effect += v.joint_noise.trace();
  }
  const double whole = square_sum / (3 * static_cast<double>(visits.size()));  // variance a component
  const double to_joints = square_sum / std::max(effect, 1e-300);
  VisitNoise out;
  double best = std::numeric_limits<double>::infinity();
  if (!(whole > 0)) return out;
  for (const double scale : {1.0, 0.7, 0.5, 0.35, 0.25})
    for (double of_space = 1.5 * whole; of_space > 1e-3 * whole; of_space /= 1.2)
      for (double share = 0; share < 1.5; share += 0.1) {
        double cost = 0;  // twice the negative logarithm of the likelihood
        for (const Visit& v : visits) {
          Matrix3 covariance = scale * v.model + share * to_joints * v.joint_noise;
          covariance.diagonal().array() += of_space;
          cost += std::log(covariance.determinant()) + v.error.dot(covariance.inverse() * v.error);
        }
        if (cost >= best) continue;
        best = cost;
        out = {std::sqrt(of_space), std::sqrt(share * to_joints), scale};
      }
  return out;
}

}  // namespace vernier::detail
