#include "report_page.hpp"

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"

namespace support {

vernier::ReportFile file_read(const std::string& path, vernier::Index rows) {
  return {path, rows, vernier::sha256(vernier::read_file(path))};
}

void write_report(const Program& program, const std::string& path, vernier::ReportInput& report,
                  const std::string& date, const std::string& model) {
  report.provenance.command = program.command_line();
  report.provenance.date = date;
  report.provenance.seed = program.common().seed;
  report.provenance.model = model;
  if (!model.empty()) report.provenance.model_sha256 = vernier::sha256(vernier::read_file(model));
  vernier::write_file(path, vernier::report_html(report));
}

}  // namespace support
