#pragma once

/// @file
/// Which parameters the data determine, and how well: selection of independent columns, covariance, condition.

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Columns of a Jacobian that say something new, given an order of preference; what the others depend on.
struct IndependentColumns {
  struct Dependent {
    Index column;
    std::vector<Index> absorbed_by;  ///< empty: the column is zero, nothing measured depends on it
  };
  std::vector<Index> kept;  ///< in order of preference
  std::vector<Dependent> dependent;

  /// @param jacobian  rows x columns, columns scaled to expected sizes
  /// @param tolerance a column is dependent when less than this share of it is new
  IndependentColumns(const MatrixX& jacobian, double tolerance = 1e-7) {
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
      for (int pass = 0; pass < 2; ++pass) {  // twice is enough
        const VectorX more = basis.leftCols(rank).transpose() * column;
        column -= basis.leftCols(rank) * more;
        projection += more;
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

/// Covariance and condition of a weighted linear least-squares problem with some prior rows.
struct Precision {
  MatrixX covariance;  ///< of the columns' steps; empty where the rank is deficient
  Index rank = 0;
  double condition = 0;  ///< largest over smallest singular value; infinity where the rank is deficient

  /// @param jacobian whitened rows, @param row_variance variance of each whitened row as estimated from residuals
  /// @param prior    inverse squared prior deviations per column, zero for none
  Precision(const MatrixX& jacobian, const VectorX& row_variance, const VectorX& prior) {
    const Index columns = jacobian.cols();
    MatrixX stacked(jacobian.rows() + columns, columns);
    stacked << jacobian, MatrixX(prior.cwiseSqrt().asDiagonal());
    const MatrixX r = Eigen::HouseholderQR<MatrixX>(stacked).matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    const Eigen::JacobiSVD<MatrixX> svd(r, Eigen::ComputeFullV);
    const VectorX& s = svd.singularValues();
    rank = columns == 0 ? 0 : (s.array() > 1e-12 * s(0)).count();
    condition = columns == 0 ? 1 : rank < columns ? std::numeric_limits<double>::infinity() : s(0) / s(columns - 1);
    if (rank < columns) return;
    // sandwich: A^-1 (J' D J + prior) A^-1 with A = J'J + prior
    const MatrixX inverse =
        svd.matrixV() * s.array().square().inverse().matrix().asDiagonal() * svd.matrixV().transpose();
    MatrixX middle = jacobian.transpose() * row_variance.asDiagonal() * jacobian;
    middle.diagonal() += prior;
    covariance = inverse * middle * inverse;
  }
};

}  // namespace vernier::detail
