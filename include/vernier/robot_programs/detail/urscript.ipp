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
    find_scopes();
    collect_assignments();
    follow();
    for (const auto& [variable, assigned] : assigned_) {
      if (used_.count(variable) == 0 || assigned.targets.empty() || assigned.computed.empty()) continue;
      for (const std::size_t token : assigned.computed)
        remark(line(token), excerpt(text_, token, line_end(token)), "the program changes this target");
      changed_.insert(assigned.targets.begin(), assigned.targets.end());
    }
    solve();
    join_pairs();
    use_targets(text_, steps_, std::vector<bool>(program_.targets.size(), false), program_);
  }

 private:
  struct Assigned {
    std::vector<std::size_t> targets{};
    std::vector<std::size_t> computed{};  // tokens of other values, and of what changes them
    std::size_t token = 0, block = 0;     // of the last target, and the block around it
  };
  using Variable = std::pair<std::size_t, std::string>;  // its scope and name
  struct Scope {                                         // of a routine, the first one of the file
    std::size_t parent = 0;
    std::set<std::string, std::less<>> parameters{}, locals{}, assigned{};
  };
  struct Block {  // tokens of the branch of a condition, of a loop or routine
    std::size_t first = 0, last = static_cast<std::size_t>(-1);
    bool routine = false;
    std::size_t scope = 0;
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

  // scopes of routines and blocks, and the names that are assigned in them
  void find_scopes() {
    constexpr std::size_t deepest = 100;
    const std::size_t n = text_.tokens.size();
    block_of_.assign(n, 0);
    blocks_.assign(1, {});
    scopes_.assign(1, {});
    std::vector<std::size_t> open{0};
    const auto begin = [&](std::size_t i, bool routine) {
      const std::size_t scope = routine ? scopes_.size() : blocks_[open.back()].scope;
      if (routine) scopes_.push_back({blocks_[open.back()].scope});
      open.push_back(blocks_.size());
      blocks_.push_back({i, static_cast<std::size_t>(-1), routine, scope});
    };
    const auto end = [&](std::size_t i) {
      if (open.size() == 1) return;
      blocks_[open.back()].last = i;
      open.pop_back();
    };
    std::size_t depth = 0, routines = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (text_.is(i, '(')) ++depth;
      if (text_.is(i, ')') && depth > 0) --depth;
      const std::string_view word = text_.is_word(i) ? text_.at(i) : std::string_view();
      if (begins_routine(i)) {
        if (++routines > deepest) fail_at(text_, line(i), message("routines nested deeper than ", deepest));
        begin(i, true);
        const std::size_t stop = text_.is(i + 2, '(') ? behind_brackets(text_, i + 2, n) : i + 2;
        for (std::size_t k = i + 3; k < stop; ++k)
          if (text_.is_word(k)) scopes_.back().parameters.insert(std::string(text_.at(k)));
      } else if (word == "if" || word == "while" || word == "for") {
        begin(i, false);
      } else if (word == "elif" || word == "else") {
        if (!blocks_[open.back()].routine) {
          end(i);
          begin(i, false);
        }
      } else if (word == "end") {
        if (blocks_[open.back()].routine && routines > 0) --routines;
        end(i);
      }
      block_of_[i] = open.back();
      if (word.empty() || depth > 0) continue;
      Scope& scope = scopes_[scope_of(i)];
      const bool whole = text_.is(i + 1, '=') && !text_.is(i + 2, '=');
      const std::string_view before = i > 0 && text_.is_word(i - 1) ? text_.at(i - 1) : std::string_view();
      if (before == "local")
        scope.locals.insert(std::string(word));
      else if (before == "global" || (whole && scope_of(i) == 0))
        globals_.insert(std::string(word));
      else if (whole)
        scope.assigned.insert(std::string(word));
    }
  }
  std::size_t scope_of(std::size_t i) const { return blocks_[block_of_[i]].scope; }

  // The variable that a name at token i means: a parameter or local, a global, or one of a routine around it.
  Variable variable(std::size_t i) const {
    const std::string name(text_.at(i));
    std::size_t s = scope_of(i), outer = 0;
    for (; s != 0; s = scopes_[s].parent) {
      if (scopes_[s].parameters.count(name) != 0 || scopes_[s].locals.count(name) != 0) return {s, name};
      if (scopes_[s].assigned.count(name) != 0) outer = s;
    }
    return {globals_.count(name) != 0 ? 0 : outer, name};
  }
  bool is_parameter(const Variable& variable) const {
    return scopes_[variable.first].parameters.count(variable.second) != 0;
  }

  // the only value of a name at token i, where every way there assigns it
  std::optional<std::size_t> value(std::size_t i) const {
    const Variable name = variable(i);
    const auto found = assigned_.find(name);
    if (found == assigned_.end() || is_parameter(name)) return {};
    const Assigned& assigned = found->second;
    if (assigned.targets.size() != 1 || !assigned.computed.empty()) return {};
    const Block& block = blocks_[assigned.block];
    if (assigned.token > i || i > block.last) return {};
    return assigned.targets[0];
  }

  // statements in the order of the text
  void follow() {
    std::size_t depth = 0;       // of brackets
    std::vector<bool> routines;  // of the blocks around: whether each is one
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
        flow_.begin(std::string(text_.at(i + 1)), word != "def");
        break_order();
        routines.push_back(true);
        const bool closed = text_.is(i + 2, '(') && text_.tokens[i + 2].partner != 0;
        i = closed ? text_.tokens[i + 2].partner : i + 1;
      } else if (word == "if" || word == "while" || word == "for") {
        flow_.open(word != "if");
        routines.push_back(false);
      } else if (word == "elif" || word == "else") {
        flow_.branch();
      } else if (word == "end") {
        const bool routine = !routines.empty() && routines.back();
        routine ? flow_.end() : flow_.close();
        if (!routines.empty()) routines.pop_back();
      } else if (word == "break" || word == "continue") {
        flow_.leave_loop();
      } else if (word == "return" || word == "halt") {
        flow_.leave_routine();
      } else if (word.starts_with('$')) {  // $ 3 "Waypoint_1": a mark of the editor
        while (!text_.is_line_end(i + 1)) ++i;
      } else if (text_.is(i + 1, '(')) {
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
    const std::size_t k = behind_name(i);
    return text_.is(k, '=') || text_.is(k, '(');
  }

  // the token behind name[..].member
  std::size_t behind_name(std::size_t i) const {
    for (++i;;) {
      if (text_.is(i, '['))
        i = behind_brackets(text_, i, text_.tokens.size());
      else if (text_.is(i, '.') && text_.is_word(i + 1))
        i += 2;
      else
        return i;
    }
  }

  void call(std::size_t i, std::string_view word) {
    static const auto keywords = words_of("not and or xor elif return join kill run in");
    if (keywords.count(word) != 0 || (i > 0 && text_.is(i - 1, '.'))) return;  // a member of an object is no routine
    const std::string name(word);
    if (routines_.count(name) != 0) {
      flow_.call(name);
      break_order();
    } else if (word == "set_tcp") {
      flow_.set(ProgramState::tool, {set_tcp(i), {}, line(i)});
    } else if (is_move(word)) {
      move(i);
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
      const std::size_t sign = depth == 0 && text_.is_word(i) ? behind_name(i) : i + 1;
      if (changes_list(i)) assigned_[variable(i)].computed.push_back(i);
      const bool name = text_.is_word(i) && text_.is(sign, '=') && !text_.is(sign + 1, '=') && depth == 0;
      if (!name) {
        ++i;
        continue;
      }
      Assigned& assigned = assigned_[variable(i)];
      names_.insert(std::string(text_.at(i)));
      if (sign != i + 1) {  // an element or member
        assigned.computed.push_back(i);
        i = sign;
        continue;
      }
      std::size_t k = i + 2;
      if (is_pose(k) || text_.is(k, '[')) {
        if (std::optional<ProgramTarget> found = literal(k); found && (k >= text_.tokens.size() || ends(k))) {
          found->name = std::string(text_.at(i));
          assigned.targets.push_back(program_.targets.size());
          assigned.token = i;
          assigned.block = block_of_[i];
          variables_.resize(program_.targets.size() + 1);
          variables_.back() = {variable(i), i};
          program_.targets.push_back(std::move(*found));
          i = k;
          continue;
        }
      }
      assigned.computed.push_back(i);
      i += 2;
    }
  }

  // name.append(..), name[..].remove(..): a method of a list, other than those that only read
  bool changes_list(std::size_t i) const {
    static const auto readers = words_of("length slice shape capacity");
    if (!text_.is_word(i) || (i > 0 && text_.is(i - 1, '.'))) return false;
    std::size_t k = i + 1;
    while (text_.is(k, '[')) k = behind_brackets(text_, k, text_.tokens.size());
    return text_.is(k, '.') && text_.is_word(k + 1) && text_.is(k + 2, '(') && readers.count(text_.at(k + 1)) == 0;
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
      if (const auto target = value(k)) {
        found = program_.targets[*target];
        tools_.insert(*target);
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
    const std::string other = other_argument(i, close);
    for (int a = 0; a < (text_.at(i) == "movec" ? 2 : 1); ++a) {
      const std::size_t last = argument_end(first, close);
      ProgramStep step{{}, {}, "base", kind};
      step.point = point;
      if (!other.empty())
        step.unknown =
            message("line ", line(i), ", ", text_.at(i), "(.., ", other, "): what it does to targets is not known");
      target(i, first, last, step);
      first = last + 1;
    }
  }

  // the first argument of a move that it does not have; empty where there is none
  std::string other_argument(std::size_t i, std::size_t close) const {
    std::vector<std::string_view> names;
    for (const auto& [move, arguments] : urscript_move_arguments)
      if (move == text_.at(i))
        for (std::string_view rest = arguments; !rest.empty();) {
          const std::size_t end = (std::min)(rest.find(' '), rest.size());
          names.push_back(rest.substr(0, end));
          rest.remove_prefix((std::min)(end + 1, rest.size()));
        }
    std::size_t k = i + 2;
    for (int target = text_.at(i) == "movec" ? 2 : 1; target > 0 && k < close; --target) k = argument_end(k, close) + 1;
    for (std::size_t position = 0; k < close; ++position) {
      const std::size_t last = argument_end(k, close);
      while (k < last && text_.is_line_end(k)) ++k;
      const bool named = text_.is_word(k) && text_.is(k + 1, '=') && !text_.is(k + 2, '=');
      if (named ? std::find(names.begin(), names.end(), text_.at(k)) == names.end() : position >= names.size())
        return excerpt(text_, k, last);
      k = last + 1;
    }
    return {};
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
      for (std::size_t k = before; k < steps_.size() && end < last - 1; ++k) {
        if (!steps_[k].target) continue;
        const JointVector<6> near = joints_near(end + 1, argument_end(end + 1, last - 1));
        const auto [seed, added] = seeds_.try_emplace(*steps_[k].target, near);
        if (!near.allFinite() || (!added && !(seed->second.array() == near.array()).all()))
          steps_[k].unknown = message("line ", line(instruction), ": the joint values near it are not known");
      }
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
    const Variable name = variable(first);
    const auto assigned = assigned_.find(name);
    if (is_parameter(name)) return remark("a parameter");
    if (assigned == assigned_.end())
      return remark(names_.count(name.second) != 0 ? "not assigned in this routine" : "not assigned in this file");
    if (assigned->second.targets.empty()) return remark("computed, not a literal");
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
      if (const auto target = value(first)) out = program_.targets[*target].joints;
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
        const auto& [variable, token] = variables_[k];
        const auto partner = assigned_.find({variable.first, target.name.substr(0, target.name.size() - 1) + "q"});
        if (partner != assigned_.end() && partner->second.targets.size() == 1 && partner->second.computed.empty() &&
            blocks_[partner->second.block].first <= token && token <= blocks_[partner->second.block].last)
          target.joints = all[partner->second.targets[0]].joints;
      }
      index[k] = kept.size();
      const bool pose = target.kind == TargetKind::pose;
      if (changed_.count(k) != 0) continue;
      if (used[k] || (pose && tools_.count(k) == 0)) kept.push_back(std::move(target));
    }
    for (ProgramStep& step : steps_) {
      if (!step.target) continue;
      if (changed_.count(*step.target) != 0)
        step.target.reset();
      else
        step.target = index[*step.target];
    }
    program_.targets = std::move(kept);
  }

  std::vector<Block> blocks_{};
  std::vector<Scope> scopes_{};
  std::vector<std::size_t> block_of_{};  // of each token
  std::set<std::string, std::less<>> globals_{};
  std::map<Variable, Assigned> assigned_{};
  std::set<std::string> names_{};                              // of these variables
  std::vector<std::pair<Variable, std::size_t>> variables_{};  // of each target that is assigned, and its token
  std::set<std::size_t> changed_{};                            // targets that the program changes
  std::set<Variable> used_{};
  std::set<std::size_t> tools_{};
  std::map<std::size_t, JointVector<6>> seeds_{};
  std::set<std::string> routines_{};  // of this file
};

VERNIER_IMPL void read_urscript(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                                RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "#", .quotes = "\"'"});
  UrscriptReader(tokens, program, StatementTable(urscript_harmless, urscript_statements, assumed)).read();
}

}  // namespace vernier::detail
