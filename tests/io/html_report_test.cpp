// SPDX-License-Identifier: BSD-3-Clause
// The report as a page: what it says, what it must not contain, and what browsers and a validator make of it.

#include "vernier/io/html_report.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "complaint.hpp"
#include "page_text.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/report_page.hpp"
#include "vernier/io/detail/svg_chart.hpp"
#include "vernier/io/report_json.hpp"

namespace vernier::html_report_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::between;
using vernier_test::CommandResult;
using vernier_test::complaint;
using vernier_test::has;
using vernier_test::TemporaryFolder;

const std::string hostile = "<script>alert(1)</script>";

VectorX drawn(Rng& rng, Index n, double size) {
  VectorX out(n);
  for (double& value : out) value = size * std::hypot(rng.normal(), rng.normal(), rng.normal());
  return out;
}

/// A calibration as large as one of the measured sets, every section of it filled.
CalibrationReport assessed(Index n) {
  Rng rng(5);
  CalibrationReport out;
  for (const auto& [stage, size] :
       {std::pair{Stage::frames, 0.6e-3}, {Stage::geometry, 0.3e-3}, {Stage::jointwise, 0.06e-3}})
    out.stages.push_back({stage, traits_of(stage).key, drawn(rng, n, size), drawn(rng, n, size)});
  out.chosen = Stage::jointwise;
  out.train_poses = 4 * n;
  out.oriented = true;
  out.ellipsoid_coverage = 0.94;
  out.normalised_errors = drawn(rng, n, 1);
  out.normalised_errors(n / 2) = 7.5;
  out.left_out_errors = drawn(rng, 200, 0.06e-3);
  out.left_out_errors(17) = 2e-3;
  for (Index i = 0; i < 200; ++i) out.left_out_rows.push_back(3 * i);
  out.gates = VectorX::Ones(n);
  out.gates(0) = 0.2;
  for (int j = 0; j < 6; ++j) {
    JointReport joint;
    for (Index i = 0; i < n; ++i) joint.held_out.push_back(rng.uniform(-3, 3));
    joint.measured_ranges = {{-3, -0.5}, {0.5, 3}};
    for (const auto& [lower, upper] : joint.measured_ranges)
      for (int k = 0; k <= 500; ++k) joint.angle.push_back(lower + (upper - lower) * k / 500);
    joint.transmission.resize(1002);
    for (Index k = 0; k < 1002; ++k)
      joint.transmission(k) = 2e-4 * std::sin(20 * joint.angle[static_cast<std::size_t>(k)]);
    joint.transmission_std = VectorX::Constant(1002, 2e-5);
    for (int order = 1; order <= 500; ++order)
      joint.spectrum.push_back({order, order == 20 ? 2e-4 : 1e-6 * rng.uniform(), 1e-6, order == 20 ? 900.0 : 1.0});
    joint.lines = {joint.spectrum[19]};
    out.joints.push_back(std::move(joint));
  }
  for (int k = 0; k < 42; ++k)
    out.identification.parameters.push_back({message('p', k + 1), ParameterKind::length, 0.1, 0.1 + 1e-4 * k, 2e-5,
                                             k % 7 == 0 ? ParameterState::not_identifiable : ParameterState::identified,
                                             k % 7 == 0 ? "absorbed by p2" : "", 1e-3});
  SessionDrift drift{.begin = 0, .spacing = 100};
  drift.knots.resize(6, 20);
  for (double& value : drift.knots.reshaped()) value = 1e-5 * rng.normal();
  out.drift = {drift};
  PoseAdvice advice{.parameter = "a3", .kind = ParameterKind::length, .std_now = 1e-3, .std_then = 1e-4};
  advice.poses = {VectorX::Zero(6)};
  out.advice = {advice};
  return out;
}

ReportInput input_of(Index n, const std::string& robot = "arm") {
  Rng rng(6);
  ReportInput out = report_input(assessed(n), robot);
  out.poses.positions.resize(n, 3);
  out.poses.joints.resize(n, 6);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < 3; ++k) out.poses.positions(i, k) = rng.uniform(-1.2, 1.2);
    for (Index k = 0; k < 6; ++k) out.poses.joints(i, k) = rng.uniform(-3, 3);
    out.poses.line.push_back(5 * i);
  }
  out.poses.files = {"poses.csv"};
  out.times = VectorX::LinSpaced(n, 0, static_cast<double>(n - 1));
  out.provenance = {.command = "calibrate --data poses.csv",
                    .date = "2024-05-01",
                    .seed = 1,
                    .inputs = {{"poses.csv", 5 * n, sha256("poses")}},
                    .model = "model.json",
                    .model_sha256 = sha256("model")};
  out.audit.emplace();
  return out;
}

const std::string& large_page() {
  static const std::string made = report_html(input_of(2773));
  return made;
}

TEST(HtmlReport, HasItsSectionsInOrder) {
  const std::string& page = large_page();
  std::size_t at = 0;
  for (const char* id : {"verdict", "audit", "errors", "poses", "where", "parameters", "joints", "suspects", "drift",
                         "next", "provenance"}) {
    const std::size_t found = page.find(message("<section id=\"", id, "\">"), at);
    ASSERT_NE(found, std::string::npos) << id;
    EXPECT_NE(page.find(message("<a href=\"#", id, "\">")), std::string::npos) << id;
    at = found;
  }
  for (const std::string& words : std::vector<std::string>{
           "Nothing was found.", "absorbed by p2", "99th percentile", "of those learned from", sha256("poses"),
           sha256("model"), "calibrate --data poses.csv", "prefers-color-scheme", "@media print"})
    EXPECT_TRUE(has(page, words)) << words;
}

TEST(HtmlReport, IsSmallAndWrittenAtOnce) {
  EXPECT_LE(large_page().size(), 600000u);
  const ReportInput input = input_of(2773);
  double best = 1e9;
  for (int k = 0; k < 5; ++k) {
    const auto began = std::chrono::steady_clock::now();
    EXPECT_GT(report_html(input).size(), 100000u);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
  }
  double limit = 0.2;
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
  limit = 2;
#endif
#elif defined(__SANITIZE_ADDRESS__)
  limit = 2;
#endif
  EXPECT_LT(best, limit);
}

TEST(HtmlReport, SameBits) { EXPECT_TRUE(report_html(input_of(2773)) == large_page()); }

TEST(HtmlReport, AsksForNothingFromElsewhere) {
  const std::string& page = large_page();
  for (const char* words : {"http:", "https:", "src=", "@import", "url(", "//cdn", "<link", "<iframe", "<img", "eval("})
    EXPECT_FALSE(has(page, words)) << words;
  EXPECT_LE(detail::report_script.size(), 8000u);
  EXPECT_EQ(between(page, "<script>", "</script>"), detail::report_script);
  EXPECT_TRUE(has(page, "default-src 'none'"));
}

// Digests of the script and the style as the policy writes them, against openssl.
TEST(HtmlReport, ThePolicyNamesItsScriptAndStyle) {
  EXPECT_EQ(detail::base64_of_hex(sha256("abc")), "ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
  EXPECT_EQ(detail::base64_of_hex("00"), "AA==");
  EXPECT_EQ(detail::base64_of_hex("ffff"), "//8=");
  const std::string policy = between(large_page(), "Content-Security-Policy\" content=\"", "\"");
  for (const std::string_view text : {detail::report_script, detail::report_style})
    EXPECT_TRUE(has(policy, "'sha256-" + detail::base64_of_hex(sha256(text)) + "'")) << policy;
  EXPECT_FALSE(has(policy, "unsafe"));
}

TEST(HtmlReport, EveryTextIsEscaped) {
  ReportInput input = input_of(50, hostile);
  const std::string nasty = hostile + "\"'&</script><!--\xff\x01";
  input.headline = input.rule = input.title = nasty;
  input.sentences = input.advice = input.correlated = {nasty};
  input.audit = {{nasty, nasty, nasty}};
  input.tables = {{nasty, nasty, {nasty, nasty}, {{nasty, nasty}}}};
  input.suspects = {{nasty, 1, 9, nasty}};
  input.poses.files = {nasty};
  for (StageErrors& stage : input.stages) stage.title = nasty;
  for (ParameterEstimate& p : input.parameters) p.name = p.remark = nasty;
  input.provenance = {.command = nasty,
                      .date = nasty,
                      .inputs = {{nasty, 1, nasty}},
                      .model = nasty,
                      .model_sha256 = nasty,
                      .version = nasty,
                      .compiler = nasty,
                      .eigen = nasty};
  input.results = Json{{"robot", hostile}, {"</script>", "<!--"}}.dump();
  const std::string page = report_html(input);
  EXPECT_FALSE(has(page, "<script>alert"));
  EXPECT_FALSE(has(page, "alert(1)</script>"));
  EXPECT_FALSE(has(page, "<!--"));
  EXPECT_TRUE(has(page, "&lt;script&gt;alert(1)&lt;/script&gt;"));
  std::size_t scripts = 0;
  for (std::size_t at = page.find("<script"); at != std::string::npos; at = page.find("<script", at + 1)) ++scripts;
  EXPECT_EQ(scripts, 3u);
  EXPECT_EQ(Json::parse(between(page, "id=\"data\">", "</script>")), Json::parse(input.results));
  EXPECT_EQ(Json::parse(between(page, "id=\"points\">", "</script>")).at("files").size(), 1u);
  for (const char c : page) EXPECT_TRUE(c == '\n' || c == '\t' || static_cast<unsigned char>(c) >= 32);
}

TEST(HtmlEscape, ReplacesWhatIsNoUtf8) {
  EXPECT_EQ(detail::html_escape("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(detail::html_escape("\xC3\xA9 \xE2\x82\xAC \xF0\x9F\xA4\x96"), "\xC3\xA9 \xE2\x82\xAC \xF0\x9F\xA4\x96");
  const std::string mark = "\xEF\xBF\xBD";
  EXPECT_EQ(detail::html_escape("\xff"), mark);
  EXPECT_EQ(detail::html_escape("\xc0\xaf"), mark + mark);             // a slash in too many bytes
  EXPECT_EQ(detail::html_escape("\xe2\x82"), mark + mark);             // cut off
  EXPECT_EQ(detail::html_escape({"\xe2\x82\xac", 2}), mark + mark);    // cut off, with the rest behind it
  EXPECT_EQ(detail::html_escape("\xed\xa0\x80"), mark + mark + mark);  // half of a pair
  EXPECT_EQ(detail::html_escape("\xf4\x90\x80\x80"), mark + mark + mark + mark);
  // the first and last characters of each length, and of the gap between them, stay
  for (const char* text : {"\xc2\xa0", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80", "\xef\xbf\xbf",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_EQ(detail::html_escape(text), text);
  EXPECT_EQ(detail::html_escape("\xc1\xbf"), mark + mark);
  EXPECT_EQ(detail::html_escape("\xc2\x9f"), mark + mark);  // a control character
  EXPECT_EQ(detail::html_escape("\xe0\x9f\xbf"), mark + mark + mark);
  EXPECT_EQ(detail::html_escape("\xf0\x8f\xbf\xbf"), mark + mark + mark + mark);
  EXPECT_EQ(detail::html_escape("\xf5\x80\x80\x80"), mark + mark + mark + mark);
  EXPECT_EQ(detail::html_escape("\xc3("), mark + "(");  // what follows is read again
  EXPECT_EQ(detail::html_escape("\xe2\x82("), mark + mark + "(");
  EXPECT_EQ(detail::html_escape("a\tb\nc\x1f\x7f~"), "a\tb\nc  ~");
}

TEST(HtmlReport, NumbersEqualThoseOfTheJson) {
  const std::string& page = large_page();
  const Json json = Json::parse(between(page, "id=\"data\">", "</script>"));
  EXPECT_EQ(json, to_json(assessed(2773), "arm"));
  const std::string table = between(page, "<section id=\"errors\">", "</table>");
  for (const auto& [key, stage] : json.at("stages").items()) {
    const std::string row = between(table, "<th scope=\"row\">" + key, "</tr>");
    for (const char* what : {"mean_mm", "rms_mm", "max_mm", "min_mm", "p95_mm", "mean_mrad"})
      EXPECT_TRUE(has(row, "<td>" + detail::three_digits(stage.at(what).get<double>()) + "</td>"))
          << key << ' ' << what;
  }
  EXPECT_EQ(std::stod(between(page, "data-value=\"", "\"")), json.at("stages").at("jointwise").at("mean_mm"));
  const Json poses = Json::parse(between(page, "id=\"points\">", "</script>"));
  const ReportInput input = input_of(2773);
  ASSERT_EQ(poses.at("line").size(), 2773u);
  for (const std::size_t i : {0, 1, 1500, 2772}) {
    const auto row = static_cast<Index>(i);
    EXPECT_EQ(poses.at("line").at(i), 5 * row);
    EXPECT_NEAR(poses.at("after").at(i), input.stages[2].position(row) * 1e6, 0.5);
    EXPECT_NEAR(poses.at("before").at(i), input.stages[0].position(row) * 1e6, 0.5);
    EXPECT_NEAR(poses.at("xyz").at(3 * i + 2), input.poses.positions(row, 2) * 1e3, 0.5);
    EXPECT_NEAR(poses.at("joints").at(6 * i + 4), input.poses.joints(row, 4) * 18000 / std::numbers::pi, 0.5);
  }
}

TEST(HtmlReport, ComparesTheIntervalWithTheLimit) {
  ReportInput input = input_of(200);
  const MeanInterval interval = MeanInterval::of(input.stages[2].position);
  const auto decision = [&](double limit) {
    input.accept = limit;
    return between(report_html(input), "Accepted up to ", "</p>");
  };
  EXPECT_TRUE(has(decision(1.01 * interval.upper), "<strong>yes"));
  EXPECT_TRUE(has(decision(0.99 * interval.lower), "<strong>no<"));
  EXPECT_TRUE(has(decision(interval.mean), "not decided"));
}

TEST(HtmlReport, FewPosesHaveNoInterval) {
  EXPECT_TRUE(has(report_html(input_of(4)), "too few poses for an interval"));
}

TEST(HtmlReport, RefusesWhatDoesNotFit) {
  ReportInput input = input_of(30);
  const auto complains = [&](const ReportInput& wrong, const char* words) {
    EXPECT_TRUE(has(complaint([&] { (void)report_html(wrong); }), words)) << words;
  };
  ReportInput wrong = input;
  wrong.after = Stage::tilt;
  complains(wrong, "there is no stage 'tilt'");
  wrong = input;
  wrong.stages[1].position.resize(29);
  complains(wrong, "stage 'geometry' has 29 errors, expected 30");
  wrong = input;
  wrong.poses.positions.resize(7, 3);
  complains(wrong, "7 poses for 30 errors");
  wrong = input;
  wrong.poses.joints.resize(30, 5);
  complains(wrong, "6 joints, poses have 5");
  wrong = input;
  wrong.poses.line.pop_back();
  complains(wrong, "29 lines of 30 poses");
}

TEST(HtmlReport, ThinsManyPosesInTheViewAlone) {
  const std::string page = report_html(input_of(7000));
  EXPECT_EQ(Json::parse(between(page, "id=\"points\">", "</script>")).at("line").size(), 5000u);
  EXPECT_TRUE(has(page, "Of all 7000 poses these were drawn by lot."));
}

TEST(HtmlReport, LeavesOutWhatIsEmpty) {
  ReportInput input;
  input.stages = {{Stage::frames, "frames", VectorX::Ones(6), {}}, {Stage::geometry, "geometry", VectorX::Ones(6), {}}};
  input.after = Stage::geometry;
  const std::string page = report_html(input);
  for (const char* id : {"audit", "poses", "parameters", "joints", "suspects", "drift", "next"})
    for (const std::string& part : {message("<section id=\"", id, "\">"), message("<a href=\"#", id, "\">")})
      EXPECT_FALSE(has(page, part)) << part;
}

TEST(SvgChart, TicksAreRound) {
  EXPECT_EQ(detail::chart_ticks(0, 1, false, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  EXPECT_EQ(detail::chart_ticks(-7, 12, false, 4), (std::vector<double>{-5, 0, 5, 10}));
  EXPECT_EQ(detail::chart_ticks(0.5, 30, true, 5), (std::vector<double>{0.5, 1, 2, 5, 10, 20}));
  EXPECT_EQ(detail::chart_ticks(0.03, 40000, true, 5), (std::vector<double>{0.1, 1, 10, 100, 1000, 10000}));
  EXPECT_TRUE(detail::chart_ticks(1, 1, false, 5).empty());
  EXPECT_EQ(detail::chart_ticks(0.5, 100, true, 5), (std::vector<double>{1, 10, 100}));
  EXPECT_EQ(detail::chart_ticks(0, 10, false, 2), (std::vector<double>{0, 5, 10}));
  EXPECT_EQ(detail::chart_ticks(0, 10, false, 4), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(detail::chart_ticks(0, 10, false, 12), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST(SvgChart, PlacesValuesOnItsAxes) {
  detail::Chart chart{.title = "t", .x_label = "x", .y_label = "y", .log_x = true, .log_y = true};
  chart.series = {{.x = {1, 10, 100}, .y = {0.1, 1, 10}}};
  // equal factors are equal distances
  const std::string path = between(detail::chart_svg(chart), "class=\"line c0\" d=\"M", "\"");
  double x[3], y[3];
  ASSERT_EQ(std::sscanf(path.c_str(), "%lf %lfL%lf %lf %lf %lf", x, y, x + 1, y + 1, x + 2, y + 2), 6) << path;
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.11);
  EXPECT_NEAR(y[1] - y[0], y[2] - y[1], 0.11);
  EXPECT_LT(y[2], y[0]);
  EXPECT_EQ(x[0], 62);
  chart.series[0].y = {-1, 0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(detail::chart_svg(chart), "");  // nothing of it has a logarithm
}

/// A page in a file, looked at by other programs.
class HtmlReportSeen : public ::testing::Test {
 protected:
  CommandResult run(const std::string& command) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; " + command, folder_.path());
  }
  bool missing(const char* program) { return run(message("command -v ", program)).exit_code != 0; }
  CommandResult chromium(const std::string& options, const std::string& fragment = "") {
    return run(
        "HOME=\"$PWD\" timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir=\"$PWD/profile\" "
        "--host-resolver-rules='MAP * ~NOTFOUND' --force-device-scale-factor=1 --window-size=1000,1500 "
        "--virtual-time-budget=5000 " +
        options + " \"file://$PWD/page.html" + fragment + "\"");
  }

  TemporaryFolder folder_{"html_report"};
};

TEST_F(HtmlReportSeen, IsValidByTidy) {
  if (missing("tidy")) GTEST_SKIP() << "tidy is not installed: the page is not validated";
  write_file(folder_ / "page.html", report_html(input_of(300, hostile)));
  const CommandResult seen = run("tidy -e -q page.html");
  EXPECT_LT(seen.exit_code, 2) << seen.errors;
  EXPECT_FALSE(has(seen.errors, "Error")) << seen.errors;
  EXPECT_FALSE(has(seen.errors, "Warning")) << seen.errors;
}

TEST_F(HtmlReportSeen, HasAScriptThatNodeParses) {
  if (missing("node")) GTEST_SKIP() << "node is not installed: the page's script is not parsed";
  write_file(folder_ / "report.js", detail::report_script);
  const CommandResult seen = run("node --check report.js");
  EXPECT_EQ(seen.exit_code, 0) << seen.errors;
}

TEST_F(HtmlReportSeen, DrawsItsPosesInABrowser) {
  if (missing("chromium")) GTEST_SKIP() << "chromium is not installed: the page's script is not run";
  write_file(folder_ / "page.html", report_html(input_of(300, hostile)));
  const CommandResult dom = chromium("--dump-dom");
  ASSERT_EQ(dom.exit_code, 0) << dom.errors;
  EXPECT_TRUE(has(dom.output, "data-state=\"ready\"")) << dom.output.substr(0, 300);
  EXPECT_TRUE(has(dom.output, "data-points=\"300\""));
  EXPECT_TRUE(has(dom.output, "Click a point for its line and joints."));
  const auto shot = [&](const std::string& name, const std::string& fragment) {
    EXPECT_EQ(chromium("--screenshot=" + name, fragment).exit_code, 0);
    return read_file(folder_ / name);
  };
  const std::string first = shot("a.png", "#rotate=0"), turned = shot("b.png", "#rotate=90"),
                    again = shot("c.png", "#rotate=0"), before = shot("d.png", "#rotate=0&show=before");
  EXPECT_GT(first.size(), 20000u);  // a blank page has less
  EXPECT_TRUE(first == again);
  EXPECT_TRUE(first != turned);
  EXPECT_TRUE(first != before);
}

// Dragged by 60 pixels to the right and 20 up, turned back by an arrow key, and clicked until a point is met.
TEST_F(HtmlReportSeen, FollowsThePointerAndTheKeys) {
  if (missing("chromium")) GTEST_SKIP() << "chromium is not installed: the page's script is not run";
  std::string page = report_html(input_of(300, hostile));
  const std::size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
  ASSERT_NE(policy, std::string::npos);
  page.erase(policy, page.find('>', policy) + 1 - policy);  // which would keep this script from running
  page.insert(page.find("</body>"), R"(<script>
    var canvas = document.getElementById('canvas'), picked = document.getElementById('picked');
    var box = canvas.getBoundingClientRect();
    canvas.setPointerCapture = function () {};  // there is no pointer
    function send(kind, x, y) {
      canvas.dispatchEvent(new PointerEvent(kind, {clientX: box.left + x, clientY: box.top + y, bubbles: true}));
    }
    send('pointerdown', 100, 100); send('pointermove', 130, 90); send('pointermove', 160, 80); send('pointerup', 160, 80);
    document.body.dataset.dragged = location.hash;
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', cancelable: true}));
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowUp', cancelable: true}));
    document.body.dataset.stepped = location.hash;
    for (var x = 10; x < box.width; x += 10)
      for (var y = 10; y < box.height && picked.textContent.indexOf('Line ') !== 0; y += 10) {
        send('pointerdown', x, y); send('pointerup', x, y);
      }
    document.body.dataset.clicked = picked.textContent;
  </script>)");
  write_file(folder_ / "page.html", page);
  const CommandResult dom = chromium("--dump-dom", "#rotate=100&tilt=20");
  ASSERT_EQ(dom.exit_code, 0) << dom.errors;
  const auto noted = [&](const std::string& name) {
    const std::size_t at = dom.output.find("data-" + name + "=\"");
    if (at == std::string::npos) return std::string("nothing");
    const std::size_t begin = dom.output.find('"', at) + 1;
    return dom.output.substr(begin, dom.output.find('"', begin) - begin);
  };
  EXPECT_EQ(noted("dragged"), "#rotate=70&amp;tilt=10&amp;show=after");
  EXPECT_EQ(noted("stepped"), "#rotate=75&amp;tilt=15&amp;show=after");
  EXPECT_EQ(noted("clicked").rfind("Line ", 0), 0u) << noted("clicked");
}

}  // namespace
}  // namespace vernier::html_report_test
