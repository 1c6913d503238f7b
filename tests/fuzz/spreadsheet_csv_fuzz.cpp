// SPDX-License-Identifier: BSD-3-Clause
// Measured poses with semicolons and decimal commas, of two joints, and what is remarked on them.
#include "reader_fuzz.hpp"
#include "vernier/data/csv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    const auto remark = [](const std::string& line) {
      vernier::fuzz::check_complaint(line);
      vernier::fuzz::complaint.clear();  // the file is taken
    };
    const vernier::CsvFormat format{.separator = ';', .decimal = ',', .remark = remark};
    static_cast<void>(vernier::read_dataset<2>(path, {}, format));
    static_cast<void>(vernier::read_csv_text(path, format));
  });
}
