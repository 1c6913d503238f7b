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

namespace detail {

/// Lengths of links, and travel of prismatic joints [m].
VERNIER_LOCAL double reach_of(const CalibrationReport& report) {
  double out = 0;
  for (const ParameterEstimate& p : report.identification.parameters)
    if (p.kind == ParameterKind::length && !p.name.starts_with("base") && !p.name.starts_with("tool"))
      out += std::abs(p.identified);
  for (const JointReport& joint : report.joints)
    if (!joint.revolute && !joint.measured_ranges.empty())
      out += (std::max)(std::abs(joint.measured_ranges.front().first), std::abs(joint.measured_ranges.back().second));
  return out;
}

/// Distance of the tool point from the flange [m].
VERNIER_LOCAL double tool_length(const CalibrationReport& report) {
  double square = 0;
  for (const ParameterEstimate& p : report.identification.parameters)
    if (p.kind == ParameterKind::length && p.name.starts_with("tool")) square += p.identified * p.identified;
  return std::sqrt(square);
}

}  // namespace detail

VERNIER_IMPL std::vector<std::string> CalibrationReport::remarks() const {
  using detail::brief;
  std::vector<std::string> out;
  if (!converged) out.push_back("The fit of the joint errors stopped before it converged.");
  if (identification.condition > 1e6)
    out.push_back(message("The poses hardly determine some of the estimated parameters (condition ",
                          brief(identification.condition), "): do not trust values with large standard deviations."));
  const double tool = detail::tool_length(*this), reach = detail::reach_of(*this);
  if (tool > reach)
    out.push_back(message("The tool point was found ", brief(tool * 1e3),
                          " mm from the flange, beyond the arm's reach of ", brief(reach * 1e3),
                          " mm: wrong robot, or poses that do not determine it?"));
  for (const RemainderTrial& trial : trials)
    if (!trial.on_geometry && trial.learner == Learner::pso_elm && chosen.stage != Stage::learned)
      out.push_back("What learners find in what the error model leaves does not help left-out poses: not used.");
  if (outliers > 0 && median_error > 1e-6)
    out.push_back(message(outliers, " of the training rows have errors above eight times the median of ",
                          brief(median_error * 1e3), " mm: outliers?",
                          loss == Loss::squared ? " A robust loss (huber) reduces their weight."
                                                : " The loss reduces their weight in the fit; check them."));
  return out;
}

namespace detail {

/// Accuracy inside the measured joint ranges.
VERNIER_LOCAL void describe_accuracy(const CalibrationReport& report, std::vector<std::string>& out) {
  const VectorX& last = report.stage(report.chosen).position;
  std::vector<double> inside;
  for (Index i = 0; i < last.size(); ++i)
    if (report.gates(i) >= 1) inside.push_back(last(i) * 1e3);
  if (!inside.empty()) {
    const auto e = ErrorStatistics::of(Eigen::Map<const VectorX>(inside.data(), static_cast<Index>(inside.size())));
    out.push_back(
        message("Accurate to ", brief(e.mean), " mm mean, ", brief(e.p95), " mm (95 %), ", brief(e.max),
                " mm maximum, inside the measured joint ranges: ", e.n, " of ", last.size(),
                " held-out poses. None of them is worse than with geometry alone",
                report.max_degradation > 0 ? " by more than " + brief(report.max_degradation * 1e3) + " mm." : "."));
  }
  if (const Index outside = report.extrapolated(); outside > 0)
    out.push_back(counted(outside, "held-out pose lies", "held-out poses lie") +
                  " outside those ranges; there the learned functions of the joints fade out.");
}

/// Measured joint ranges, in degrees or millimetres.
VERNIER_LOCAL std::string describe_ranges(const std::vector<JointReport>& joints) {
  std::string out;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double unit = joints[j].revolute ? 180 / std::numbers::pi : 1e3;
    out += message(j > 0 ? "; " : "", 'q', j + 1);
    const auto& ranges = joints[j].measured_ranges;
    for (std::size_t k = 0; k < ranges.size() && k < 4; ++k)
      out += message(k > 0 ? "," : "", ' ', std::llround(ranges[k].first * unit), "..",
                     std::llround(ranges[k].second * unit));
    if (ranges.size() > 4) out += message(", and ", ranges.size() - 4, " more");
  }
  return "Measured joint ranges [deg, mm]: " + out + ".";
}

/// A decision on a block of joint errors.
VERNIER_LOCAL std::string describe_block(const BlockChoice& block) {
  const BlockTraits& traits = traits_of(block.block);
  return message(
      block.used ? traits.included : traits.left_out, "(leave-one-pose-out error: ", brief(block.without * 1e3),
      " mm without, ", brief(block.with * 1e3), " mm with",
      block.log_density_gain > 0
          ? "; log predictive density of a left-out pose greater by " + brief(block.log_density_gain) + " nat"
          : std::string(),
      ").");
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
    for (Index i = 0; i < advice.poses[k].size(); ++i)
      out += message(i > 0 ? ", " : "",
                     std::llround(advice.poses[k](i) *
                                  (joints[static_cast<std::size_t>(i)].revolute ? 180 / std::numbers::pi : 1e3)));
    out += ")";
  }
  return out + message("; ", advice.poses.size(), " of them reduce it to ", brief(advice.std_then * 1e3), ".");
}

/// How far a base moved, and when.
VERNIER_LOCAL std::string describe_drift(const SessionDrift& drift, const std::vector<JointReport>& joints,
                                         const std::string& station) {
  const Index knots = drift.knots.cols();
  const auto apart = [&](Index a, Index b, Index part) {
    const auto change = [&](Index k) { return drift.knots(part + k, b) - drift.knots(part + k, a); };
    return std::hypot(change(0), change(1), change(2));
  };
  double translation = 0, rotation = 0, fastest = 0;
  Index at = 0;
  for (Index a = 0; a < knots; ++a)
    for (Index b = a + 1; b < knots; ++b) {
      translation = (std::max)(translation, apart(a, b, 0));
      rotation = (std::max)(rotation, apart(a, b, 3));
    }
  const Index window = std::max<Index>(1, knots / 8);
  for (Index k = 0; k + window < knots; ++k) {
    const double moved = apart(k, k + window, 0);
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
      const double range = zero.maxCoeff() - zero.minCoeff();
      if (range > largest) largest = range, joint = j;
    }
    const auto j = static_cast<std::size_t>(joint);
    const bool slides = j < joints.size() && !joints[j].revolute;
    zeros =
        message(" The zero of joint ", joint + 1, " moved most, by ", brief(largest * 1e6), slides ? " um." : " urad.");
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
    out += message(out.empty() ? message("Joint ", number, ": ") : "; ", std::llround(line.amplitude * 1e6),
                   " urad (+-", std::llround(line.margin() * 1e6), ") at order ", line.order);
    if (const std::string cause = cause_of(line.order, joint.drive); !cause.empty()) out += ", " + cause;
  }
  return out.empty() ? out : out + ".";
}

}  // namespace detail

VERNIER_IMPL std::vector<std::string> CalibrationReport::verdict() const {
  std::vector<std::string> out;
  detail::describe_accuracy(*this, out);
  out.push_back(detail::describe_ranges(joints));
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
  out.push_back(message("Chosen by left-out poses: ", stage(chosen).title, "."));
  if (mean_temperature)
    out.push_back(message("Where no temperature is given, the model is that of ", detail::brief(*mean_temperature),
                          " deg C, the mean of the measurements."));
  for (std::size_t s = 0; s < drift.size(); ++s)
    if (!drift[s].empty())
      out.push_back(detail::describe_drift(drift[s], joints, drift.size() > 1 ? message(" of station ", s + 1) : ""));
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (std::string lines = detail::describe_lines(joints[j], j + 1); !lines.empty()) out.push_back(std::move(lines));
  for (std::string& sentence : next()) out.push_back(std::move(sentence));
  if (const std::size_t weak = identification.names(ParameterState::weak).size(); weak > advice.size()) {
    const std::size_t left = weak - advice.size();
    out.push_back((advice.empty() ? counted(left, "parameter is", "parameters are")
                                  : counted(left, "more parameter is", "more parameters are")) +
                  " weakly determined and regularised around nominal.");
  }
  return out;
}

VERNIER_IMPL std::vector<std::string> CalibrationReport::next() const {
  std::vector<std::string> out;
  for (const PoseAdvice& one : advice) out.push_back(detail::describe_advice(one, joints, oriented));
  return out;
}

VERNIER_IMPL std::string CalibrationReport::summary() const {
  std::string out = message("Errors of the ", test_poses(), " held-out poses [mm]\n\n", stage_table(stages), "\n",
                            identification.summary());
  for (const FittedSet& set : others)
    out += message(set.name, ": ", set.measurements, " measurements (", set.kind, "), fitted to ",
                   detail::brief(set.rms * 1e3), " mm (rms)\n");
  for (const std::string& line : remarks()) out += line + "\n";
  out += "\nVerdict\n";
  for (const std::string& line : verdict()) out += "- " + line + "\n";
  return out;
}

}  // namespace vernier
