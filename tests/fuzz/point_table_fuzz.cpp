// SPDX-License-Identifier: BSD-3-Clause
// Points of a tracker's table, in the format that the first character stands for.
#include "reader_fuzz.hpp"
#include "vernier/data/point_table.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vernier::PointTableFormat format;
  if (size > 0 && data[0] == '/') format = vernier::PointTableFormat::spatial_analyzer(1e-3);
  if (size > 0 && data[0] == ';') format = {.separator = ';', .decimal = ',', .header_lines = 1};
  return vernier::fuzz::read_as_file(
      data, size, [&](const std::string& path) { static_cast<void>(vernier::read_point_table(path, format)); });
}
