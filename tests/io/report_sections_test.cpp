// SPDX-License-Identifier: BSD-3-Clause
// What the page of a report says: numbers and sentences of its sections, by hand for few poses.

#include "vernier/io/detail/report_sections.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "page_text.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/pose_view.hpp"
#include "vernier/io/detail/report_functions.hpp"
#include "vernier/io/detail/report_verdict.hpp"
#include "vernier/io/detail/svg_chart.hpp"
#include "vernier/io/html_report.hpp"

namespace vernier::report_sections_test {
namespace {

using detail::ChartStyle;
using vernier_test::between;
using vernier_test::has;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t out = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++out;
  return out;
}

/// The cells of a row of a table by its heading, joined by bars.
std::string row(const std::string& table, const std::string& heading) {
  const std::string cells = between(table, "<th scope=\"row\">" + heading + "</th>", "</tr>");
  std::string out;
  for (std::size_t at = 0; (at = cells.find("<td", at)) != std::string::npos;) {
    const std::size_t begin = cells.find('>', at) + 1, end = cells.find("</td>", begin);
    out += (out.empty() ? "" : "|") + cells.substr(begin, end - begin);
    at = end;
  }
  return out;
}

/// Numbers of a path in the order in which they stand there.
std::vector<double> numbers_of(const std::string& path) {
  std::vector<double> out;
  for (std::size_t k = 0; k < path.size();) {
    const bool begins = (path[k] >= '0' && path[k] <= '9') || path[k] == '-';
    if (!begins) {
      ++k;
      continue;
    }
    std::size_t length = 0;
    out.push_back(std::stod(path.substr(k), &length));
    k += length;
  }
  return out;
}

/// Errors of 0, 1, .. n - 1 mm after and 20 mm more before.
ReportInput input_of(Index n = 21) {
  ReportInput out;
  out.robot = "arm";
  VectorX errors(n), before(n);
  for (Index i = 0; i < n; ++i) {
    errors(i) = 1e-3 * static_cast<double>(i);
    before(i) = errors(i) + 20e-3;
  }
  out.stages = {{Stage::frames, "frames alone", before, {}},
                {Stage::geometry, "geometry", before / 2, {}},
                {Stage::elastic, "elastic", before / 3, {}},
                {Stage::jointwise, "joint-wise", errors, {}}};
  out.after = Stage::jointwise;
  return out;
}

// Mean 10, variance 38.5; Student's t of 20 degrees of freedom at 0.975 is 2.086.
TEST(ReportSections, Verdict) {
  ReportInput input = input_of();
  input.headline = "Good.";
  input.rule = "every fifth row";
  input.train_poses = 84;
  const double half = 2.085963 * std::sqrt(38.5 / 21);
  std::string text = detail::verdict_section(input);
  EXPECT_TRUE(has(text,
                  "<p class=\"verdict \">Good. Held-out position error <strong data-value=\"10\">10 mm</strong> "
                  "(mean; 95 % interval " +
                      detail::fixed_digits(10 - half, 2) + " to " + detail::fixed_digits(10 + half, 1) +
                      " mm), 95 % of the poses within 19 mm, largest 20 mm; before 30 mm.</p>"))
      << text;
  EXPECT_TRUE(has(text, "Of 21 held-out poses (every fifth row), fitted to 84 others.")) << text;
  EXPECT_FALSE(has(text, "Look at this"));
  input.accept = 12e-3;  // within the interval
  input.passed = false;
  input.held_out = false;
  input.before = input.after;
  text = detail::verdict_section(input);
  EXPECT_TRUE(has(text, "<p class=\"verdict no\">Good. Position error ")) << text;
  EXPECT_TRUE(has(text, "largest 20 mm. Accepted up to 12 mm: <strong>not decided")) << text;
  EXPECT_TRUE(has(text, "Of 21 poses (every fifth row)"));
  input.passed = true;
  EXPECT_TRUE(has(detail::verdict_section(input), "<p class=\"verdict yes\">"));
  input.passed.reset();
  EXPECT_TRUE(has(detail::verdict_section(input), "<p class=\"verdict \">"));
}

/// The sentences of what deserves a look.
std::string look_at(const ReportInput& input) {
  return between(detail::verdict_section(input), "Look at this:</p>", "</ul>");
}

TEST(ReportSections, WhatDeservesALook) {
  ReportInput input = input_of();
  input.audit.emplace();
  EXPECT_EQ(look_at(input), "");
  // by chance 95 +- 9.3 % of 21 poses
  for (const double share : {0.87, 1.0}) {
    input.ellipsoid_coverage = share;
    EXPECT_EQ(look_at(input), "") << share;
  }
  input.ellipsoid_coverage = 0.8;
  EXPECT_TRUE(has(look_at(input),
                  "#where\">The predicted 95 % ellipsoids contain 80 % of the errors: predicted "
                  "uncertainties are too small."));
  input = input_of(200);
  input.ellipsoid_coverage = 1;
  EXPECT_TRUE(has(look_at(input), "contain 100 % of the errors: predicted uncertainties are too large."));
  input = input_of();
  input.poses.normalised = VectorX::Constant(21, 3.9);
  EXPECT_EQ(look_at(input), "");
  input.poses.normalised(3) = 4.1;
  EXPECT_TRUE(has(look_at(input), "#suspects\">1 row is suspect."));
  input.poses.normalised(4) = 4.1;
  EXPECT_TRUE(has(look_at(input), "2 rows are suspect."));
  // with everything to look at, the first five
  input.audit = {{"units", "all", "seen"}};
  input.ellipsoid_coverage = 0.5;
  input.poses.gates = VectorX::Ones(21);
  input.poses.gates(0) = 0.9;
  input.drift = {SessionDrift{}};
  input.drift[0].knots = MatrixX::Zero(6, 2);
  input.advice = {"measure more"};
  EXPECT_EQ(count(look_at(input), "<li>"), 5u);
  EXPECT_TRUE(has(look_at(input), "The audit of the data has 1 finding."));
  EXPECT_TRUE(has(look_at(input), "1 pose lies outside the range of validity."));
  EXPECT_TRUE(has(look_at(input), "Something moved during the session."));
  EXPECT_FALSE(has(look_at(input), "See what to do next."));
  input.audit.reset();
  EXPECT_TRUE(has(look_at(input), "See what to do next."));
}

VectorX list(std::initializer_list<double> values) {
  VectorX out(static_cast<Index>(values.size()));
  Index k = 0;
  for (const double value : values) out(k++) = value;
  return out;
}

/// Poses in the order of their errors, but the last ones the other way round.
ReportInput reversed(Index last) {
  ReportInput out = input_of();
  out.times.resize(21);
  for (Index i = 0; i < 21; ++i) out.times(i) = static_cast<double>(i < 21 - last ? i : 41 - last - i);
  return out;
}

// The last m of 21 reversed: sum d^2 = m (m^2 - 1) / 3.
TEST(ReportSections, ErrorsOverTime) {
  for (const Index last : {9, 10, 12}) {
    const double m = static_cast<double>(last), rho = 1 - 2 * m * (m * m - 1) / 9240,
                 p = std::erfc(rho * std::sqrt(10.0));
    const std::string text = detail::drift_section(reversed(last));
    EXPECT_TRUE(has(text, "Spearman&#39;s rank correlation " + detail::fixed_digits(rho, 3) +
                              ", p = " + detail::fixed_digits(p, 4)))
        << text;
    EXPECT_EQ(has(look_at(reversed(last)), "The errors depend on when a pose was measured."), p < 0.001) << p;
  }
  const std::string text = detail::drift_section(reversed(1));
  EXPECT_TRUE(has(text, "correlation 1.000, p &lt; 0.0001."));
  EXPECT_TRUE(has(text, "groups of 10 poses"));
  // errors 0 to 9 and 10 to 20 mm: medians 4.5 and 15, 95 % below 8.55 and 19.5; an axis from 3.75 to 20.25
  const std::vector<double> median = numbers_of(between(text, "class=\"line c1\" d=\"", "\"")),
                            p95 = numbers_of(between(text, "class=\"line c2\" d=\"", "\""));
  ASSERT_EQ(median.size(), 4u);
  ASSERT_EQ(p95.size(), 4u);
  const auto at = [](double value) { return 206 - 182 * (value - 3.75) / 16.5; };
  EXPECT_NEAR(median[1], at(4.5), 0.051);
  EXPECT_NEAR(median[3], at(15), 0.051);
  EXPECT_NEAR(p95[1], at(8.55), 0.051);
  EXPECT_NEAR(p95[3], at(19.5), 0.051);
  ReportInput few = input_of(19);
  few.times = VectorX::LinSpaced(19, 0, 18);
  EXPECT_EQ(detail::drift_section(few), "");
}

// Measured in the opposite order, in three groups of 11, 12 and 12: the first has the errors from 24 to 34 mm.
TEST(ReportSections, GroupsAreThoseOfTime) {
  ReportInput input = input_of(35);
  input.times = VectorX::LinSpaced(35, 34, 0);
  const std::string text = detail::drift_section(input);
  const std::vector<double> median = numbers_of(between(text, "class=\"line c1\" d=\"", "\"")),
                            p95 = numbers_of(between(text, "class=\"line c2\" d=\"", "\""));
  ASSERT_EQ(median.size(), 6u);
  const auto at = [](double value) { return 206 - 182 * (value - 4.1) / 30.8; };
  EXPECT_NEAR(median[1], at(29), 0.051);
  EXPECT_NEAR(median[3], at(17.5), 0.051);
  EXPECT_NEAR(median[5], at(5.5), 0.051);
  EXPECT_NEAR(p95[1], at(33.5), 0.051);
  EXPECT_NEAR(p95[5], at(10.45), 0.051);
  EXPECT_NEAR(median[2], 62 + 564 * (16.5 - 5) / (28.5 - 5), 0.051);  // at the mean times 5, 16.5 and 28.5
}

// Two knots from 1000 on, 100 apart: y moves by 4 um, the base turns about z by 300 urad.
TEST(ReportSections, DriftOfABase) {
  ReportInput input = input_of();
  SessionDrift drift{.begin = 1000, .spacing = 100};
  drift.knots = MatrixX::Zero(6, 2);
  drift.knots(1, 1) = 4e-6;
  drift.knots(5, 1) = 300e-6;
  input.drift = {SessionDrift{}, drift};
  const std::string text = detail::drift_section(input),
                    moved = between(text, "Translation of the base of station 2", "</svg>"),
                    turned = between(text, "Rotation of the base of station 2", "</svg>");
  ASSERT_FALSE(moved.empty());
  EXPECT_FALSE(has(text, "of station 1"));
  for (const char* tick : {">1000<", ">1100<"}) EXPECT_TRUE(has(moved, tick)) << moved;
  EXPECT_TRUE(has(moved, "y=\"16\">y of station 2<"));
  for (const char* tick : {">0<", ">1<", ">4<"}) EXPECT_TRUE(has(moved, tick)) << moved;
  for (const char* tick : {">0<", ">100<", ">300<"}) EXPECT_TRUE(has(turned, tick)) << turned;
  input.drift = {drift};
  EXPECT_TRUE(has(detail::drift_section(input), "aria-label=\"Translation of the base\""));
}

TEST(ReportSections, TableAndDistributionOfErrors) {
  const ReportInput input = input_of();
  const std::string text = detail::errors_section(input);
  EXPECT_EQ(row(text, "joint-wise (deployed)"),
            "10.0|" + detail::fixed_digits(std::sqrt(20 * 41 / 6.0), 1) + "|20.0|0|19.0");
  EXPECT_EQ(row(text, "frames alone").substr(0, 4), "30.0");
  EXPECT_EQ(count(text, "class=\"key "), 3u);  // before, geometry, after
  EXPECT_TRUE(has(text, ">1e-06<"));           // an error of zero on a logarithmic axis
  // shares from 0 to 100 %, an axis from -5 to 105
  const std::vector<double> path = numbers_of(between(text, "class=\"line c2\" d=\"", "\""));
  ASSERT_EQ(path.size(), 202u);
  EXPECT_NEAR(path[1], 236 - 212 * 5.0 / 110, 0.051);
  EXPECT_NEAR(path[201], 236 - 212 * 105.0 / 110, 0.051);
  // one percent is an error of 0.2 mm: the decades from 1e-6 to 40 mm are 564 wide
  EXPECT_NEAR(path[2], 62 + 564 * std::log(0.2e6) / std::log(40e6), 0.11);
}

TEST(ReportSections, WhereItIsGood) {
  ReportInput input = input_of();
  input.ellipsoid_coverage = 17 / 21.0;
  input.poses.gates = VectorX::Ones(21);
  input.poses.gates(20) = 0.5;
  input.poses.gates(19) = 0;
  JointReport turning, sliding;
  turning.measured_ranges = {{-3, -0.5}, {0.5, 3}};
  turning.valid_ranges = {{-3.1, -0.4}, {0.4, 3.1}};
  sliding.revolute = false;
  sliding.measured_ranges = {{0.1, 0.25}};
  input.joints = {turning, sliding};
  const std::string text = detail::coverage_section(input);
  EXPECT_TRUE(has(text, "Within their predicted 95 % ellipsoids: 17 of 21 poses (81.0 %; by chance 95 +- 9.3 %)."))
      << text;
  EXPECT_EQ(row(text, "inside"), "19|9.00|17.1|18.0");
  EXPECT_EQ(row(text, "outside"), "2|19.5|19.9|20.0");
  EXPECT_EQ(row(text, "1"), "deg|-171.9 .. -28.6, 28.6 .. 171.9|-177.6 .. -22.9, 22.9 .. 177.6");
  EXPECT_EQ(row(text, "2"), "mm|100.0 .. 250.0|");
}

TEST(ReportSections, Parameters) {
  ReportInput input = input_of();
  const auto length = ParameterKind::length;
  input.parameters = {{"a2", length, 0.1, 0.1005, 2e-5, ParameterState::identified, "", 1e-3},
                      {"theta3", ParameterKind::angle, 0.2, 0.1, 3e-3, ParameterState::weak, "", 0.05},
                      {"d4", length, 0.3, 0.3, 1e-5, ParameterState::not_identifiable, "absorbed by d5", 1e-3},
                      {"d6", length, 0.4, 0.4, 1e-5, ParameterState::fixed, "", 1e-3},
                      {"free", length, 0.5, 0.6, 1e-5, ParameterState::identified, "", 0}};
  input.correlated = {"a2 and d4 (+0.98)"};
  const std::string text = detail::parameters_section(input);
  EXPECT_EQ(row(text, "a2"), "mm|100.0000|100.5000|0.5000|0.0200|0.50|identified|");
  EXPECT_EQ(row(text, "theta3"), "mrad|200.0000|100.0000|-100.0000|3.0000|-2.00|weak: held near nominal by its prior|");
  EXPECT_EQ(row(text, "d4"), "mm|300.0000|300.0000||||not identifiable|absorbed by d5");
  EXPECT_EQ(row(text, "d6"), "mm|400.0000|400.0000||||fixed|");
  EXPECT_EQ(row(text, "free"), "mm|500.0000|600.0000|100.0000|0.0100||identified|");
  EXPECT_TRUE(has(text, "<li>a2 and d4 (+0.98)</li>"));
}

/// A joint whose transmission adds some values [mrad] over two ranges of angles, 0.1 rad apart.
JointReport joint_of(std::initializer_list<double> first, std::initializer_list<double> second, double std) {
  JointReport out;
  std::vector<double> values;
  for (const double value : first) {
    out.angle.push_back(0.1 * static_cast<double>(values.size()));
    values.push_back(value * 1e-3);
  }
  for (const double value : second) {  // a step of 0.2 between
    out.angle.push_back(0.1 * static_cast<double>(values.size()) + 0.1);
    values.push_back(value * 1e-3);
  }
  out.transmission = Eigen::Map<const VectorX>(values.data(), static_cast<Index>(values.size()));
  out.transmission_std = VectorX::Constant(out.transmission.size(), std);
  return out;
}

// Bands of 0.98 mrad either side of values from 0 to 1: an axis of 2.96, a twentieth wider at both ends.
TEST(ReportSections, FunctionsOfAJoint) {
  ReportInput input = input_of();
  input.joints = {JointReport{}, joint_of({0, 1, 0}, {1, 0, 0}, 0.5e-3)};
  const std::string text = detail::joints_section(input);
  EXPECT_FALSE(has(text, "Joint 1"));
  const std::string line = between(text, "class=\"line c1\" d=\"", "\""),
                    band = between(text, "class=\"band c1\" d=\"", "\"");
  const auto at = [](double value) { return 206 - 182 * (value + 1.128) / 3.256; };
  const auto along = [](double angle) { return 62 + 564 * angle / 0.6; };
  ASSERT_EQ(count(line, "M"), 2u);  // nothing is drawn where nothing was measured
  const std::vector<double> points = numbers_of(line), edge = numbers_of(band);
  ASSERT_EQ(points.size(), 12u);
  const double angles[] = {0, 0.1, 0.2, 0.4, 0.5, 0.6}, values[] = {0, 1, 0, 1, 0, 0};
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(points[2 * k], along(angles[k]), 0.051);
    EXPECT_NEAR(points[2 * k + 1], at(values[k]), 0.051);
  }
  ASSERT_EQ(edge.size(), 24u);  // to the end below, and back above
  EXPECT_NEAR(edge[1], at(-0.98), 0.051);
  EXPECT_NEAR(edge[3], at(0.02), 0.051);
  EXPECT_NEAR(edge[7], at(0.98), 0.051);
  EXPECT_NEAR(edge[9], at(1.98), 0.051);
  EXPECT_NEAR(edge[11], at(0.98), 0.051);
  EXPECT_EQ(count(text, ">5<") + count(text, ">10<") + count(text, ">30<"), 3u) << text;  // in degrees

  // 480 values that alternate: of each pair the extremes, at its middle
  JointReport dense;
  dense.angle.resize(480);
  dense.transmission.resize(480);
  dense.transmission_std = VectorX::Constant(480, 1e-12);
  for (Index k = 0; k < 480; ++k) {
    dense.angle[static_cast<std::size_t>(k)] = 0.01 * static_cast<double>(k);
    dense.transmission(k) = k % 2 == 0 ? 1e-3 : -1e-3;
  }
  input.joints = {dense};
  const std::vector<double> envelope =
      numbers_of(between(detail::joints_section(input), "class=\"line c1\" d=\"", "\""));
  ASSERT_EQ(envelope.size(), 960u);
  EXPECT_NEAR(envelope[1], 206 - 182 * 0.05 / 1.1, 0.051);  // down first, then up
  EXPECT_NEAR(envelope[3], 206 - 182 * 1.05 / 1.1, 0.051);
  EXPECT_NEAR(envelope[5], envelope[3], 0.051);
  EXPECT_NEAR(envelope[7], envelope[1], 0.051);
  EXPECT_EQ(envelope[0], envelope[2]);
}

TEST(ReportSections, LinesOfAJoint) {
  ReportInput input = input_of();
  JointReport joint = joint_of({0, 1, 0}, {1, 0, 0}, 0.5e-3);
  for (int order = 1; order <= 10; ++order) {
    joint.spectrum.push_back({order, order * 1e-5, 1e-6, 50});
    joint.lines.push_back({order, (11 - order) * 1e-5, 1e-6, 49.6 + order});
  }
  input.joints = {joint};
  const std::string text = detail::joints_section(input);
  EXPECT_EQ(row(text, "1"), "100.0|2.0|51|once a turn: an eccentric encoder or gear");
  EXPECT_EQ(row(text, "8").substr(0, 11), "30.0|2.0|58");
  EXPECT_EQ(row(text, "9"), "");  // eight are listed
  EXPECT_EQ(count(between(text, "aria-label=\"Spectrum of joint 1\"", "</svg>"), "class=\"tick \""),
            3u);  // three named
}

TEST(ReportSections, Suspects) {
  ReportInput input = input_of();
  input.poses.normalised = VectorX::Constant(21, 1);
  input.poses.normalised(2) = 4.05;
  input.poses.normalised(7) = 9;
  input.poses.normalised(8) = 4;
  input.poses.gates = VectorX::Ones(21);
  input.poses.gates(7) = 0.5;
  input.poses.files = {"a.csv", "b.csv"};
  input.poses.file.assign(21, 1);
  for (Index i = 0; i < 21; ++i) input.poses.line.push_back(10 * i);
  input.suspects = {{"3 of c.csv", 0.5e-3, 5.25, "why"}};
  std::string text = detail::suspects_section(input);
  EXPECT_EQ(row(text, "line 20 of b.csv"), "held out|2.000|4.0|");
  EXPECT_EQ(row(text, "line 70 of b.csv"), "held out|7.000|9.0|outside the range of validity");
  EXPECT_EQ(row(text, "line 80 of b.csv"), "");
  EXPECT_EQ(row(text, "3 of c.csv"), "training|0.500|5.2|why");
  EXPECT_LT(text.find("70 of b.csv"), text.find("3 of c.csv"));  // the largest first
  EXPECT_LT(text.find("3 of c.csv"), text.find("20 of b.csv"));
  EXPECT_FALSE(has(text, " more."));
  input.held_out = false;
  EXPECT_TRUE(has(row(detail::suspects_section(input), "line 20 of b.csv"), "checked|"));
  input.suspects.clear();
  for (int k = 0; k < 26; ++k) input.suspects.push_back({message("row ", k), 1e-3, 5, ""});
  text = detail::suspects_section(input);
  EXPECT_TRUE(has(text, "And 3 more."));
  EXPECT_EQ(count(text, "<th scope=\"row\">"), 25u);
  input.poses.normalised.setConstant(1);
  input.suspects.clear();
  EXPECT_TRUE(has(detail::suspects_section(input), "There are none."));
}

// Poses between 0 and 0.4 m along x, 0 and 0.2 m along y, at one height.
TEST(ReportSections, PosesInSpace) {
  ReportInput input = input_of();
  input.poses.positions = PointRows::Zero(21, 3);
  input.poses.joints.resize(21, 2);
  for (Index i = 0; i < 21; ++i) {
    set_point(input.poses.positions, i, Vector3(0.02 * static_cast<double>(i), 0.01 * static_cast<double>(i), 0.5));
    input.poses.joints(i, 0) = 0.5;
    input.poses.joints(i, 1) = 0.125;
    input.poses.line.push_back(100 + i);
  }
  input.joints.resize(2);
  input.joints[1].revolute = false;
  const detail::PoseView view = detail::pose_view(input);
  EXPECT_NEAR(view.before_clip, 39.8e-3, 1e-12);  // the 99th percentiles
  EXPECT_NEAR(view.after_clip, 19.8e-3, 1e-12);
  const auto json = nlohmann::json::parse(detail::poses_json(input, view));
  EXPECT_EQ(json.at("centre"), (std::vector<int>{200, 100, 500}));
  EXPECT_EQ(json.at("half"), 200);
  EXPECT_NEAR(json.at("clip").at("before").get<double>(), 39800, 1e-3);
  EXPECT_NEAR(json.at("clip").at("after").get<double>(), 19800, 1e-3);
  EXPECT_EQ(json.at("line").at(3), 103);
  EXPECT_EQ(json.at("before").at(3), 23000);
  EXPECT_EQ(json.at("after").at(3), 3000);
  EXPECT_EQ(json.at("xyz").at(9), 60);
  EXPECT_EQ(json.at("xyz").at(11), 500);
  EXPECT_EQ(json.at("units"), (std::vector<std::string>{"deg", "mm"}));
  EXPECT_EQ(json.at("joints").at(0), 2865);  // hundredths of degrees and of millimetres
  EXPECT_EQ(json.at("joints").at(1), 12500);
  EXPECT_EQ(json.at("file"), nlohmann::json::array());  // all of the first
  EXPECT_EQ(json.at("files"), (std::vector<std::string>{""}));
  ReportInput of_two = input;
  of_two.poses.files = {"a.csv", "b \"2\".csv"};
  of_two.poses.file = std::vector<int>(21, 0);
  of_two.poses.file[4] = 1;
  const auto two = nlohmann::json::parse(detail::poses_json(of_two, view));
  EXPECT_EQ(two.at("files"), of_two.poses.files);
  EXPECT_EQ(two.at("file"), of_two.poses.file);
  // half of the picture is 430 for 0.2 m; the largest error has the last colour, an error of 1 mm the first
  const std::string flat = detail::pose_projections(input, view);
  const std::string above = between(flat, "aria-label=\"poses from above\"", "</svg>"),
                    side = between(flat, "aria-label=\"poses from the side\"", "</svg>");
  EXPECT_TRUE(has(side, "M715 500h0") && has(side, "M285 500h0")) << side;
  EXPECT_TRUE(has(between(above, "stroke=\"" + std::string(detail::error_colours[7]), "/>"), "M930 285h0"));
  EXPECT_TRUE(has(between(above, "stroke=\"" + std::string(detail::error_colours[0]), "/>"), "M113 694h0"));
}

TEST(ErrorClasses, AreEighthsOfTheLargestButOnePercent) {
  EXPECT_EQ(detail::error_class(0, 1), 0u);
  EXPECT_EQ(detail::error_class(0.124, 1), 0u);
  EXPECT_EQ(detail::error_class(0.126, 1), 1u);
  EXPECT_EQ(detail::error_class(0.5, 1), 4u);
  EXPECT_EQ(detail::error_class(0.99, 1), 7u);
  EXPECT_EQ(detail::error_class(5, 1), 7u);
  EXPECT_EQ(detail::error_class(5, 0), 0u);
  const std::string legend = detail::error_legend(8e-3);
  for (const char* text : {">to 1<", ">to 2<", ">to 7<", ">above 7<"}) EXPECT_TRUE(has(legend, text)) << legend;
}

TEST(ReportInputs, OfACalibrationNameRowsThatAreOff) {
  CalibrationReport report;
  report.stages = {{Stage::geometry, "geometry", VectorX::Ones(4), {}}};
  report.gates = VectorX::Ones(4);
  report.left_out_errors =
      list({1e-3, 1e-3 * median_norm, 1.6e-3, 3.9e-3, 4.1e-3, 1.2e-3, 0});  // the median of sigma 1 mm
  report.left_out_rows = {0, 1, 2, 3, 4, 5, 6};
  report.train_poses = 7;
  report.converged = false;
  report.stages.push_back({Stage::session, "session", VectorX::Ones(4), {}});
  report.normalised_errors = list({0.5, 1, 1.5, 2});
  const ReportInput named = report_input(report, "arm", {"r0", "r1", "r2", "r3", "r4"}),
                    numbered = report_input(report, "arm");
  EXPECT_EQ(named.left_out, 7);
  ASSERT_EQ(named.suspects.size(), 1u);
  EXPECT_EQ(named.suspects[0].row, "r4");
  EXPECT_EQ(named.suspects[0].error, 4.1e-3);
  EXPECT_NEAR(named.suspects[0].normalised, 4.1, 1e-9);
  EXPECT_EQ(numbered.suspects[0].row, "4 of those learned from");
  EXPECT_EQ(named.after, Stage::geometry);
  EXPECT_EQ(named.poses.normalised, report.normalised_errors);
  std::vector<std::string> said = report.verdict();
  const std::vector<std::string> details = report.details();
  said.insert(said.end(), details.begin(), details.end());
  EXPECT_EQ(named.sentences, said);
  EXPECT_EQ(named.headline, "Only 4 poses were held out: too few to judge the accuracy; hold out at least 10.");
  EXPECT_TRUE(named.held_out);
}

TEST(ReportInputs, OfACheckHaveATableOfJoints) {
  VerificationReport report;
  report.valid = true;
  report.poses = 4;
  report.joint_types = {JointType::revolute, JointType::prismatic, JointType::revolute, JointType::revolute};
  report.joints = {{true, 1e-3, 0.5e-3, 0.25, 0.5, true, true},
                   {true, 2e-3, 1e-3, 0.125, 0.5, false, true},
                   {true, 2e-3, 1e-3, 0.125, 0.5, false, false},
                   {false, 2e-3, 1e-3, 0.125, 0.5, false, false}};
  report.errors = report.as_fitted = VectorX::Ones(4);
  report.normalised = list({2.79, 2.8, 1, 0.5});  // of three components 95 % lie below 2.7955
  report.options.level = 0.02;
  const ReportInput input = report_input(report, "arm");
  EXPECT_FALSE(input.held_out);
  EXPECT_EQ(input.before, Stage::as_fitted);
  EXPECT_EQ(input.after, Stage::as_fitted);
  EXPECT_EQ(input.rule, "");
  EXPECT_EQ(input.passed, std::optional<bool>(true));
  EXPECT_EQ(input.ellipsoid_coverage, std::optional<double>(0.75));
  ASSERT_EQ(input.tables.size(), 1u);
  const auto& rows = input.tables[0].rows;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"1", "1.0000", "0.9800", "mrad", "0.25", "0.5", "zero changed"}));
  EXPECT_EQ(rows[1], (std::vector<std::string>{"2", "2.0000", "1.9600", "mm", "0.125", "0.5", "transmission changed"}));
  EXPECT_EQ(rows[2].back(), "as calibrated");
  EXPECT_EQ(rows[3], (std::vector<std::string>{"4", "", "", "mrad", "", "0.5", "not determined"}));
  EXPECT_TRUE(has(input.tables[0].note, "at the level of 2 % for all tests together"));
  EXPECT_EQ(input.headline, report.verdict());
  EXPECT_EQ(input.advice, report.advice());
  report.registration.emplace();
  report.registration->joint_types = report.joint_types;
  report.registration->motion.offsets = VectorX::Zero(4);
  report.registration->change_std = VectorX::Zero(16);
  const ReportInput registered = report_input(report, "arm");
  EXPECT_EQ(registered.before, Stage::as_fitted);
  EXPECT_EQ(registered.after, Stage::registered);
  EXPECT_EQ(registered.rule, "the frames registered from the same poses");
  EXPECT_EQ(registered.tables.size(), 2u);
}

// ---- charts and tables ----

std::string path_of(const detail::Chart& chart, const char* kind) {
  return between(detail::chart_svg(chart), std::string("class=\"") + kind + " c0\" d=\"", "\"");
}

TEST(SvgCharts, AxesHoldEverything) {
  // sticks stand on zero: values 5 and 10 on an axis from -0.5 to 10.5
  detail::Chart chart{.title = "t", .height = 250};
  chart.series = {{.x = {0, 1}, .y = {5, 10}, .style = ChartStyle::sticks}};
  std::vector<double> found = numbers_of(path_of(chart, "sticks"));
  ASSERT_EQ(found.size(), 6u);
  EXPECT_NEAR(found[1], 115, 0.051);
  EXPECT_NEAR(found[2], 206, 0.051);
  EXPECT_NEAR(found[4], 206 - 182 * 10.5 / 11, 0.051);
  EXPECT_NEAR(found[0], 62, 0.051);
  EXPECT_NEAR(found[3], 626, 0.051);
  // a single value on logarithmic axes: between half and twice of it
  chart = {.title = "t", .log_x = true, .log_y = true, .height = 250};
  chart.series = {{.x = {3}, .y = {10}}};
  found = numbers_of(path_of(chart, "line"));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 344, 0.051);
  EXPECT_NEAR(found[1], 115, 0.051);
  for (const char* tick : {">5<", ">10<", ">20<"}) EXPECT_TRUE(has(detail::chart_svg(chart), tick));
  EXPECT_FALSE(has(detail::chart_svg(chart), ">1<"));  // x from 1.5 to 6
  // a single value stands in the middle of an axis: one to either side, or as far as zero
  chart = {.title = "t", .height = 250};
  chart.series = {{.x = {0, 1}, .y = {0.5, 0.5}}};
  EXPECT_TRUE(has(detail::chart_svg(chart), ">-0.5<") && has(detail::chart_svg(chart), ">1.5<"));
  EXPECT_FALSE(has(detail::chart_svg(chart), ">2<"));
  chart.series = {{.x = {0, 1}, .y = {-20, -20}}};
  EXPECT_TRUE(has(detail::chart_svg(chart), ">-40<") && has(detail::chart_svg(chart), ">-10<"));
  EXPECT_FALSE(has(detail::chart_svg(chart), ">-50<"));
  EXPECT_NEAR(numbers_of(path_of(chart, "line"))[1], 115, 0.051);
}

TEST(HtmlNumbers, TenthsAndColumns) {
  EXPECT_EQ(detail::tenths(3), "3");
  EXPECT_EQ(detail::tenths(-0.26), "-0.3");
  EXPECT_EQ(detail::tenths(12.34), "12.3");
  for (const double none : {1e16, -1e16, std::nan("")}) EXPECT_EQ(detail::tenths(none), "0");
  // a column with a word in it is one of text, a number may have a sign
  const std::string table =
      detail::html_table({.head = {"a", "b", "c"}, .rows = {{"1", "-1.5", "no 5"}, {"2", ".5", ""}}});
  EXPECT_TRUE(has(table, "<td>-1.5</td><td class=\"text\">no 5</td>")) << table;
  EXPECT_TRUE(has(table, "<td>.5</td><td class=\"text\"></td>"));
}

}  // namespace
}  // namespace vernier::report_sections_test
