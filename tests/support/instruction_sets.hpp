// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Which kernels this machine can run.

#include <vector>

#include "vernier/core/simd.hpp"

namespace vernier_test {

/// All instruction sets that are there.
inline std::vector<vernier::InstructionSet> instruction_sets() {
  using vernier::InstructionSet;
  std::vector<InstructionSet> out{InstructionSet::baseline};
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512})
    if (vernier::widest_instruction_set() >= set) out.push_back(set);
  return out;
}

}  // namespace vernier_test
