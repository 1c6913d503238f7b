// SPDX-License-Identifier: BSD-3-Clause
// KRL programs and data lists.
#include "robot_program_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_program(vernier::ProgramLanguage::krl, data, size);
}
