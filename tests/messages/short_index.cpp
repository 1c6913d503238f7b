// SPDX-License-Identifier: BSD-3-Clause
// Indices of 32 bits.
// expect: Vernier counts in 64 bits: compile for a machine of 64 bits, without EIGEN_DEFAULT_DENSE_INDEX_TYPE
// flags: -DEIGEN_DEFAULT_DENSE_INDEX_TYPE=int
#ifdef MISTAKE
#include <vernier/core/rng.hpp>
#endif
