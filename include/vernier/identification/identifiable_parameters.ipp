// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier {

VERNIER_IMPL IdentifiableParameters::IdentifiableParameters(const ConstMatrixRef& jacobian, double tolerance) {
  const double largest = jacobian.cols() > 0 ? std::sqrt(detail::squared_column_norms(jacobian).maxCoeff()) : 0;
  MatrixX basis(jacobian.rows(), (std::min)(jacobian.rows(), jacobian.cols()));
  MatrixX triangle = MatrixX::Zero(basis.cols(), basis.cols());  // base columns = basis * triangle
  Index rank = 0;
  for (Index k = 0; k < jacobian.cols(); ++k) {
    VectorX column = VERNIER_LATER(jacobian).col(k);
    const double norm = column.norm();
    if (!(norm > 1e-9 * largest)) {
      dependent.push_back({k, {}});
      continue;
    }
    VectorX projection = VectorX::Zero(rank);
    double before = norm;
    for (int pass = 0; pass < 2; ++pass) {  // Gram-Schmidt: twice is enough, and once where little was subtracted
      const VectorX more = detail::transposed_product(VERNIER_LATER(basis).leftCols(rank), column);
      detail::add_product(column, VERNIER_LATER(basis).leftCols(rank), more, -1);
      projection += more;
      const double rest = column.norm();
      if (rest > 0.5 * before) break;
      before = rest;
    }
    if (rank < basis.cols() && column.norm() > tolerance * norm) {
      for (Index j = 0; j < rank; ++j) triangle(j, rank) = projection(j);
      triangle(rank, rank) = column.norm();
      VERNIER_LATER(basis).col(rank++) = column / column.norm();
      base.push_back(k);
      continue;
    }
    double largest_share = 0;
    for (Index j = rank - 1; j >= 0; --j) {  // the triangle's solution, in place
      projection(j) /= triangle(j, j);
      for (Index i = 0; i < j; ++i) projection(i) -= triangle(i, j) * projection(j);
      largest_share = (std::max)(largest_share, std::abs(projection(j)));
    }
    Dependent d{k, {}};
    for (Index j = 0; j < rank; ++j)
      if (std::abs(projection(j)) > 0.05 * largest_share) d.absorbed_by.push_back(base[static_cast<std::size_t>(j)]);
    dependent.push_back(std::move(d));
  }
}

}  // namespace vernier
