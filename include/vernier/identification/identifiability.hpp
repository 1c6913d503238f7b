#pragma once

/// @file
/// Which parameters the data determine, and how well: independent columns, covariance, leave-one-pose-out.

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/identification/linearisation.hpp"

namespace vernier::detail {

/// Columns of a Jacobian that say something new, given an order of preference; what the others depend on.
struct IndependentColumns {
  /// A column that says nothing new.
  struct Dependent {
    Index column;
    std::vector<Index> absorbed_by;  ///< empty: the column is zero, nothing measured depends on it
  };
  std::vector<Index> kept;  ///< in order of preference
  std::vector<Dependent> dependent;

  /// @param jacobian  rows x columns, columns scaled to expected sizes, in order of preference
  /// @param tolerance a column is dependent when less than this share of it is new
  template <class Derived>  // a template, as all below, so that only its users pay for compiling decompositions
  explicit IndependentColumns(const Eigen::MatrixBase<Derived>& jacobian, double tolerance = 1e-7) {
    const double largest = jacobian.cols() > 0 ? std::sqrt(jacobian.colwise().squaredNorm().maxCoeff()) : 0;
    MatrixX basis(jacobian.rows(), std::min(jacobian.rows(), jacobian.cols()));
    MatrixX triangle = MatrixX::Zero(basis.cols(), basis.cols());  // kept columns = basis * triangle
    Index rank = 0;
    for (Index k = 0; k < jacobian.cols(); ++k) {
      VectorX column = jacobian.col(k);
      const double norm = column.norm();
      if (!(norm > 1e-9 * largest)) {
        dependent.push_back({k, {}});
        continue;
      }
      VectorX projection = VectorX::Zero(rank);
      double before = norm;
      for (int pass = 0; pass < 2; ++pass) {  // twice is enough, and once where little was taken off
        const VectorX more = basis.leftCols(rank).transpose() * column;
        column -= basis.leftCols(rank) * more;
        projection += more;
        const double left = column.norm();
        if (left > 0.5 * before) break;
        before = left;
      }
      if (rank < basis.cols() && column.norm() > tolerance * norm) {
        triangle.col(rank).head(rank) = projection;
        triangle(rank, rank) = column.norm();
        basis.col(rank++) = column / column.norm();
        kept.push_back(k);
        continue;
      }
      const VectorX shares =
          triangle.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(projection).cwiseAbs();
      Dependent d{k, {}};
      for (Index j = 0; j < rank; ++j)
        if (shares(j) > 0.05 * shares.maxCoeff()) d.absorbed_by.push_back(kept[static_cast<std::size_t>(j)]);
      dependent.push_back(std::move(d));
    }
  }
};

/// How well a weighted least-squares problem with some prior rows determines its unknowns, in steps of their sizes.
struct Precision {
  MatrixX inverse;          ///< (J'J + prior)^-1; empty where it is singular
  MatrixX covariance;       ///< of the unknowns; empty where singular
  Index rank = 0;           ///< of J, without priors
  double condition = 0;     ///< of J, without priors: largest over smallest singular value
  VectorX singular_values;  ///< of J, without priors

  /// @param jacobian     whitened rows
  /// @param row_variance variance of each whitened row as estimated from residuals
  /// @param prior        inverse squared prior deviations per column, zero for none
  template <class Derived>
  Precision(const Eigen::MatrixBase<Derived>& jacobian, const VectorX& row_variance, const VectorX& prior) {
    const Index columns = jacobian.cols();
    if (columns == 0) {
      condition = 1;
      return;
    }
    const Index height = std::min(jacobian.rows(), columns);
    const Eigen::HouseholderQR<MatrixX> qr(jacobian);
    MatrixX triangle = MatrixX::Zero(columns, columns);
    triangle.topRows(height) = qr.matrixQR().topRows(height).template triangularView<Eigen::Upper>();
    Eigen::JacobiSVD<MatrixX> svd(triangle, Eigen::ComputeFullV);
    const VectorX data = svd.singularValues();
    singular_values = data;
    rank = (data.array() > 1e-12 * data(0)).count();
    condition = rank < columns ? std::numeric_limits<double>::infinity() : data(0) / data(columns - 1);
    if (!prior.isZero(0)) {
      MatrixX stacked(2 * columns, columns);
      stacked << triangle, MatrixX(prior.cwiseSqrt().asDiagonal());
      svd.compute(stacked, Eigen::ComputeFullV);
    }
    const VectorX& s = svd.singularValues();
    if (!(s(columns - 1) > 1e-12 * s(0))) return;
    inverse = svd.matrixV() * s.array().square().inverse().matrix().asDiagonal() * svd.matrixV().transpose();
    // sandwich: A^-1 (J' D J + prior) A^-1 with A = J'J + prior
    MatrixX middle = jacobian.transpose() * row_variance.asDiagonal() * jacobian;
    middle.diagonal() += prior;
    covariance = inverse * middle * inverse;
  }
};

/// Root mean square, over poses, of the position or distance residual (whitened) of each pose when it is left out, in
/// closed form: `e_b = (I - H_bb)^-1 r_b` with all rows of the pose in block b.
/// @cite Allen 1974
template <class Derived>
double leave_one_pose_out(const Linearisation& at, Index poses, const Eigen::MatrixBase<Derived>& inverse) {
  if (inverse.size() == 0) return std::numeric_limits<double>::infinity();
  const Index size = at.residuals.size() / poses;  // 1, 3, or 6 with orientations
  const Index group = at.group;
  MatrixX rows(size, at.jacobian.cols());
  VectorX residual(size);
  double sum = 0;
  for (Index i = 0; i < poses; ++i) {
    for (Index part = 0; part < size / group; ++part) {
      rows.middleRows(group * part, group) = at.jacobian.middleRows(group * (part * poses + i), group);
      residual.segment(group * part, group) = at.residuals.segment(group * (part * poses + i), group);
    }
    const MatrixX left = MatrixX::Identity(size, size) - rows * inverse * rows.transpose();
    sum += left.partialPivLu().solve(residual).head(group).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(poses));
}

}  // namespace vernier::detail
