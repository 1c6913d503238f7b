// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cholmod.h>

#include <cmath>
#include <new>

#include "vernier/cholmod/solver.hpp"

namespace vernier {

VERNIER_IMPL SparseOutcome CholmodSolver::operator()(const SparseSymmetric& matrix, MatrixRef right) const {
  struct Session {
    cholmod_common common{};
    cholmod_factor* factor = nullptr;
    cholmod_dense* solution = nullptr;
    Session() { cholmod_start(&common); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    ~Session() {
      cholmod_free_dense(&solution, &common);
      cholmod_free_factor(&factor, &common);
      cholmod_finish(&common);
    }
  } session;
  cholmod_common& common = session.common;
  common.print = 0;
  common.quick_return_if_not_posdef = 1;

  // CHOLMOD reads these and has no const
  SparseSymmetric a = matrix;
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = static_cast<std::size_t>(a.size);
  sparse.nzmax = a.values.size();
  sparse.p = a.starts.data();
  sparse.i = a.rows.data();
  sparse.x = a.values.data();
  sparse.stype = -1;  // the lower triangle of a symmetric matrix
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = sparse.packed = 1;
  const auto check_memory = [&] {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  };
  session.factor = cholmod_analyze(&sparse, &common);
  check_memory();
  if (session.factor == nullptr || !cholmod_factorize(&sparse, session.factor, &common)) check_memory();
  if (session.factor == nullptr || common.status != CHOLMOD_OK) return {};

  MatrixX copy = right;
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(copy.rows());
  b.ncol = static_cast<std::size_t>(copy.cols());
  b.nzmax = static_cast<std::size_t>(copy.size());
  b.x = copy.data();
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  session.solution = cholmod_solve(CHOLMOD_A, session.factor, &b, &common);
  check_memory();
  if (session.solution == nullptr) return {};
  right = Eigen::Map<const MatrixX>(static_cast<const double*>(session.solution->x), right.rows(), right.cols());

  // a simplicial L has the determinant on its diagonal, as LL' or LDL'
  const bool squared = session.factor->is_ll != 0;
  cholmod_change_factor(CHOLMOD_REAL, session.factor->is_ll, 0, 1, 1, session.factor, &common);
  check_memory();
  const auto* starts = static_cast<const int*>(session.factor->p);
  const auto* values = static_cast<const double*>(session.factor->x);
  SparseOutcome out{true, 0};
  for (Index k = 0; k < a.size; ++k) {
    const double pivot = values[starts[k]];
    if (!(pivot > 0)) return {};
    out.log_determinant += (squared ? 2 : 1) * std::log(pivot);
  }
  return out;
}

}  // namespace vernier
