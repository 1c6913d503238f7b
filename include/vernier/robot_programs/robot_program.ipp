// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/robot_programs/configuration.hpp"
#include "vernier/robot_programs/detail/program_readers.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier {

namespace detail {

inline constexpr std::string_view program_stamp = "VERNIER-CORRECTED";

/// A number, rounded to a number of decimals.
VERNIER_LOCAL std::string with_decimals(double value, int decimals);

VERNIER_IMPL std::string with_decimals(double value, int decimals) {
  std::string out = fixed_digits(value, decimals);
  if (out.find_first_not_of("-0.") == std::string::npos && out.front() == '-') out.erase(0, 1);
  return out;
}

/// The numbers of a pose or joints as the language writes them.
VERNIER_LOCAL std::vector<std::string> written_numbers(ProgramLanguage language, const ProgramTarget& target,
                                                       const ReplacedTarget& replaced);

VERNIER_IMPL std::vector<std::string> written_numbers(ProgramLanguage language, const ProgramTarget& target,
                                                      const ReplacedTarget& replaced) {
  constexpr double degrees = 180 / std::numbers::pi;
  const bool si = language == ProgramLanguage::urscript;
  std::vector<std::string> out;
  const auto angles = [&](const auto& values) {
    for (Index j = 0; j < values.size(); ++j)
      out.push_back(with_decimals(si ? values(j) : values(j) * degrees, si ? 8 : 6));
  };
  if (target.kind == TargetKind::joints) {
    angles(replaced.joints);
    return out;
  }
  for (Index k = 0; k < 3; ++k) out.push_back(with_decimals(replaced.pose(k, 3) * (si ? 1 : 1e3), si ? 7 : 4));
  const Matrix3 turn = rotation(replaced.pose);
  if (language == ProgramLanguage::rapid) {
    Eigen::Quaterniond q(turn);
    q.normalize();
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) out.push_back(with_decimals(value, 9));
  } else if (si) {
    angles(log_so3(turn));
  } else {
    Vector3 zyx = zyx_of_rotation(turn);
    if (language == ProgramLanguage::fanuc_tp) std::swap(zyx(0), zyx(2));
    angles(zyx);
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL ProgramLanguage program_language(const std::string& path) {
  const std::string lower = detail::lower_case(path);
  const auto ends = [&](std::string_view ending) { return lower.ends_with(ending); };
  if (ends(".mod") || ends(".modx") || ends(".prg") || ends(".sys")) return ProgramLanguage::rapid;
  if (ends(".src") || ends(".dat")) return ProgramLanguage::krl;
  if (ends(".script")) return ProgramLanguage::urscript;
  if (ends(".ls")) return ProgramLanguage::fanuc_tp;
  if (ends(".tp")) throw DataError(message(path, ": a binary program; export it as text (.ls)"));
  throw DataError(
      message(path,
              ": no robot program: .mod, .modx, .prg, .sys (RAPID), .src, .dat (KRL), .script (URScript) or .ls "
              "(Fanuc) are"));
}

VERNIER_IMPL RobotProgram parse_program(ProgramLanguage language, std::string_view text, const std::string& name,
                                        const std::vector<std::string>& assumed_harmless) {
  if (const std::size_t at = text.find(detail::program_stamp); at != std::string_view::npos)
    throw DataError(message(name, ", line ",
                            std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1,
                            ": this program was corrected before; correct the original one"));
  RobotProgram out;
  out.language = language;
  switch (language) {
    case ProgramLanguage::rapid: detail::read_rapid(text, name, assumed_harmless, out); break;
    case ProgramLanguage::krl: detail::read_krl(text, name, assumed_harmless, out); break;
    case ProgramLanguage::urscript: detail::read_urscript(text, name, assumed_harmless, out); break;
    case ProgramLanguage::fanuc_tp: detail::read_fanuc_tp(text, name, assumed_harmless, out); break;
  }
  return out;
}

VERNIER_IMPL std::string replace_targets(std::string_view text, const RobotProgram& program,
                                         std::span<const ReplacedTarget> replaced) {
  struct Piece {
    ByteRange range;
    std::string text;
  };
  std::vector<Piece> pieces;
  for (const ReplacedTarget& one : replaced) {
    demand(one.target < program.targets.size(), "replace_targets: no target ", one.target);
    const ProgramTarget& target = program.targets[one.target];
    demand(detail::all_finite(one.pose.matrix()) &&
               std::all_of(one.joints.begin(), one.joints.end(), [](double q) { return std::abs(q) < 1e6; }),
           "replace_targets: target ", one.target, " is not finite");
    const std::vector<std::string> numbers = detail::written_numbers(program.language, target, one);
    for (std::size_t k = 0; k < target.numbers.size(); ++k) pieces.push_back({target.numbers[k], numbers[k]});
    const std::vector<int> configuration = updated_configuration(program.language, target.configuration, one.joints);
    const std::size_t offset = target.configuration.size() - target.configuration_numbers.size();
    for (std::size_t k = 0; k < target.configuration_numbers.size(); ++k)
      if (configuration[offset + k] != target.configuration[offset + k])
        pieces.push_back({target.configuration_numbers[k], message(configuration[offset + k])});
  }
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.range.begin < b.range.begin; });
  std::string out;
  out.reserve(text.size() + 8 * pieces.size());
  std::size_t at = 0;
  for (const Piece& piece : pieces) {
    demand(piece.range.begin >= at && piece.range.end <= text.size(), "replace_targets: a target is there twice");
    out.append(text.substr(at, piece.range.begin - at));
    if (!out.empty() && detail::is_word_character(out.back())) out += ' ';  // X-1.5 must not become X1.5
    out.append(piece.text);
    at = piece.range.end;
  }
  return out.append(text.substr(at));
}

VERNIER_IMPL std::string stamped(std::string_view text, const RobotProgram& program,
                                 const std::vector<std::string>& lines) {
  // Fanuc remarks have at most 32 characters.
  const bool fanuc = program.language == ProgramLanguage::fanuc_tp;
  const std::size_t width = fanuc ? 31 : 100;
  std::string stamp;
  const auto add = [&](std::string_view line) {
    switch (program.language) {
      case ProgramLanguage::rapid: stamp += "! "; break;
      case ProgramLanguage::krl: stamp += "; "; break;
      case ProgramLanguage::urscript: stamp += "# "; break;
      case ProgramLanguage::fanuc_tp: stamp += "   :  !"; break;
    }
    for (const char c : line) stamp += c >= ' ' && c <= '~' && !(fanuc && c == ';') ? c : '?';
    stamp += (fanuc ? " ;" : "") + program.end_of_line;
  };
  add(message(detail::program_stamp, ":"));
  for (const std::string& line : lines)
    for (std::size_t i = 0; i < line.size(); i += width) add(std::string_view(line).substr(i, width));
  std::string out(text.substr(0, (std::min)(program.stamp_at, text.size())));
  if (!out.empty() && out.back() != '\n' && out.back() != '\r' && program.stamp_at > 3) out += program.end_of_line;
  return out.append(stamp).append(text.substr((std::min)(program.stamp_at, text.size())));
}

}  // namespace vernier
