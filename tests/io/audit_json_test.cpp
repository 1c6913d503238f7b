// SPDX-License-Identifier: BSD-3-Clause
// Audits of data as JSON.

#include "vernier/io/audit_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "json_parts.hpp"

namespace vernier::audit_json_test {
namespace {

TEST(AuditJson, HasEveryFinding) {
  DataAudit audit;
  audit.findings.push_back({FaultKind::joint_sign, 2, {}, 0, "all rows: joint 3 counts in the other direction"});
  audit.findings.push_back({FaultKind::swapped_rows, -1, {4, 9}, 0.25, "rows 4 and 9"});
  audit.registered.n = 50;
  audit.registered.median = 0.002;
  audit.registered.max = 0.01;
  audit.registered.rms = 0.003;
  audit.registered.p95 = 0.008;
  const nlohmann::ordered_json json = to_json(audit);
  vernier_test::expect_parts(json, R"({
    "findings": [{"kind": "joint_sign", "joint": 3, "rows": []},
                 {"joint": null, "rows": [4, 9], "size": 0.25, "message": "rows 4 and 9"}],
    "registered": {"rows": 50, "median_mm": 2, "max_mm": 10, "rms_mm": 3, "p95_mm": 8}})");
}

}  // namespace
}  // namespace vernier::audit_json_test
