// Audits of data as JSON.

#include "vernier/io/audit_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
  ASSERT_EQ(json["findings"].size(), 2u);
  EXPECT_EQ(json["findings"][0]["kind"], "joint_sign");
  EXPECT_EQ(json["findings"][0]["joint"], 3);
  EXPECT_TRUE(json["findings"][0]["rows"].empty());
  EXPECT_TRUE(json["findings"][1]["joint"].is_null());
  EXPECT_EQ(json["findings"][1]["rows"], (std::vector<int>{4, 9}));
  EXPECT_EQ(json["findings"][1]["size"], 0.25);
  EXPECT_EQ(json["findings"][1]["message"], "rows 4 and 9");
  EXPECT_EQ(json["registered"]["rows"], 50);
  EXPECT_DOUBLE_EQ(json["registered"]["median_mm"], 2);
  EXPECT_DOUBLE_EQ(json["registered"]["max_mm"], 10);
  EXPECT_DOUBLE_EQ(json["registered"]["rms_mm"], 3);
  EXPECT_DOUBLE_EQ(json["registered"]["p95_mm"], 8);
}

TEST(AuditJson, IsWellFormedWithoutFindings) {
  const nlohmann::ordered_json json = to_json(DataAudit{});
  EXPECT_TRUE(json["findings"].is_array());
  EXPECT_TRUE(json["findings"].empty());
}

}  // namespace
}  // namespace vernier::audit_json_test
