// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_table.hpp"

#include <fmt/format.h>

#include <numbers>

namespace support {

namespace {

const char* words(vernier::ParameterState state) {
  switch (state) {
    case vernier::ParameterState::fixed: return "not estimated";
    case vernier::ParameterState::identified: return "identified";
    case vernier::ParameterState::weak: return "weakly determined";
    default: return "not identifiable";
  }
}

}  // namespace

std::string parameter_table(const vernier::IdentificationReport& report) {
  std::string out =
      fmt::format("{:<12}{:>14}{:>14}{:>14}{:>12}\n", "parameter", "as designed", "identified", "change", "std. dev.");
  for (const vernier::ParameterEstimate& one : report.parameters) {
    const bool length = one.kind == vernier::ParameterKind::length;
    const double unit = length ? 1e3 : 180 / std::numbers::pi;
    const double nominal = one.nominal * unit, identified = one.identified * unit;
    out += fmt::format("{:<12}{:>10.3f} {:<3}{:>10.3f} {:<3}{:>9.4f} {:<4}", one.name, nominal, length ? "mm" : "deg",
                       identified, length ? "mm" : "deg", (one.identified - one.nominal) * 1e3, length ? "mm" : "mrad");
    out += one.std > 0 ? fmt::format("{:>12.4f}  {}\n", one.std * 1e3, words(one.state))
                       : fmt::format("{:>12}  {}\n", "", words(one.state));
  }
  return out;
}

}  // namespace support
