// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Harmonics of all joints, laid out so that several joints are evaluated side by side.

#include <span>
#include <vector>

#include "vernier/error_terms/fourier.hpp"

namespace vernier::detail {

/// The transmissions of an arm with their coefficients. Joints are lanes of a vector; an order that only some joints
/// have is zero at the others.
class HarmonicTable {
 public:
  /// Nothing.
  HarmonicTable() = default;
  /// @param joints       harmonics of each joint
  /// @param coefficients of all joints, joint by joint
  VERNIER_API HarmonicTable(const std::vector<Fourier>& joints, std::span<const double> coefficients);

  /// Adds the transmissions' values to `effective`, and their slopes to the diagonal of `derivative`, n x n. Does not
  /// allocate.
  VERNIER_API void add(const double* q, int n, double* effective, double* derivative) const noexcept;

 private:
  std::vector<int> orders_{};    // of any joint, ascending
  std::vector<double> table_{};  // of each group of joints and order: cosine coefficients, then sine coefficients
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/detail/harmonic_table.ipp"
#endif
