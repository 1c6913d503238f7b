#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier {

VERNIER_IMPL IdentifiableParameters::IdentifiableParameters(const ConstMatrixRef& jacobian, double tolerance) {
  const double largest = jacobian.cols() > 0 ? std::sqrt(jacobian.colwise().squaredNorm().maxCoeff()) : 0;
  MatrixX basis(jacobian.rows(), std::min(jacobian.rows(), jacobian.cols()));
  MatrixX triangle = MatrixX::Zero(basis.cols(), basis.cols());  // base columns = basis * triangle
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
    for (int pass = 0; pass < 2; ++pass) {  // Gram-Schmidt: twice is enough, and once where little was subtracted
      const VectorX more = basis.leftCols(rank).transpose() * column;
      column -= basis.leftCols(rank) * more;
      projection += more;
      const double rest = column.norm();
      if (rest > 0.5 * before) break;
      before = rest;
    }
    if (rank < basis.cols() && column.norm() > tolerance * norm) {
      triangle.col(rank).head(rank) = projection;
      triangle(rank, rank) = column.norm();
      basis.col(rank++) = column / column.norm();
      base.push_back(k);
      continue;
    }
    const VectorX shares =
        triangle.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(projection).cwiseAbs();
    Dependent d{k, {}};
    for (Index j = 0; j < rank; ++j)
      if (shares(j) > 0.05 * shares.maxCoeff()) d.absorbed_by.push_back(base[static_cast<std::size_t>(j)]);
    dependent.push_back(std::move(d));
  }
}

}  // namespace vernier
