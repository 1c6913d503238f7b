#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier {

VERNIER_IMPL LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride) {
  const Index size = (system.validation_blocks + stride - 1) / stride;
  LeftOutBlocks out{Eigen::Matrix3Xd(3, size), VectorX::Constant(size, -std::numeric_limits<double>::infinity())};
  std::fill_n(out.errors.data(), 3 * size, std::numeric_limits<double>::infinity());
  if (!solved.usable()) return out;
  VectorX squares(size), log_determinants(size), values(size);  // of whitened errors; of I - H; measured ones
  constexpr Index batch = 32;
  const bool local = system.local_states > 0;
  solved.executor().for_ranges((size + batch - 1) / batch, [&](Index from, Index to) {
    std::vector<RowBlock> kept;
    Rows6 expanded(6, system.unknowns());
    MatrixX columns(system.unknowns(), 6 * batch), gains, rest;
    std::array<Vector6, batch> residuals;
    std::array<Matrix6, batch> unwhiten;
    VectorX sigmas(batch);
    for (Index first = from * batch; first < (std::min)(to * batch, size); first += batch) {
      const Index n = (std::min)(batch, size - first);
      kept.clear();
      detail::visit_blocks(system, first * stride, stride, n, [&](Index b, const RowBlock& rows) {
        rows.expand(system.group_sizes, expanded);
        const auto k = static_cast<std::size_t>(b);
        residuals[k] = rows.residual;
        detail::add_columns(expanded, solved.step().data(), 1, residuals[k].data());
        if (local) {
          for (const RowBlock::Local& part : rows.local)
            if (part.state >= 0)
              detail::add_columns(part.columns, &solved.local_step()(part.state * system.local_size), 1,
                                  residuals[k].data());
          solved.eliminate_local(rows, expanded);
          kept.push_back(rows);
        }
        unwhiten[k] = rows.unwhiten;
        sigmas(b) = rows.position_sigma;
        values(first + b) = 0;
        for (Index i = 0; i < 6; ++i) {
          for (Index c = 0; c < expanded.cols(); ++c) columns(c, 6 * b + i) = expanded(i, c);
          bool measured = !same_value(rows.residual(i), 0);
          for (Index c = 0; c < rows.dense.cols() && !measured; ++c) measured = !same_value(rows.dense(i, c), 0);
          if (measured) values(first + b) += 1;
        }
      });
      solved.apply_inverse_factor(columns.leftCols(6 * n));
      if (local) gains = solved.local_gains(kept);
      for (Index b = 0; b < n; ++b) {
        const auto z = columns.middleCols(6 * b, 6);
        rest.setIdentity(6, 6);
        detail::add_transposed_product(rest, z, z, -1);
        if (local) rest -= gains.middleCols(6 * b, 6);
        const auto k = static_cast<std::size_t>(b);
        Vector6 left_out = residuals[k];
        log_determinants(first + b) = detail::solve_general(rest, left_out);
        squares(first + b) = residuals[k].dot(left_out);
        const Vector6 error = unwhiten[k] * left_out;
        for (Index r = 0; r < 3; ++r) out.errors(r, first + b) = sigmas(b) * error(r);
      }
    }
  });
  const double variance = squares.sum() / values.sum();
  for (Index b = 0; b < size; ++b)
    out.log_densities(b) = -0.5 * (squares(b) / variance - log_determinants(b) + std::log(variance) * values(b));
  return out;
}

VERNIER_IMPL Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                   Index stride) {
  return leave_one_out(system, solved, stride).errors;
}

VERNIER_IMPL VectorX detail::error_norms(const Eigen::Matrix3Xd& errors) {
  VectorX out(errors.cols());
  for (Index b = 0; b < out.size(); ++b) out(b) = Vector3(errors(0, b), errors(1, b), errors(2, b)).norm();
  return out;
}

}  // namespace vernier
