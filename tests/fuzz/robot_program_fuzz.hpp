// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the fuzz targets of all languages of robot programs do: a program is parsed, and its targets are written again.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "reader_fuzz.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::fuzz {

/// Whether `written` is `text` with other numbers in the ranges, and at most a blank in front of each.
inline bool same_around(std::string_view text, const std::vector<ByteRange>& ranges, std::string_view written) {
  const auto digits = [&] { written.remove_prefix(std::min(written.find_first_not_of("0123456789"), written.size())); };
  std::size_t at = 0;
  for (const ByteRange& range : ranges) {
    if (range.begin < at || !written.starts_with(text.substr(at, range.begin - at))) return false;
    written.remove_prefix(range.begin - at);
    at = range.end;
    if (written.starts_with(' ')) written.remove_prefix(1);
    if (written.starts_with('-')) written.remove_prefix(1);
    digits();
    if (!written.starts_with('.')) continue;
    written.remove_prefix(1);
    digits();
  }
  return written == text.substr(at);
}

/// Parses the bytes. Targets written with the numbers that they have must leave everything else as it was, and be read
/// as as many targets.
inline int read_program(ProgramLanguage language, const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    const RobotProgram program = parse_program(language, text, "program");
    std::vector<ReplacedTarget> same;
    std::vector<ByteRange> ranges;
    for (std::size_t k = 0; k < program.targets.size(); ++k) {
      const ProgramTarget& target = program.targets[k];
      if (target.previous && *target.previous >= k) finding("a target comes from a later one", text);
      const bool pose = target.kind == TargetKind::pose;
      const JointVector<6> joints = pose ? JointVector<6>(JointVector<6>::Zero()) : target.joints;
      if (!(joints.array().abs() < 1e6).all() || target.pose.translation().norm() > 1e6) continue;
      same.push_back({k, target.pose, joints});
      ranges.insert(ranges.end(), target.numbers.begin(), target.numbers.end());
    }
    std::sort(ranges.begin(), ranges.end(), [](ByteRange a, ByteRange b) { return a.begin < b.begin; });
    RobotProgram without = program;  // configurations are kept
    for (ProgramTarget& target : without.targets) target.configuration_numbers.clear();
    if (!same_around(text, ranges, replace_targets(text, without, same))) finding("other bytes are changed", text);
    const std::string written = replace_targets(text, program, same);
    if (parse_program(language, written, "program").targets.size() != program.targets.size())
      finding("other targets are read than were written", written);
  } catch (const DataError& error) {
    check_complaint(error.what());
  }
  return 0;
}

}  // namespace vernier::fuzz
