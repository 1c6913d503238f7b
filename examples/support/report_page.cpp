// SPDX-License-Identifier: BSD-3-Clause
#include "report_page.hpp"

#include <algorithm>

#include "vernier/core/atomic_file.hpp"

namespace support {

std::vector<vernier::ReportFinding> audit_rows(const std::vector<std::string>& files,
                                               const std::vector<vernier::DataAudit>& audits) {
  constexpr std::size_t most = 5;  // rows that are named
  std::vector<vernier::ReportFinding> out;
  for (std::size_t k = 0; k < audits.size(); ++k)
    for (const vernier::DataFinding& finding : audits[k].findings) {
      std::string rows;
      for (std::size_t i = 0; i < std::min(most, finding.rows.size()); ++i)
        rows += vernier::message(i > 0 ? ", " : "", audits[k].origin.line[static_cast<std::size_t>(finding.rows[i])]);
      if (finding.rows.size() > most) rows += vernier::message(" and ", finding.rows.size() - most, " more");
      rows = rows.empty() ? "all" : (finding.rows.size() == 1 ? "line " : "lines ") + rows;
      out.push_back({std::string(vernier::fault_name(finding.kind)),
                     audits.size() > 1 ? vernier::message(rows, " of ", files[k]) : rows, finding.message});
    }
  return out;
}

void write_report(const Program& program, const std::string& path, vernier::ReportInput& report,
                  const std::string& date, const vernier::SourceFile& model) {
  report.provenance.command = program.command_line();
  report.provenance.date = date;
  report.provenance.seed = program.common().seed;
  report.provenance.model = shown(model.name);
  report.provenance.model_sha256 = model.hash;
  vernier::write_file(path, vernier::report_html(report));
}

}  // namespace support
