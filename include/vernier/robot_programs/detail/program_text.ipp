// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::detail {

VERNIER_IMPL void fail_at(const ProgramText& text, std::size_t line, const std::string& what) {
  throw DataError(message(text.name, ", line ", line, ": ", what));
}

VERNIER_IMPL std::string lower_case(std::string_view word) {
  std::string out(word);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

VERNIER_IMPL std::string excerpt(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 60)) {
    const bool space = c == ' ' || c == '\t' || c == '\r' || c == '\n';
    if (space && (out.empty() || out.back() == ' ')) continue;
    out += space ? ' ' : c > ' ' && c <= '~' ? c : '?';
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out + (text.size() > 60 ? "..." : "");
}

VERNIER_IMPL std::string excerpt(const ProgramText& text, std::size_t first, std::size_t last) {
  if (first >= last) return {};
  return excerpt(text.text.substr(text.tokens[first].begin, text.tokens[last - 1].end - text.tokens[first].begin));
}

VERNIER_IMPL ProgramText ProgramText::of(std::string_view text, const std::string& name, const ProgramSyntax& syntax) {
  using Kind = ProgramToken::Kind;
  constexpr std::size_t max_bytes = std::size_t{16} << 20, max_line = 100000;
  ProgramText out;
  out.text = text;
  out.name = name;
  if (text.size() > max_bytes) throw DataError(message(name, ": ", text.size(), " bytes, at most ", max_bytes));
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto letter = [&](char c) { return is_word_character(c) && !digit(c); };
  std::size_t i = text.starts_with("\xEF\xBB\xBF") ? 3 : 0, line = 1, line_begin = 0;
  const auto line_length = [&](std::size_t end) {
    if (end - line_begin > max_line)
      fail_at(out, line, message(end - line_begin, " bytes in a line, at most ", max_line));
  };
  const auto ends_line = [&](std::size_t k) {  // \n, \r\n, or \r alone
    return text[k] == '\n' || (text[k] == '\r' && (k + 1 == text.size() || text[k + 1] != '\n'));
  };
  while (i < text.size()) {
    const char c = text[i];
    const std::size_t begin = i;
    if (c == '\0') fail_at(out, line, "binary data, not text");
    if (ends_line(i)) {
      line_length(i);
      if (syntax.lines) out.tokens.push_back({Kind::line_end, i, i + 1, line});
      ++line;
      line_begin = ++i;
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v') {
      ++i;
    } else if (syntax.comments.find(c) != std::string_view::npos) {
      while (i < text.size() && !ends_line(i))
        if (text[i++] == '\0') fail_at(out, line, "binary data, not text");
    } else if (syntax.quotes.find(c) != std::string_view::npos) {
      ++i;
      while (i < text.size() && text[i] != c && !ends_line(i))
        if (text[i++] == '\0') fail_at(out, line, "binary data, not text");
      if (i < text.size() && text[i] == c) ++i;
      out.tokens.push_back({Kind::text, begin, i, line});
    } else if (digit(c) || (c == '.' && i + 1 < text.size() && digit(text[i + 1]))) {
      while (i < text.size() && digit(text[i])) ++i;
      if (i < text.size() && text[i] == '.') ++i;
      while (i < text.size() && digit(text[i])) ++i;
      if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        std::size_t k = i + 1;
        if (k < text.size() && (text[k] == '+' || text[k] == '-')) ++k;
        if (k < text.size() && digit(text[k])) {
          while (k < text.size() && digit(text[k])) ++k;
          i = k;
        }
      }
      ProgramToken token{Kind::number, begin, i, line};
      const auto [end, error] = std::from_chars(text.data() + begin, text.data() + i, token.value);
      if (error != std::errc() || !std::isfinite(token.value)) token.value = std::nan("");
      out.tokens.push_back(token);
    } else if (letter(c)) {
      while (i < text.size() && is_word_character(text[i])) ++i;
      out.tokens.push_back({Kind::word, begin, i, line});
    } else {
      out.tokens.push_back({Kind::sign, begin, ++i, line});
    }
  }
  line_length(text.size());
  out.tokens.push_back({Kind::line_end, text.size(), text.size(), line});
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < out.tokens.size(); ++k) {
    if (out.is(k, '(') || out.is(k, '[') || out.is(k, '{')) open.push_back(k);
    if ((out.is(k, ')') || out.is(k, ']') || out.is(k, '}')) && !open.empty()) {
      out.tokens[open.back()].partner = k;
      open.pop_back();
    }
  }
  return out;
}

VERNIER_IMPL std::optional<double> signed_number(const ProgramText& text, std::size_t i, std::size_t& next,
                                                 ByteRange& range) {
  const std::size_t first = i;
  const bool negative = text.is(i, '-');
  if (negative || text.is(i, '+')) ++i;
  if (i >= text.tokens.size() || text.tokens[i].kind != ProgramToken::Kind::number || std::isnan(text.tokens[i].value))
    return {};
  range = {text.tokens[first].begin, text.tokens[i].end};
  next = i + 1;
  return negative ? -text.tokens[i].value : text.tokens[i].value;
}

VERNIER_IMPL BracketValue read_brackets(const ProgramText& text, std::size_t& i, char terminator) {
  constexpr std::size_t max_depth = 32;
  const std::size_t opened_at = text.tokens[i].line;
  std::vector<BracketValue> open;  // from the outermost one
  BracketValue done;
  const auto begin_group = [&] {
    if (open.size() == max_depth)
      fail_at(text, text.tokens[i].line, message("brackets nested deeper than ", max_depth));
    BracketValue group;
    group.group = true;
    group.range = {text.tokens[i].begin, text.tokens[i].end};
    group.token = i;
    group.line = text.tokens[i].line;
    open.push_back(std::move(group));
    ++i;
  };
  const auto skip_lines = [&] {
    while (i < text.tokens.size() && text.is_line_end(i)) ++i;
    if (i >= text.tokens.size() || (terminator != 0 && text.is(i, terminator)))
      fail_at(text, opened_at, "a bracket [ is not closed");
  };
  begin_group();
  while (!open.empty()) {
    skip_lines();
    if (text.is(i, ']') && open.back().values.empty()) {
      // an empty group
    } else if (text.is(i, '[')) {
      begin_group();
      continue;
    } else {
      BracketValue value;
      value.token = i;
      value.line = text.tokens[i].line;
      std::size_t next = i, depth = 0;
      const std::size_t first = i;
      value.number = signed_number(text, i, next, value.range);
      if (value.number) {
        i = next;
        while (i < text.tokens.size() && text.is_line_end(i)) ++i;
        if (!text.is(i, ',') && !text.is(i, ']')) value.number.reset();
      }
      while (i < text.tokens.size() && (depth > 0 || !(text.is(i, ',') || text.is(i, ']')))) {
        if (terminator != 0 && text.is(i, terminator)) break;
        if (text.is(i, '(') || text.is(i, '{') || text.is(i, '[')) ++depth;
        if ((text.is(i, ')') || text.is(i, '}') || text.is(i, ']')) && depth > 0) --depth;
        ++i;
      }
      if (!value.number && i > first) value.range = {text.tokens[first].begin, text.tokens[i - 1].end};
      open.back().values.push_back(std::move(value));
    }
    for (;;) {  // behind a value
      skip_lines();
      if (text.is(i, ',')) {
        ++i;
        break;
      }
      if (!text.is(i, ']')) {  // something between a group and the comma: the group is part of an expression
        BracketValue& last = open.back().values.back();
        last = BracketValue{.range = last.range, .token = last.token, .line = last.line};
        ++i;
        continue;
      }
      BracketValue closed = std::move(open.back());
      open.pop_back();
      closed.range.end = text.tokens[i++].end;
      if (open.empty()) return closed;
      open.back().values.push_back(std::move(closed));
    }
  }
  return done;
}

VERNIER_IMPL std::size_t behind_brackets(const ProgramText& text, std::size_t i, std::size_t stop) {
  if (!text.is(i, '(') && !text.is(i, '[') && !text.is(i, '{')) return (std::min)(i, stop);
  return text.tokens[i].partner == 0 ? stop : (std::min)(text.tokens[i].partner + 1, stop);
}

VERNIER_IMPL void place(const ProgramText& text, std::size_t byte, std::size_t line, ProgramTarget& target) {
  const std::size_t before = byte == 0 ? std::string_view::npos : text.text.find_last_of("\r\n", byte - 1);
  target.line = line;
  target.column = before == std::string_view::npos ? byte + 1 : byte - before;
}

VERNIER_IMPL void use_targets(const ProgramText& text, const std::vector<ProgramStep>& steps,
                              const std::vector<bool>& keep, RobotProgram& program) {
  constexpr std::size_t never = static_cast<std::size_t>(-1);
  if (steps.size() > most_steps) throw DataError(message(text.name, ": more than ", most_steps, " uses of targets"));
  std::vector<ProgramTarget>& targets = program.targets;
  std::vector<std::size_t> first_use(targets.size(), never), uses(targets.size(), 0), before(targets.size(), never);
  std::vector<bool> refused(targets.size(), false);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const ProgramStep& step = steps[s];
    if (!step.target) continue;
    const std::size_t k = *step.target;
    ProgramTarget& target = targets[k];
    if (!step.unknown.empty() && !refused[k]) {
      refused[k] = true;
      program.uncorrected.push_back({target.line, target.name.empty() ? "target" : target.name, step.unknown});
    }
    if (uses[k]++ == 0) {
      first_use[k] = s;
      target.move = step.move;
      if (!step.tool.empty()) target.tool = step.tool;
      if (!step.workobject.empty()) target.workobject = step.workobject;
      if (s > 0 && !step.element && !steps[s - 1].element && steps[s - 1].target) before[k] = *steps[s - 1].target;
    } else {
      if (target.move != step.move) target.move = TargetMove::unknown;
      if (target.kind == TargetKind::pose && !refused[k] &&
          ((!step.tool.empty() && target.tool != step.tool) ||
           (!step.workobject.empty() && target.workobject != step.workobject))) {
        refused[k] = true;
        program.uncorrected.push_back({target.line, target.name, "moves use it with different tools or work objects"});
      }
    }
  }
  std::vector<std::size_t> order, index(targets.size(), never);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (refused[k] || targets[k].numbers.empty()) continue;
    if (uses[k] == 0 && !keep[k]) {
      program.uncorrected.push_back({targets[k].line, excerpt(targets[k].name), "no move of this file uses it"});
      continue;
    }
    order.push_back(k);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return first_use[a] != first_use[b] ? first_use[a] < first_use[b] : a < b;
  });
  std::vector<ProgramTarget> sorted;
  sorted.reserve(order.size());
  for (const std::size_t k : order) {
    index[k] = sorted.size();
    sorted.push_back(std::move(targets[k]));
    // Of one that several moves use, or that repeats the one before, nobody knows from where.
    if (uses[k] == 1 && before[k] != never && index[before[k]] < index[k]) sorted.back().previous = index[before[k]];
  }
  targets = std::move(sorted);
  sort_by_line(program.uncorrected);
  const bool feeds = text.text.find('\n') != std::string_view::npos;
  program.end_of_line = text.text.find("\r\n") != std::string_view::npos          ? "\r\n"
                        : feeds || text.text.find('\r') == std::string_view::npos ? "\n"
                                                                                  : "\r";
}

VERNIER_IMPL void sort_by_line(std::vector<Uncorrected>& remarks) {
  std::vector<std::size_t> by_line(remarks.size());
  for (std::size_t k = 0; k < by_line.size(); ++k) by_line[k] = k;
  std::sort(by_line.begin(), by_line.end(), [&](std::size_t a, std::size_t b) {
    return remarks[a].line != remarks[b].line ? remarks[a].line < remarks[b].line : a < b;
  });
  std::vector<Uncorrected> ordered;
  for (const std::size_t k : by_line) ordered.push_back(std::move(remarks[k]));
  remarks = std::move(ordered);
}

VERNIER_IMPL Matrix3 rotation_of_zyx(double a, double b, double c) {
  return (Eigen::AngleAxisd(a, Vector3::UnitZ()) * Eigen::AngleAxisd(b, Vector3::UnitY()) *
          Eigen::AngleAxisd(c, Vector3::UnitX()))
      .toRotationMatrix();
}

VERNIER_IMPL Vector3 zyx_of_rotation(const Matrix3& rotation) {
  const double horizontal = std::hypot(rotation(0, 0), rotation(1, 0));
  const double b = std::atan2(-rotation(2, 0), horizontal);
  if (horizontal < 1e-9) return {std::atan2(-rotation(0, 1), rotation(1, 1)), b, 0};
  return {std::atan2(rotation(1, 0), rotation(0, 0)), b, std::atan2(rotation(2, 1), rotation(2, 2))};
}

VERNIER_IMPL std::optional<Isometry3> frame_of_quaternion(const Vector3& mm, const Eigen::Vector4d& quaternion) {
  if (!(std::abs(quaternion.norm() - 1) < 0.01)) return {};
  Isometry3 out = Isometry3::Identity();
  out.translation() = mm * 1e-3;
  out.linear() =
      Eigen::Quaterniond(quaternion(0), quaternion(1), quaternion(2), quaternion(3)).normalized().toRotationMatrix();
  return out;
}

}  // namespace vernier::detail
