// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "vernier/io/audit_json.hpp"

namespace vernier {

VERNIER_IMPL nlohmann::ordered_json to_json(const DataAudit& audit) {
  using Json = nlohmann::ordered_json;
  Json findings = Json::array();
  for (const DataFinding& finding : audit.findings) {
    findings.push_back({{"kind", std::string(fault_name(finding.kind))},
                        {"joint", finding.joint < 0 ? Json() : Json(finding.joint + 1)},
                        {"rows", finding.rows},
                        {"size", finding.size},
                        {"message", finding.message}});
    for (std::size_t k = 0; k < finding.rows.size() && !audit.origin.empty(); ++k)
      findings.back()["lines"].push_back(audit.origin.line[static_cast<std::size_t>(finding.rows[k])]);
  }
  const ErrorStatistics& e = audit.registered;
  return {{"findings", std::move(findings)},
          {"registered",
           {{"rows", e.n},
            {"median_mm", e.median * 1e3},
            {"rms_mm", e.rms * 1e3},
            {"p95_mm", e.p95 * 1e3},
            {"max_mm", e.max * 1e3}}}};
}

}  // namespace vernier
