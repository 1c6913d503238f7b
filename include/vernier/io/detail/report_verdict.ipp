// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/argsort.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/report_sections.hpp"
#include "vernier/io/detail/report_verdict.hpp"

namespace vernier::detail {

/// Errors above this many predicted standard deviations are suspect.
inline constexpr double suspect_sigmas = 4;

/// Name of a row of the poses.
VERNIER_LOCAL std::string row_name(const ReportPoses& poses, Index i) {
  const auto at = static_cast<std::size_t>(i);
  const std::size_t file = poses.file.empty() ? 0 : static_cast<std::size_t>(poses.file[at]);
  return message(poses.line.empty() ? message(i) : message("line ", poses.line[at]),
                 file < poses.files.size() ? " of " + poses.files[file] : "");
}

/// A suspect row, of those shown or of training.
VERNIER_LOCAL std::vector<std::vector<std::string>> suspect_rows(const ReportInput& input) {
  std::vector<std::pair<double, std::vector<std::string>>> all;
  const VectorX& errors = stage_of(input, input.after).position;
  const ReportPoses& poses = input.poses;
  const auto cells = [](const std::string& name, const char* kind, double error, double sigmas,
                        const std::string& why) {
    return std::vector<std::string>{name, kind, fixed_digits(error * 1e3, 3), fixed_digits(sigmas, 1), why};
  };
  for (Index i = 0; i < poses.normalised.size(); ++i)
    if (poses.normalised(i) > suspect_sigmas)
      all.emplace_back(
          poses.normalised(i),
          cells(row_name(poses, i), input.held_out ? "held out" : "checked", errors(i), poses.normalised(i),
                poses.gates.size() > 0 && poses.gates(i) < 1 ? "outside the range of validity" : ""));
  for (const ReportSuspect& one : input.suspects)
    all.emplace_back(one.normalised, cells(one.row, "training", one.error, one.normalised, one.remark));
  VectorX negative(static_cast<Index>(all.size()));
  for (Index i = 0; i < negative.size(); ++i) negative(i) = -all[static_cast<std::size_t>(i)].first;
  std::vector<std::vector<std::string>> out;
  for (const Index i : argsort(negative)) out.push_back(std::move(all[static_cast<std::size_t>(i)].second));
  return out;
}

/// What deserves a look, at most five lines, each with a link.
VERNIER_LOCAL std::string look_at(const ReportInput& input) {
  std::vector<std::pair<const char*, std::string>> all;
  if (input.audit && !input.audit->empty())
    all.emplace_back("audit", "The audit of the data has " + counted(input.audit->size(), "finding.", "findings."));
  if (const std::size_t n = suspect_rows(input).size(); n > 0)
    all.emplace_back("suspects", counted(n, "row is suspect.", "rows are suspect."));
  const auto n = static_cast<double>(stage_of(input, input.after).position.size());
  if (input.ellipsoid_coverage && std::abs(*input.ellipsoid_coverage - 0.95) > 1.96 * std::sqrt(0.95 * 0.05 / n))
    all.emplace_back("where", message("The predicted 95 % ellipsoids contain ", brief(100 * *input.ellipsoid_coverage),
                                      " % of the errors: predicted uncertainties are too ",
                                      *input.ellipsoid_coverage < 0.95 ? "small." : "large."));
  if (const Index outside =
          std::count_if(input.poses.gates.begin(), input.poses.gates.end(), [](double gate) { return gate < 1; });
      outside > 0)
    all.emplace_back("where", counted(outside, "pose lies", "poses lie") + " outside the range of validity.");
  if (std::any_of(input.drift.begin(), input.drift.end(), [](const SessionDrift& d) { return !d.empty(); }))
    all.emplace_back("drift", "Something moved during the session.");
  else if (input.times.size() > 0 &&
           rank_correlation(input.times, stage_of(input, input.after).position).p_value < 0.001)
    all.emplace_back("drift", "The errors depend on when a pose was measured.");
  if (!input.advice.empty()) all.emplace_back("next", "See what to do next.");
  std::string out;
  for (std::size_t k = 0; k < all.size() && k < 5; ++k)
    out += message("<li><a href=\"#", all[k].first, "\">", html_escape(all[k].second), "</a></li>\n");
  return out.empty() ? out : "<p>Look at this:</p>\n<ul>\n" + out + "</ul>\n";
}

VERNIER_IMPL std::string verdict_section(const ReportInput& input) {
  const StageErrors& after = stage_of(input, input.after);
  const ErrorStatistics e = ErrorStatistics::of(after.position * 1e3);
  const MeanInterval interval = MeanInterval::of(after.position * 1e3, input.poses.visited),
                     was = MeanInterval::of(stage_of(input, input.before).position * 1e3, input.poses.visited);
  std::string decision, kind;
  if (input.accept) {
    const double limit = *input.accept * 1e3;
    kind = interval.upper <= limit ? "yes" : interval.lower > limit ? "no" : "";
    decision = message(" Accepted up to ", brief(limit), " mm: <strong>",
                       kind == "yes"  ? "yes"
                       : kind == "no" ? "no"
                                      : "not decided, the limit lies within the interval",
                       "</strong>.");
  }
  if (input.passed) kind = *input.passed ? "yes" : "no";
  std::string out =
      message("<p class=\"verdict ", kind, "\">", html_escape(input.headline), input.headline.empty() ? "" : " ",
              input.held_out ? "Held-out position error" : "Position error", " <strong data-value=\"", interval.mean,
              "\">", brief(interval.mean), " mm</strong> (mean; ");
  out += std::isfinite(interval.upper)
             ? message("95 % interval ", brief(interval.lower), " to ", brief(interval.upper), " mm")
             : "too few " + html_escape(input.what) + " for an interval";
  out += message("), 95 % of the ", html_escape(input.what), " within ", brief(e.p95), " mm, largest ", brief(e.max),
                 " mm", input.before == input.after ? "." : message("; before ", brief(was.mean), " mm."), decision,
                 "</p>\n");
  out +=
      paragraph(message("Of ", e.n, input.held_out ? " held-out " : " ", input.what,
                        input.rule.empty() ? "" : " (" + input.rule + ")",
                        input.train_poses > 0 ? message(", fitted to ", input.train_poses, " others") : "",
                        ". Rows that visit one pose count once in the mean and its interval, which is by Student's t."),
                "faint");
  out += look_at(input);
  if (!input.sentences.empty())
    out += "<details><summary>In words</summary>\n" + bullets(input.sentences) + "</details>\n";
  return section("verdict", "Verdict", out);
}

VERNIER_IMPL std::string suspects_section(const ReportInput& input) {
  constexpr std::size_t most = 25;
  if (input.poses.normalised.size() == 0 && input.left_out == 0) return "";
  HtmlTable table{.head = {"row", "", "error [mm]", "in standard deviations", "remark"}, .rows = suspect_rows(input)};
  const std::size_t n = table.rows.size();
  std::string out = paragraph(message(
      "Rows whose error exceeds ", suspect_sigmas, " standard deviations",
      input.poses.normalised.size() > 0 ? ": of the predicted ellipsoid, which chance exceeds in one row of 900" : "",
      input.left_out > 0
          ? message("; of ", input.left_out, " training rows that were left out in turn, of their spread")
          : "",
      ". Rows are counted from 0, the first behind the header."));
  if (n == 0) return section("suspects", "Suspect rows", out + paragraph("There are none."));
  if (n > most) table.rows.resize(most);
  out += html_table(table);
  if (n > most) out += paragraph(message("And ", n - most, " more."));
  return section("suspects", "Suspect rows", out);
}

}  // namespace vernier::detail
