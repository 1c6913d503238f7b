// SPDX-License-Identifier: BSD-3-Clause
#include "payload_option.hpp"

namespace support {

void PayloadOption::add_to(Program& program, const char* help) {
  const Option given = program.add_option("--payload-kg", mass, help, "KG").within(0.0, 1e5);
  program
      .add_option("--payload-centre", centre_mm,
                  "its centre in the frame of the flange [mm]; by default at the tool point", "X,Y,Z")
      .delimiter(',')
      .expected(3)
      .needs(given);
}

vernier::Payload PayloadOption::payload() const {
  vernier::Payload out{.mass = mass.value_or(0)};
  if (!centre_mm.empty()) out.centre = 1e-3 * vernier::Vector3(centre_mm[0], centre_mm[1], centre_mm[2]);
  return out;
}

void refuse_payload() {
  throw UsageError("--payload-kg: the measurements of the model state no payload; calibrate with a column payload_kg");
}

}  // namespace support
