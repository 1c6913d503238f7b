// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/robot_programs/detail/program_readers.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"
#include "vernier/robot_programs/detail/urscript_statements.hpp"

namespace vernier::detail {

/// Reads the targets of a URScript program.
class UrscriptReader final : private StatementReader {
 public:
  UrscriptReader(const ProgramText& from, RobotProgram& to, const StatementTable& table)
      : StatementReader(from, to, table) {}

  void read() {
    program_.stamp_at = text_.text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    program_.workobjects["base"] = Isometry3::Identity();
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i)
      if (begins_routine(i)) routines_.insert(std::string(text_.at(i + 1)));
    collect_assignments();
    follow();
    for (const auto& [name, assigned] : assigned_)
      if (used_.count(name) != 0 && !assigned.targets.empty())
        for (const std::size_t token : assigned.computed)
          remark(line(token), excerpt(text_, token, line_end(token)), "the program changes this target");
    solve();
    join_pairs();
    use_targets(text_, steps_, std::vector<bool>(program_.targets.size(), false), program_);
  }

 private:
  struct Assigned {
    std::vector<std::size_t> targets{};
    std::vector<std::size_t> computed{};  // tokens of other values
  };

  static bool is_move(std::string_view word) {
    static const auto joint_moves = words_of(urscript_joint_moves), linear_moves = words_of(urscript_linear_moves);
    return joint_moves.count(word) != 0 || linear_moves.count(word) != 0;
  }

  std::size_t line(std::size_t i) const { return text_.tokens[i].line; }
  bool begins_routine(std::size_t i) const {
    if (!text_.is_word(i) || !text_.is_word(i + 1)) return false;
    return text_.at(i) == "def" || text_.at(i) == "thread" || text_.at(i) == "sec";
  }

  // statements in the order of the text
  void follow() {
    std::size_t depth = 0;       // of brackets
    std::vector<bool> routines;  // of the blocks around: whether each is one
    std::vector<std::set<std::string, std::less<>>> parameters{{}};
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i) {
      if (is_open(i)) ++depth;
      if ((text_.is(i, ')') || text_.is(i, ']') || text_.is(i, '}')) && depth > 0) --depth;
      const bool first = depth == 0 && (i == 0 || ends(i - 1));  // of a statement
      if (!text_.is_word(i)) {
        if (first && !ends(i)) unknown(line(i), excerpt(text_, i, line_end(i)));
        continue;
      }
      const std::string_view word = text_.at(i);
      if (begins_routine(i)) {
        flow_.begin(std::string(text_.at(i + 1)), word == "thread");
        break_order();
        routines.push_back(true);
        parameters.emplace_back();
        const bool closed = text_.is(i + 2, '(') && text_.tokens[i + 2].partner != 0;
        const std::size_t end = closed ? text_.tokens[i + 2].partner + 1 : i + 2;
        for (std::size_t k = i + 3; k < end; ++k)
          if (text_.is_word(k)) parameters.back().insert(std::string(text_.at(k)));
        i = end - 1;
      } else if (word == "if" || word == "while" || word == "for") {
        flow_.open(word != "if");
        routines.push_back(false);
      } else if (word == "elif" || word == "else") {
        flow_.branch();
      } else if (word == "end") {
        const bool routine = !routines.empty() && routines.back();
        if (routine && parameters.size() > 1) parameters.pop_back();
        routine ? flow_.end() : flow_.close();
        if (!routines.empty()) routines.pop_back();
      } else if (word == "break" || word == "continue") {
        flow_.leave_loop();
      } else if (word == "return" || word == "halt") {
        flow_.leave_routine();
      } else if (word.starts_with('$')) {  // $ 3 "Waypoint_1": a mark of the editor
        while (!text_.is_line_end(i + 1)) ++i;
      } else if (text_.is(i + 1, '(')) {
        parameters_ = &parameters.back();
        call(i, word);
      } else if (first && !is_keyword(word) && !assigns(i)) {
        unknown(line(i), excerpt(text_, i, line_end(i)));
      }
    }
  }

  static bool is_keyword(std::string_view word) {
    static const auto words = words_of("global local run join kill enter_critical exit_critical pass");
    return words.count(word) != 0;
  }

  // whether a statement begins with the name of a variable: name = , name[..] = , name.member
  bool assigns(std::size_t i) const {
    std::size_t k = i + 1;
    while (text_.is(k, '[')) k = behind_brackets(text_, k, text_.tokens.size());
    return text_.is(k, '=') || text_.is(k, '.');
  }

  void call(std::size_t i, std::string_view word) {
    static const auto keywords = words_of("not and or xor elif return join kill run in");
    if (keywords.count(word) != 0 || (i > 0 && text_.is(i - 1, '.'))) return;  // a member of an object is no routine
    const std::string name(word);
    if (word == "set_tcp") {
      flow_.set(ProgramState::tool, {set_tcp(i), {}, line(i)});
    } else if (is_move(word)) {
      move(i);
    } else if (routines_.count(name) != 0) {
      flow_.call(name);
      break_order();
    } else {
      apply(line(i), name, {}, excerpt(text_, i, behind_brackets(text_, i + 1, text_.tokens.size())));
    }
  }

  std::size_t line_end(std::size_t i) const {
    const std::size_t stop = (std::min)(i + 20, text_.tokens.size());  // enough for a remark
    while (i < stop && !text_.is_line_end(i)) ++i;
    return i;
  }

  bool is_pose(std::size_t i) const {
    return text_.is_word(i) && text_.at(i) == "p" && text_.is(i + 1, '[') &&
           text_.tokens[i].end == text_.tokens[i + 1].begin;
  }

  // p[..] or a list of six numbers at token i, which is then behind it; none where it is something else
  std::optional<ProgramTarget> literal(std::size_t& i) const {
    const std::size_t first = i;
    const bool pose = is_pose(i);
    if (pose) ++i;
    const BracketValue value = read_brackets(text_, i, 0);
    if (!value.numbers(6)) return {};
    ProgramTarget out;
    place(text_, text_.tokens[first].begin, text_.tokens[first].line, out);
    Vector6 numbers;
    for (std::size_t k = 0; k < 6; ++k) {
      numbers(static_cast<Index>(k)) = *value.values[k].number;
      out.numbers.push_back(value.values[k].range);
    }
    if (pose) {
      out.pose.translation() = numbers.head<3>();
      if (!(numbers.tail<3>().norm() < 100)) return {};
      out.pose.linear() = exp_so3(Vector3(numbers.tail<3>()));
      out.workobject = "base";
    } else {
      out.kind = TargetKind::joints;
      out.joints = numbers;
    }
    return out;
  }

  void collect_assignments() {
    std::size_t depth = 0;
    for (std::size_t i = 0; i < text_.tokens.size();) {
      if (text_.is(i, '(')) ++depth;
      if (text_.is(i, ')') && depth > 0) --depth;
      std::size_t sign = i + 1;
      if (depth == 0 && text_.is_word(i))
        while (text_.is(sign, '[')) sign = behind_brackets(text_, sign, text_.tokens.size());
      const bool name = text_.is_word(i) && text_.is(sign, '=') && !text_.is(sign + 1, '=') && depth == 0;
      if (!name) {
        ++i;
        continue;
      }
      Assigned& assigned = assigned_[std::string(text_.at(i))];
      if (sign != i + 1) {  // an element
        assigned.computed.push_back(i);
        i = sign;
        continue;
      }
      std::size_t k = i + 2;
      if (is_pose(k) || text_.is(k, '[')) {
        if (std::optional<ProgramTarget> found = literal(k); found && (k >= text_.tokens.size() || ends(k))) {
          found->name = std::string(text_.at(i));
          assigned.targets.push_back(program_.targets.size());
          program_.targets.push_back(std::move(*found));
          i = k;
          continue;
        }
      }
      assigned.computed.push_back(i);
      i += 2;
    }
  }

  bool ends(std::size_t k) const { return text_.is_line_end(k) || text_.is(k, ';') || text_.is(k, ':'); }

  // the tool of what follows; empty where it is unknown
  std::string set_tcp(std::size_t i) {
    std::size_t k = i + 2;
    std::optional<ProgramTarget> found;
    if (is_pose(k)) {
      found = literal(k);
      if (!text_.is(k, ')') && !text_.is(k, ',')) found.reset();
    } else if (text_.is_word(k) && (text_.is(k + 1, ')') || text_.is(k + 1, ','))) {
      const auto assigned = assigned_.find(std::string(text_.at(k)));
      if (assigned != assigned_.end() && assigned->second.targets.size() == 1 && assigned->second.computed.empty()) {
        found = program_.targets[assigned->second.targets[0]];
        tools_.insert(assigned->second.targets[0]);
      }
    }
    if (!found || found->kind != TargetKind::pose) return {};
    return named_frame(ProgramState::tool, message("set_tcp of line ", line(i)), found->pose);
  }

  void move(std::size_t i) {
    static const auto joint_moves = words_of(urscript_joint_moves);
    const TargetMove kind = joint_moves.count(text_.at(i)) != 0 ? TargetMove::joint : TargetMove::linear;
    const std::size_t point = flow_.point();
    std::size_t first = i + 2;
    const std::size_t close = behind_brackets(text_, i + 1, text_.tokens.size()) - 1;
    for (int a = 0; a < (text_.at(i) == "movec" ? 2 : 1); ++a) {
      const std::size_t last = argument_end(first, close);
      ProgramStep step{{}, {}, "base", kind};
      step.point = point;
      target(i, first, last, step);
      first = last + 1;
    }
  }

  std::size_t argument_end(std::size_t i, std::size_t stop) const {
    while (i < stop && !text_.is(i, ',')) i = is_open(i) ? behind_brackets(text_, i, stop) : i + 1;
    return (std::min)(i, stop);
  }
  bool is_open(std::size_t i) const { return text_.is(i, '(') || text_.is(i, '[') || text_.is(i, '{'); }

  void target(std::size_t instruction, std::size_t first, std::size_t last, ProgramStep step) {
    const auto remark = [&](const char* reason) {
      add_step(steps_, {{}, {}, {}, step.move});
      StatementReader::remark(line(instruction),
                              std::string(text_.at(instruction)) + "(" + excerpt(text_, first, last) + ")", reason);
    };
    while (first < last && text_.is_line_end(first)) ++first;
    while (last > first && text_.is_line_end(last - 1)) --last;
    if (first >= last) return remark("no target");
    if (text_.is_word(first) && text_.at(first) == "get_inverse_kin" && text_.is(first + 1, '(') &&
        behind_brackets(text_, first + 1, last) == last && first + 2 < last &&
        text_.at(first + 2) != "get_inverse_kin") {
      const std::size_t end = argument_end(first + 2, last - 1), before = steps_.size();
      std::size_t arguments = 1;
      for (std::size_t k = end; k < last - 1; k = argument_end(k + 1, last - 1)) {
        if (++arguments > 4 || (text_.is_word(k + 1) && text_.at(k + 1) == "tcp")) return remark("a tool of its own");
      }
      target(instruction, first + 2, end, step);
      if (steps_.size() == before + 1 && steps_.back().target && end < last - 1)
        seeds_[*steps_.back().target] = joints_near(end + 1, argument_end(end + 1, last - 1));
      return;
    }
    if (is_pose(first) || text_.is(first, '[')) {
      std::size_t k = first;
      if (std::optional<ProgramTarget> found = literal(k); found && k == last) {
        step.target = program_.targets.size();
        program_.targets.push_back(std::move(*found));
        add_step(steps_, step);
        return;
      }
      return remark("computed, not a literal");
    }
    if (!text_.is_word(first) || last != first + 1) return remark("computed, not a literal");
    const std::string name(text_.at(first));
    const auto assigned = assigned_.find(name);
    if (parameters_ != nullptr && parameters_->count(name) != 0) return remark("a parameter");
    if (assigned == assigned_.end()) return remark("not assigned in this file");
    if (assigned->second.targets.empty()) return remark("its value is computed");
    used_.insert(name);
    step.element = assigned->second.targets.size() > 1 || !assigned->second.computed.empty();
    for (const std::size_t k : assigned->second.targets) {
      step.target = k;
      add_step(steps_, step);
    }
  }

  // joints of an argument [qnear=]..; not finite where they are no literal
  JointVector<6> joints_near(std::size_t first, std::size_t last) const {
    JointVector<6> out = ProgramTarget{}.joints;
    if (text_.is_word(first) && text_.is(first + 1, '=')) first += 2;
    if (text_.is(first, '[')) {
      std::size_t k = first;
      const auto found = literal(k);
      if (found && k == last) out = found->joints;
    } else if (text_.is_word(first) && first + 1 == last) {
      const auto assigned = assigned_.find(std::string(text_.at(first)));
      if (assigned != assigned_.end() && assigned->second.targets.size() == 1 && assigned->second.computed.empty())
        out = program_.targets[assigned->second.targets[0]].joints;
    }
    return out;
  }

  // Polyscope writes point_p = p[..] and point_q = [..]. What serves as joints nearby or as a tool alone is no target.
  void join_pairs() {
    std::vector<bool> used(program_.targets.size(), false);
    for (const ProgramStep& step : steps_)
      if (step.target) used[*step.target] = true;
    std::vector<std::size_t> index(program_.targets.size());
    std::vector<ProgramTarget> kept;
    const std::vector<ProgramTarget> all = program_.targets;
    for (std::size_t k = 0; k < all.size(); ++k) {
      ProgramTarget target = all[k];
      if (target.kind == TargetKind::pose && seeds_.count(k) != 0) target.joints = seeds_.at(k);
      if (target.kind == TargetKind::pose && !target.joints.allFinite() && target.name.ends_with("_p")) {
        const auto partner = assigned_.find(target.name.substr(0, target.name.size() - 1) + "q");
        if (partner != assigned_.end() && partner->second.targets.size() == 1)
          target.joints = all[partner->second.targets[0]].joints;
      }
      index[k] = kept.size();
      const bool pose = target.kind == TargetKind::pose;
      if (used[k] || (pose && tools_.count(k) == 0)) kept.push_back(std::move(target));
    }
    for (ProgramStep& step : steps_)
      if (step.target) step.target = index[*step.target];
    program_.targets = std::move(kept);
  }

  std::map<std::string, Assigned> assigned_{};
  std::set<std::string> used_{};
  std::set<std::size_t> tools_{};
  std::map<std::size_t, JointVector<6>> seeds_{};
  std::set<std::string> routines_{};                                // of this file
  const std::set<std::string, std::less<>>* parameters_ = nullptr;  // of the present routine
};

VERNIER_IMPL void read_urscript(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                                RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "#", .quotes = "\"'"});
  UrscriptReader(tokens, program, StatementTable(urscript_harmless, urscript_statements, assumed)).read();
}

}  // namespace vernier::detail
