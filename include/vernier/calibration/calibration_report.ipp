// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "vernier/calibration/calibration_report.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/error_terms/drive_lines.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier {

VERNIER_IMPL Index CalibrationReport::extrapolated() const {
  return std::count_if(gates.begin(), gates.end(), [](double gate) { return gate < 1; });
}

VERNIER_IMPL const StageErrors& CalibrationReport::stage(const StageName& name) const {
  for (const StageErrors& one : stages)
    if (one.name == name) return one;
  throw std::invalid_argument(message("CalibrationReport: there is no stage '", name.key(), "'"));
}

VERNIER_IMPL MeanInterval CalibrationReport::held_out_mean() const {
  return MeanInterval::of(stage(chosen).position, held_out_poses);
}

VERNIER_IMPL Index CalibrationReport::independent_poses() const {
  if (held_out_poses.empty()) return test_poses();
  return *std::max_element(held_out_poses.begin(), held_out_poses.end()) + 1;
}

VERNIER_IMPL std::string CalibrationReport::few_poses() const {
  constexpr Index enough = 10;
  const Index n = independent_poses();
  if (n >= enough) return "";
  return message("Only ", n, ' ', n < test_poses() ? "independent " : "", n == 1 ? "pose was" : "poses were",
                 " held out: too few to judge the accuracy; hold out at least ", enough, ".");
}

namespace detail {

/// The distance of the identified tool point from the flange, and the reach of the links as designed [m].
struct ToolAndReach {
  double tool = 0, reach = 0;
};

VERNIER_LOCAL ToolAndReach tool_and_reach(const IdentificationReport& identification) {
  ToolAndReach out;
  for (const ParameterEstimate& p : identification.parameters) {
    if (p.kind != ParameterKind::length || p.name.starts_with("base")) continue;
    if (p.name.starts_with("tool"))
      out.tool = std::hypot(out.tool, p.identified);
    else
      out.reach += std::abs(p.nominal);
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL std::vector<std::string> CalibrationReport::remarks() const {
  using detail::brief;
  constexpr double largest_condition = 1e6;
  std::vector<std::string> out;
  if (!converged) out.push_back("The fit of the joint errors stopped before it converged.");
  if (payload && !payload->estimated)
    out.push_back(message("Compliance to payload is unknown: all poses were measured at ", brief(payload->mean),
                          " kg. Measure poses with another payload, too."));
  if (!identification.converged())
    out.push_back((identification.status == IdentifyStatus::underdetermined
                       ? "The geometry is underdetermined: "
                       : "The fit of the geometry did not converge: ") +
                  identification.message + ".");
  if (identification.condition > largest_condition)
    out.push_back("The geometry is poorly determined: its condition is " + brief(identification.condition) + ".");
  constexpr double least_reach = 1;  // [m]; travel of sliding joints is not known here
  const auto [tool, reach] = detail::tool_and_reach(identification);
  if (tool > (std::max)(reach, least_reach))
    out.push_back("The tool point lies " + brief(tool) + " m from the flange, beyond the arm's reach of " +
                  brief(reach) + " m: these poses do not determine the tool.");
  if (!outliers.empty()) {
    double largest = 0, turned = 0;
    for (const OutlyingRow& one : outliers) {
      largest = (std::max)(largest, one.position);
      turned = (std::max)(turned, one.rotation);
    }
    out.push_back(message(
        counted(static_cast<Index>(outliers.size()), "training row is an outlier", "training rows are outliers"),
        outliers_kept ? " and kept, as asked: " : " and left out: ", where(outliers), " (off by up to ",
        brief(largest * 1e3), " mm", turned > 0 ? ", " + brief(turned * 1e3) + " mrad" : "", ")."));
  }
  return out;
}

namespace detail {

/// Errors of those held-out poses that lie inside the range of validity, or outside [mm].
VERNIER_LOCAL std::vector<double> errors_where(const CalibrationReport& report, bool inside) {
  const VectorX& errors = report.stage(report.chosen).position;
  std::vector<double> out;
  for (Index i = 0; i < errors.size(); ++i)
    if ((report.gates(i) >= 1) == inside) out.push_back(errors(i) * 1e3);
  return out;
}

/// Statistics of some errors.
VERNIER_LOCAL ErrorStatistics statistics_of(const std::vector<double>& errors) {
  return ErrorStatistics::of(Eigen::Map<const VectorX>(errors.data(), static_cast<Index>(errors.size())));
}

/// Errors of all held-out poses.
VERNIER_LOCAL std::string describe_accuracy(const CalibrationReport& report) {
  const auto e = ErrorStatistics::of(report.stage(report.chosen).position * 1e3);
  const MeanInterval mean = report.held_out_mean();
  std::string out =
      message("Position error of all ", e.n, " held-out ",
              report.independent_poses() < e.n
                  ? message("rows (", report.independent_poses(), " independent poses, each counted once): ")
                  : std::string("poses: "),
              brief(mean.mean * 1e3), " mm mean (",
              std::isfinite(mean.upper)
                  ? message("95 % interval ", brief(mean.lower * 1e3), " to ", brief(mean.upper * 1e3), " mm")
                  : std::string("too few poses for an interval"),
              "), ", brief(e.p95), " mm at the 95th percentile, ", brief(e.max), " mm maximum");
  for (const StageErrors& one : report.stages)
    if (one.name == Stage::frames)
      out += message("; links as designed: ", brief(one.position.mean() * 1e3), " mm mean");
  if (report.block_error > 0)
    out += message("; the training rows follow a path, and blocks of neighbours left out have ",
                   brief(report.block_error * 1e3), " mm");
  return out + ".";
}

/// Errors inside and outside the range of validity; empty where all poses lie inside.
VERNIER_LOCAL std::string describe_where(const CalibrationReport& report) {
  const std::vector<double> inside = errors_where(report, true), outside = errors_where(report, false);
  if (outside.empty()) return "";
  const std::string beyond = brief(statistics_of(outside).mean);
  if (inside.empty())
    return "None of them lies inside the range of validity; outside, the learned functions of the joints fade out.";
  const auto e = statistics_of(inside);
  return message(e.n, " of them ", e.n == 1 ? "lies" : "lie", " inside the range of validity: ", brief(e.mean),
                 " mm mean, ", brief(e.max), " mm maximum. The other ",
                 outside.size() == 1 ? std::string("has ") : message(outside.size(), " have a mean of "), beyond,
                 " mm; there the learned functions of the joints fade out.");
}

/// The deployed stage, and by name the last decision on each block that this stage may have.
VERNIER_LOCAL std::string describe_choice(const CalibrationReport& report) {
  std::string out = message("Deployed, as left-out poses decide: ", report.stage(report.chosen).title);
  if (report.chosen.stage == Stage::geometry_learned) return out + ".";  // it has no blocks
  const bool again = std::any_of(report.blocks.begin(), report.blocks.end(),
                                 [](const BlockChoice& block) { return block.block == Block::elastic_again; });
  const auto list = [&](const char* title, const auto& belongs) {
    std::string names;
    for (const BlockChoice& block : report.blocks) {
      if (!belongs(block) || (again && block.block == Block::elastic)) continue;
      const Block named = block.block == Block::elastic_again ? Block::elastic : block.block;
      names += (names.empty() ? "" : ", ") + std::string(traits_of(named).title);
    }
    if (!names.empty()) out += title + names;
  };
  const auto answered = [](Answer answer) {
    return [answer](const BlockChoice& block) { return block.existence.answer == answer && !block.used; };
  };
  // the drift of a session is part of no model
  const auto included = [](bool look_alike) {
    return [look_alike](const BlockChoice& block) {
      return block.used && block.existence.look_alike == look_alike && block.block != Block::drift &&
             block.block != Block::joint_drift;
    };
  };
  list(". Included: ", included(false));
  list(". Included, though these poses cannot tell it from other errors of joints: ", included(true));
  list(". Found, but not deployed, because they predict left-out poses worse: ", answered(Answer::found));
  list(". Ruled out, as too small to matter: ", answered(Answer::ruled_out));
  list(". Undecided, since the poses are too few: ", answered(Answer::undecided));
  list(". Not tested, because time cannot be told apart: ", [](const BlockChoice& block) {
    return block.block == Block::temperature && block.existence.answer == Answer::untested;
  });
  return out + ".";
}

/// Ranges of each joint, in degrees or millimetres.
VERNIER_LOCAL std::string describe_ranges(const char* title, const std::vector<JointReport>& joints,
                                          std::vector<std::pair<double, double>> JointReport::*member) {
  std::string out;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double unit = joints[j].revolute ? 180 / std::numbers::pi : 1e3;
    out += j > 0 ? "; " : "";
    out += joints[j].formula.empty() ? message('q', j + 1) : joints[j].formula + ':';
    const auto& ranges = joints[j].*member;
    for (std::size_t k = 0; k < ranges.size() && k < 4; ++k)
      out += message(k > 0 ? "," : "", ' ', std::llround(ranges[k].first * unit), "..",
                     std::llround(ranges[k].second * unit));
    if (ranges.size() > 4) out += message(", and ", ranges.size() - 4, " more");
  }
  return message(title, " [deg, mm]: ", out, '.');
}

/// By how much the deployed stage is worse than geometry, where joint-wise terms hold; empty where that says nothing.
VERNIER_LOCAL std::string describe_degradation(const CalibrationReport& report) {
  if (report.chosen == Stage::geometry || report.extrapolated() == report.test_poses()) return "";
  return message("Inside the range of validity no held-out pose is worse than with geometry alone",
                 report.max_degradation > 0 ? " by more than " + brief(report.max_degradation * 1e3) + " mm." : ".");
}

/// A text whose first letter is a capital.
VERNIER_LOCAL std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// The answer on a block of unknowns, with its figures.
VERNIER_LOCAL std::string describe_block(const BlockChoice& block) {
  const Existence& effect = block.existence;
  const auto mm = [](double metres) { return brief(metres * 1e3); };
  std::string out = message(capitalised(traits_of(block.block).title), ": ");
  switch (effect.answer) {
    case Answer::found:
      out += message("found (p = ", brief(effect.p), "), ", mm(effect.size), " mm at the tool, ",
                     mm(effect.interval[0]), " to ", mm(effect.interval[1]), " with 95 %");
      if (!block.used) out += "; not deployed, because it predicts left-out poses worse";
      break;
    case Answer::ruled_out: out += message("ruled out above ", mm(effect.interval[1]), " mm at the tool"); break;
    case Answer::undecided:
      if (effect.look_alike) {
        out += message(
            "undecided, because these poses cannot tell it from other errors of joints. In place of them it has ",
            mm(effect.size), " mm at the tool (p = ", brief(effect.p), "); ", block.used ? "included" : "left out");
        break;
      }
      out += message("undecided (p = ", brief(effect.p), "): below ", mm(effect.interval[1]), " mm at the tool, ",
                     mm(effect.relevance), " mm would matter; ",
                     effect.poses > 0 ? message("about ", effect.poses, " poses would decide")
                                      : std::string("more poses of this kind would not decide"));
      break;
    case Answer::untested:
      out += block.block == Block::temperature ? "not tested, because temperature and time cannot be told apart"
             : block.used                      ? "included"
                                               : "left out";
      break;
  }
  return out + message(". Left-out error: ", mm(block.without), " mm without, ", mm(block.with), " mm with.");
}

/// Poses that would determine a parameter.
VERNIER_LOCAL std::string describe_advice(const PoseAdvice& advice, const std::vector<JointReport>& joints,
                                          bool oriented) {
  const bool length = advice.kind == ParameterKind::length;
  std::string out = message(advice.parameter, " is weakly determined (standard deviation ", brief(advice.std_now * 1e3),
                            length ? " mm" : " mrad", ')');
  if (advice.std_then > 0.9 * advice.std_now)
    return out + (oriented
                      ? "; more poses would not determine it: fix it, or measure with another tool."
                      : "; more positions would not determine it: measure orientations, or with the tool point off "
                        "the last axis, or fix it.");
  out += ": add poses like ";
  for (std::size_t k = 0; k < advice.poses.size(); ++k) {
    out += k > 0 ? ", (" : "(";
    for (Index i = 0; i < advice.poses[k].size(); ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const bool revolute = advice.joint_types.empty() ? joints[joint].revolute  // those of the chain
                                                       : advice.joint_types[joint] == JointType::revolute;
      out += message(i > 0 ? ", " : "", std::llround(advice.poses[k](i) * (revolute ? 180 / std::numbers::pi : 1e3)));
    }
    out += ")";
  }
  return out + message("; ", advice.poses.size(), " of them reduce it to ", brief(advice.std_then * 1e3), ".");
}

/// The largest distance between two positions of a base [m], and between two orientations [rad].
struct BaseMotion {
  double translation = 0, rotation = 0;
};

/// Distance between two knots in three rows from `part` on.
VERNIER_LOCAL double knot_distance(const SessionDrift& drift, Index a, Index b, Index part) {
  const auto change = [&](Index k) { return drift.knots(part + k, b) - drift.knots(part + k, a); };
  return std::hypot(change(0), change(1), change(2));
}

/// How far a base moved.
VERNIER_LOCAL BaseMotion motion_of(const SessionDrift& drift) {
  BaseMotion out;
  for (Index a = 0; a < drift.knots.cols(); ++a)
    for (Index b = a + 1; b < drift.knots.cols(); ++b) {
      out.translation = (std::max)(out.translation, knot_distance(drift, a, b, 0));
      out.rotation = (std::max)(out.rotation, knot_distance(drift, a, b, 3));
    }
  return out;
}

/// How far the base moved that moved most; empty where none did.
VERNIER_LOCAL std::string describe_motion(const std::vector<SessionDrift>& drift) {
  BaseMotion most;
  std::size_t of = 0;
  bool any = false;
  for (std::size_t s = 0; s < drift.size(); ++s) {
    if (drift[s].empty()) continue;
    const BaseMotion motion = motion_of(drift[s]);
    if (!any || motion.translation > most.translation) most = motion, of = s;
    any = true;
  }
  if (!any) return "";
  return message("Drift was estimated and is not in the saved model: the base",
                 drift.size() > 1 ? message(" of station ", of + 1) : "", " moved by up to ",
                 brief(most.translation * 1e3), " mm and ", brief(most.rotation * 1e6), " urad during the session.");
}

/// Parameters that the poses determine weakly, by name; empty without any.
VERNIER_LOCAL std::string describe_weak(const IdentificationReport& identification) {
  constexpr std::size_t most = 4;
  const std::vector<std::string> weak = identification.names(ParameterState::weak);
  if (weak.empty()) return "";
  std::string names;
  for (std::size_t k = 0; k < weak.size() && k < most; ++k) names += (k > 0 ? ", " : "") + weak[k];
  if (weak.size() > most) names += message(" and ", weak.size() - most, " more");
  return message(counted(weak.size(), "parameter is", "parameters are"),
                 " weakly determined and regularised around nominal: ", names, ".");
}

/// How far a base moved, and when.
VERNIER_LOCAL std::string describe_drift(const SessionDrift& drift, const std::vector<JointReport>& joints,
                                         const std::string& station) {
  const Index knots = drift.knots.cols();
  const auto [translation, rotation] = motion_of(drift);
  double fastest = 0;
  Index at = 0;
  const Index window = std::max<Index>(1, knots / 8);
  for (Index k = 0; k + window < knots; ++k) {
    const double moved = knot_distance(drift, k, k + window, 0);
    if (!(moved > fastest)) continue;
    fastest = moved;
    at = k;
  }
  const auto time = [&](Index knot) { return std::llround(drift.begin + drift.spacing * static_cast<double>(knot)); };
  std::string zeros;
  if (drift.knots.rows() > 6) {
    Index joint = 0;
    double largest = -1;
    for (Index j = 0; j + 6 < drift.knots.rows(); ++j) {
      const VectorX zero = row_of(drift.knots, 6 + j);
      const double range = VERNIER_LATER(zero).maxCoeff() - VERNIER_LATER(zero).minCoeff();
      if (range > largest) largest = range, joint = j;
    }
    const auto j = static_cast<std::size_t>(joint);
    const bool slides = j < joints.size() && !joints[j].revolute;
    const std::string formula = j < joints.size() ? joints[j].bracketed_formula() : "";
    zeros = message(" The zero of joint ", joint + 1, formula, " moved most, by ", brief(largest * 1e6),
                    slides ? " um." : " urad.");
  }
  return message("During the session the base", station, " moved by up to ", brief(translation * 1e3), " mm and ",
                 brief(rotation * 1e6), " urad, fastest (", brief(fastest * 1e3), " mm) between ", time(at), " and ",
                 time(at + window), " of ", time(0), " .. ", time(knots - 1), " [row, or time_s].", zeros,
                 " The model that is saved is without drift.");
}

/// Lines of a joint's gear and encoder, which errors of its assembly do not reach; empty where there are none.
VERNIER_LOCAL std::string describe_lines(const JointReport& joint, std::size_t number) {
  constexpr int assembly = 28;
  constexpr int most = 3;
  std::string out;
  int count = 0;
  for (const HarmonicEstimate& line : joint.lines) {
    if (line.order <= assembly || ++count > most) continue;
    out += message(out.empty() ? message("Joint ", number, joint.bracketed_formula(), ": ") : "; ",
                   std::llround(line.amplitude * 1e6), " urad (+-", std::llround(line.margin() * 1e6), ") at order ",
                   line.order);
    if (const std::string cause = cause_of(line.order, joint.drive); !cause.empty()) out += ", " + cause;
  }
  return out.empty() ? out : out + ".";
}

}  // namespace detail

VERNIER_IMPL std::vector<std::string> CalibrationReport::verdict() const {
  std::string urgent;
  for (const std::string& one : remarks()) urgent += (urgent.empty() ? "" : " ") + one;
  const std::string lines[] = {few_poses(),
                               detail::describe_accuracy(*this),
                               detail::describe_where(*this),
                               detail::describe_choice(*this),
                               urgent,
                               detail::describe_motion(drift),
                               detail::describe_weak(identification)};
  std::vector<std::string> out;
  for (const std::string& line : lines)
    if (!line.empty()) out.push_back(line);
  return out;
}

VERNIER_IMPL std::vector<std::string> CalibrationReport::details() const {
  std::vector<std::string> out;
  if (std::string text = detail::describe_degradation(*this); !text.empty()) out.push_back(std::move(text));
  out.push_back(detail::describe_ranges("Measured joint ranges", joints, &JointReport::measured_ranges));
  out.push_back(detail::describe_ranges("Range of validity", joints, &JointReport::valid_ranges));
  for (const BlockChoice& block : blocks) out.push_back(detail::describe_block(block));
  if (prior && prior->used)
    out.push_back(message("Of the calibration '", prior->name, "' the geometry has changed by ",
                          detail::brief(prior->geometry * 100), " % and the joint errors by ",
                          detail::brief(prior->joints * 100), " % of their expected sizes, as far as evidence tells."));
  if (!trials.empty()) {
    std::string sentence = "Left-out poses with what was learned on top: ";
    for (std::size_t k = 0; k < trials.size(); ++k) {
      const RemainderTrial& trial = trials[k];
      sentence += message(k == 0 ? "" : "; ", learner_title(trial.learner),
                          trial.on_geometry ? " on geometry " : " on the error model ", detail::brief(trial.with * 1e3),
                          " mm (", detail::brief(trial.without * 1e3), " without)");
    }
    out.push_back(sentence + ".");
  }
  if (chosen.stage != Stage::learned &&
      std::any_of(trials.begin(), trials.end(), [](const RemainderTrial& trial) { return !trial.on_geometry; }))
    out.push_back("No learned correction was added to the error model: none reduced the left-out error by enough.");
  if (mean_temperature)
    out.push_back(message("Where no temperature is given, the model is that of ", detail::brief(*mean_temperature),
                          " deg C, the mean of the measurements."));
  if (down)
    out.push_back(message("Gravity was found along ", detail::brief(down->direction(0)), ", ",
                          detail::brief(down->direction(1)), ", ", detail::brief(down->direction(2)),
                          " of the arm's base frame, to ", detail::brief(down->std * 1e3), " mrad."));
  if (payload && payload->estimated)
    out.push_back(message("Where no payload is given, the model is that of ", detail::brief(payload->mean),
                          " kg, the mean of the measurements."));
  for (std::size_t s = 0; s < drift.size(); ++s)
    if (!drift[s].empty())
      out.push_back(detail::describe_drift(drift[s], joints, drift.size() > 1 ? message(" of station ", s + 1) : ""));
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (std::string lines = detail::describe_lines(joints[j], j + 1); !lines.empty()) out.push_back(std::move(lines));
  for (std::string& sentence : next()) out.push_back(std::move(sentence));
  return out;
}

VERNIER_IMPL std::vector<std::string> CalibrationReport::next() const {
  std::vector<std::string> out;
  for (const PoseAdvice& one : advice) out.push_back(detail::describe_advice(one, joints, oriented));
  return out;
}

VERNIER_IMPL std::string CalibrationReport::summary() const {
  std::string out = "Verdict\n";
  for (const std::string& line : verdict()) out += "- " + line + "\n";
  out += message("\nErrors of the ", counted(test_poses(), "held-out pose", "held-out poses"), " [mm]\n\n",
                 stage_table(stages));
  for (const FittedSet& set : others)
    out += message(set.name, ": ", set.measurements, " measurements (", set.kind, "), fitted to ",
                   detail::brief(set.rms * 1e3), " mm (rms)\n");
  return out;
}

VERNIER_IMPL std::string CalibrationReport::full_summary() const {
  std::string out = summary() + "\n" + identification.summary() + "\nDetails\n";
  for (const std::string& line : details()) out += "- " + line + "\n";
  return out;
}

}  // namespace vernier
