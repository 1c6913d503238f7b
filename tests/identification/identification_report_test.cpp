// SPDX-License-Identifier: BSD-3-Clause
// What reports of an identification say, word by word, of figures given by hand.

#include "vernier/identification/identification_report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/identification/contact_report.hpp"

namespace vernier::identification_report_test {
namespace {

using vernier_test::RealMatrix;

ParameterEstimate parameter(const char* name, ParameterState state, const char* remark = "") {
  return {name, ParameterKind::length, 0, 0, 0, state, remark};
}

/// Estimated are the tool, beta2 and a1, in this order; tool and a1 are correlated.
template <class Report>
Report example() {
  Report out;
  out.message = "steps are small after 3 iterations";
  out.rms_before = 1.23456e-3;
  out.rms_after = 0.05e-3;
  out.rotation_rms_after = 0.25e-3;
  out.parameters = {parameter("beta3", ParameterState::fixed), parameter("beta2", ParameterState::identified),
                    parameter("a1", ParameterState::weak), parameter("tool_x", ParameterState::identified),
                    parameter("tool_rz", ParameterState::not_identifiable, "absorbed by theta6")};
  out.free = {3, 1, 2};
  // deviations 1, 2, 3; correlations 0.5, -0.98 and -0.4
  out.covariance = RealMatrix(3, 3, {1, 1, -2.94, 1, 4, -2.4, -2.94, -2.4, 9});
  out.rank = 4;
  out.condition = 57.3;
  return out;
}

TEST(IdentificationReport, SummaryByHand) {
  IdentificationReport report = example<IdentificationReport>();
  EXPECT_EQ(report.names(ParameterState::identified), (std::vector<std::string>{"beta2", "tool_x"}));
  EXPECT_EQ(report.summary(),
            "Converged: steps are small after 3 iterations\n"
            "Position error (rms): 1.2346 mm with registered frames and nominal links, 0.0500 mm identified.\n"
            "Orientation error (rms): 0.250 mrad identified.\n"
            "Parameters estimated: 3, rank 4, condition 57.\n"
            "Consecutive axes nearly parallel: beta2 (Hayati) estimated in place of d2.\n"
            "Weakly determined, regularised by priors around nominal: a1.\n"
            "Strongly correlated: tool_x and a1 (-0.98).\n"
            "Not identifiable: tool_rz, absorbed by theta6.\n");
  report.status = IdentifyStatus::underdetermined;
  report.condition = std::numeric_limits<double>::infinity();
  report.rotation_rms_after = 0;
  report.parameters.resize(1);
  report.free.clear();
  report.covariance.resize(0, 0);
  EXPECT_EQ(report.summary(),
            "UNDERDETERMINED: steps are small after 3 iterations\n"
            "Position error (rms): 1.2346 mm with registered frames and nominal links, 0.0500 mm identified.\n"
            "Parameters estimated: 0, rank 4, condition infinite.\n");
  report.status = IdentifyStatus::not_converged;
  EXPECT_EQ(report.summary().rfind("NOT CONVERGED: steps", 0), 0u) << report.summary();
}

/// Four estimates with the upper triangle of their correlations, row by row.
IdentificationReport correlated_report(const std::array<double, 6>& upper) {
  IdentificationReport report = example<IdentificationReport>();
  report.parameters[0] = parameter("d1", ParameterState::identified);
  report.free = {3, 1, 2, 0};
  const auto [a, b, c, d, e, f] = upper;
  report.covariance = RealMatrix(4, 4, {1, a, b, c, a, 1, d, e, b, d, 1, f, c, e, f, 1});
  return report;
}

// Four of six pairs are named, the strongest first.
TEST(IdentificationReport, PairsByTheirStrength) {
  const IdentificationReport report = correlated_report({0.96, 0.97, -0.98, 0.99, 0.955, 0.965});
  EXPECT_EQ(report.strongly_correlated(0.975),
            (std::vector<std::string>{"beta2 and a1 (+0.99)", "tool_x and d1 (-0.98)"}));
  const std::string text = report.summary();
  EXPECT_NE(text.find("Strongly correlated: beta2 and a1 (+0.99), tool_x and d1 (-0.98), tool_x and a1 (+0.97), a1 and "
                      "d1 (+0.96), and 2 more pairs.\n"),
            std::string::npos)
      << text;
}

// Where four are all there are, none is left to be counted.
TEST(IdentificationReport, FourPairsAreNamed) {
  const std::string text = correlated_report({0.96, 0.97, -0.98, 0.99, 0, 0}).summary();
  EXPECT_NE(text.find("Strongly correlated: beta2 and a1 (+0.99), tool_x and d1 (-0.98), tool_x and a1 (+0.97), tool_x "
                      "and beta2 (+0.96).\n"),
            std::string::npos)
      << text;
}

TEST(ContactReport, SummaryByHand) {
  ContactReport report = example<ContactReport>();
  report.parameters.insert(report.parameters.begin(),
                           parameter("base_x", ParameterState::not_identifiable, "contacts are relative to the arm"));
  report.parameters.push_back(parameter("tool_ry", ParameterState::not_identifiable, "no effect on touches"));
  report.parameters.push_back(parameter("d3", ParameterState::not_identifiable, "absorbed by d2"));
  report.singular_values = VectorX::Ones(45);
  report.unobservable = 15;
  report.missing = 2;
  report.objects = {{"table", ContactKind::plane, 20, Vector3::Zero(), Vector3::UnitZ(), 0.0125e-3},
                    {"ball", ContactKind::ball, 7, Vector3::Zero(), Vector3::Zero(), 0.5e-3}};
  EXPECT_EQ(report.summary(),
            "Converged: steps are small after 3 iterations\n"
            "Touches miss what they touch by (rms): 1.2346 mm with nominal links, 0.0500 mm identified.\n"
            "  table: plane, 20 touches, 0.0125 mm\n"
            "  ball: ball, 7 touches, 0.5000 mm\n"
            "Parameters estimated: 3, condition 57.\n"
            "Weakly determined, held near nominal by their priors: a1.\n"
            "Contacts do not observe (15 of 45 directions):\n"
            "  - the base frame (6 directions): contacts are relative to the arm; base_x .. base_rz stay nominal.\n"
            "  - d3 (1 direction): absorbed by d2.\n"
            "  - the orientation of the tool: tool_rz, tool_ry have no effect on touches.\n");
  report.scale_observable = false;
  report.status = IdentifyStatus::underdetermined;
  report.condition = std::numeric_limits<double>::infinity();
  const std::string text = report.summary();
  EXPECT_EQ(text.rfind("UNDERDETERMINED: steps", 0), 0u) << text;
  EXPECT_NE(text.find("condition infinite."), std::string::npos) << text;
  EXPECT_NE(
      text.find("stay nominal.\n  - the scale of the arm (1 direction): no contact has a known length; the lengths "
                "of its links, taken together, stay nominal.\n  - d3"),
      std::string::npos)
      << text;
  report.status = IdentifyStatus::not_converged;
  EXPECT_EQ(report.summary().rfind("NOT CONVERGED: steps", 0), 0u);
}

}  // namespace
}  // namespace vernier::identification_report_test
