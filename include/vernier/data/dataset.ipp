// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/dataset.hpp"

#include <cmath>

namespace vernier::detail {

VERNIER_IMPL bool finite_row(const ConstMatrixRef& values, Index row) {
  for (Index j = 0; j < values.cols(); ++j)
    if (!std::isfinite(values(row, j))) return false;
  return true;
}

VERNIER_IMPL void check_measured_samples(const ConstMatrixRef& joints, const PointRows& positions,
                                         const PointRows& orientations) {
  const Index n = joints.rows();
  demand(n == positions.rows(), "Dataset: ", n, " rows of joints, but ", positions.rows(), " rows of positions");
  demand(orientations.rows() == 0 || orientations.rows() == n, "Dataset: ", n, " rows of joints, but ",
         orientations.rows(), " rows of orientations");
  for (Index i = 0; i < n; ++i)
    demand(
        finite_row(joints, i) && finite_row(positions, i) && (orientations.rows() == 0 || finite_row(orientations, i)),
        "Dataset: row ", i, " has a value that is not finite");
}

VERNIER_IMPL void check_payloads(const MatrixX& payloads, Index rows) {
  if (payloads.rows() == 0) return;
  demand(payloads.rows() == rows && payloads.cols() == 4, "Dataset: ", payloads.rows(), " x ", payloads.cols(),
         " values of payloads for ", rows, " rows, four each");
  for (Index i = 0; i < rows; ++i)
    demand(payloads(i, 0) >= 0 && std::isfinite(payloads(i, 0)), "Dataset: row ", i, " has a payload of ",
           payloads(i, 0), " kg, must be 0 or more");
  for (Index i = 0; i < rows; ++i)
    for (Index k = 1; k < 4; ++k)
      demand(std::isfinite(payloads(i, k)) == std::isfinite(payloads(0, k)), "Dataset: row ", i,
             " has a payload whose centre is ", std::isfinite(payloads(0, k)) ? "not known" : "known",
             ", unlike that of the first row");
}

VERNIER_IMPL [[noreturn]] void refuse_coordinates(Index columns) {
  throw std::invalid_argument(message(counted(columns, "coordinate", "coordinates"), " for a point in space"));
}

VERNIER_IMPL bool positive_definite(const Matrix6& covariance, Index measured) {
  Matrix6 rest = covariance;  // by elimination
  for (Index k = 0; k < measured; ++k) {
    if (!(rest(k, k) > 1e-12 * covariance(k, k)) || !(covariance(k, k) > 0) || !std::isfinite(rest(k, k))) return false;
    for (Index r = k + 1; r < measured; ++r)
      for (Index c = k + 1; c < measured; ++c) rest(r, c) -= rest(r, k) * rest(k, c) / rest(k, k);
  }
  return true;
}

VERNIER_IMPL void check_covariances(const std::vector<Matrix6>& covariances, Index samples, bool oriented) {
  demand(covariances.empty() || static_cast<Index>(covariances.size()) == samples, "Dataset: ", covariances.size(),
         " covariances of ", samples, " rows");
  for (std::size_t i = 0; i < covariances.size(); ++i)
    demand(positive_definite(covariances[i], oriented ? 6 : 3), "Dataset: the covariance of row ", i,
           " is not positive definite");
}

VERNIER_IMPL void copy_rows(const ConstMatrixRef& from, std::span<const Index> indices, MatrixRef to) {
  for (Index i = 0; i < to.rows(); ++i) {
    const Index row = indices[static_cast<std::size_t>(i)];
    demand(row >= 0 && row < from.rows(), "rows: row ", row, " of ", from.rows());
    for (Index j = 0; j < to.cols(); ++j) to(i, j) = from(row, j);
  }
}

}  // namespace vernier::detail
