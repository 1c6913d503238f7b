// SPDX-License-Identifier: BSD-3-Clause
// URScript programs.
#include "robot_program_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_program(vernier::ProgramLanguage::urscript, data, size);
}
