// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/program_readers.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/rapid_statements.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"

namespace vernier::detail {

/// Reads the targets of a RAPID module. Line ends are no tokens here.
class RapidReader final : private StatementReader {
 public:
  RapidReader(const ProgramText& from, RobotProgram& to, const StatementTable& table,
              const std::vector<std::string>& assumed)
      : StatementReader(from, to, table) {
    for (const std::string& name : assumed) assumed_.insert(lower_case(name));
  }

  void read() {
    std::size_t i = find_module();
    program_.tools["tool0"] = program_.workobjects["wobj0"] = Isometry3::Identity();
    find_routines();
    while (i < text_.tokens.size()) i = statement(i);
    for (const Change& change : changes_) assigned_.insert(word(change.expression.first));
    for (const std::string& name : assigned_)  // frames that the program changes are not those that it states
      if (constant_names_.count(name) == 0 || variable_names_.count(name) != 0) unstated_.insert(name);
    for (const std::string& name : unstated_) {
      program_.tools.erase(name);
      program_.workobjects.erase(name);
    }
    for (const Move& move : moves_) use(move);
    for (const Change& change : changes_) changed(change);
    solve();
    use_targets(text_, steps_, std::vector<bool>(program_.targets.size(), true), program_);
  }

 private:
  struct Span {
    std::size_t first, second;
  };
  struct Move {
    std::size_t token = 0;  // none: the order of moves ends
    std::vector<Span> arguments{};
    std::string tool{}, workobject = "wobj0";
    std::size_t point = ProgramStep::no_point;
    std::string unknown{};   // why its targets are not corrected
    bool parameter = false;  // whether its target is a parameter of the routine
    bool moves = true;       // whether it is a move
    bool constants = true;   // whether it concerns targets that no statement can change
    std::size_t scope = 0;
  };
  struct Change {  // of a variable
    std::size_t line;
    Span expression;
    std::string variable;  // scoped
  };

  void break_order() override { moves_.push_back({}); }

  // the token behind the head of the module
  std::size_t find_module() {
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i) {
      if (word(i) != "module" || !text_.is_word(i + 1)) continue;
      const std::size_t k = behind_brackets(text_, i + 2, text_.tokens.size());
      const std::size_t line_end = text_.text.find_first_of("\r\n", text_.tokens[k - 1].end);
      program_.stamp_at = line_end == std::string_view::npos ? text_.text.size() : line_end + 1;
      if (text_.text.substr((std::min)(line_end, text_.text.size())).starts_with("\r\n")) ++program_.stamp_at;
      return k;
    }
    throw DataError(message(text_.name, ": no MODULE, so this is no RAPID program"));
  }

  // names of routines, and whether they may change their arguments
  void find_routines() {
    for (std::size_t i = 0; i + 2 < text_.tokens.size(); ++i) {
      const std::string kind = word(i);
      if (kind != "proc" && kind != "func" && kind != "trap") continue;
      const std::size_t name = kind == "func" ? i + 2 : i + 1, end = behind_parameters(name);
      bool changes = false;
      for (i = name; i + 1 < end; ++i) changes = changes || word(i) == "inout" || word(i) == "var" || word(i) == "pers";
      routines_[word(name)] = changes;
    }
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i)
      if (has_routine(word(i)))
        for (std::size_t k = i, end = until(i, ';'); k < end; ++k)
          if (text_.tokens[k].kind == ProgramToken::Kind::text) called_by_text_.insert(quoted(k));
  }

  // MoveJSync, MoveLSync and MoveCSync, whose last argument names a routine
  static bool has_routine(std::string_view move) { return move.starts_with("move") && move.ends_with("sync"); }

  // a text without its quotes, in lower case
  std::string quoted(std::size_t i) const {
    std::string out = lower_case(text_.at(i).substr(1));
    if (out.ends_with('"')) out.pop_back();
    return out;
  }

  // the token behind the name of a routine and its parameters
  std::size_t behind_parameters(std::size_t name) const {
    const bool closed = text_.is(name + 1, '(') && text_.tokens[name + 1].partner != 0;
    return closed ? text_.tokens[name + 1].partner + 1 : (std::min)(name + 1, text_.tokens.size());
  }

  std::size_t line(std::size_t i) const { return text_.tokens[i].line; }

  // the token of the sign, or of one of the words, at i or behind it; at most the next ;
  std::size_t until(std::size_t i, char sign, std::initializer_list<std::string_view> words = {}) const {
    for (; i + 1 < text_.tokens.size() && !text_.is(i, ';'); ++i) {
      if (text_.is(i, sign) && !text_.is(i + 1, '=')) return i;
      if (std::find(words.begin(), words.end(), word(i)) != words.end()) return i;
    }
    return i;
  }

  std::size_t statement(std::size_t i) {
    if (text_.is(i, ';') || i + 1 == text_.tokens.size()) return i + 1;
    const std::string name = word(i);
    if (const std::size_t next = structure(i, name); next != i) return next;
    const std::size_t end = until(i, ';');
    if (name == "const" || name == "pers" || name == "var" || name == "alias") {
      declaration(i);
      calls(i + 3, end);
      return end;
    }
    if (name.empty()) {  // %"routine"% and what is no statement
      other(i, end, {});
      return end;
    }
    std::size_t k = behind_brace(i + 1);
    while (text_.is(k, '.') && text_.is_word(k + 1)) k = behind_brace(k + 2);
    if (text_.is(k, ':') && text_.is(k + 1, '=')) {
      assignment(i, k, end);
      return end;
    }
    if (text_.is(i + 1, ':')) {
      flow_.label(name);
      return i + 2;
    }
    const bool own = routines_.count(name) != 0;  // a routine of this file, whatever the table says
    if (is_move(name) && !own && !text_.is(i + 1, '(') && !text_.is(i + 1, '.')) return move(i);
    other(i, end, name);
    return end;
  }

  // routines, blocks and jumps; i itself where it is none of them
  std::size_t structure(std::size_t i, const std::string& name) {
    const auto condition = [&](std::size_t end) {
      calls(i + 1, end);
      return end + 1;
    };
    if (name == "local" || name == "task" || name == "endmodule") return i + 1;
    if (name == "module") return behind_brackets(text_, i + 2, text_.tokens.size());
    if (name == "record") {
      while (i + 1 < text_.tokens.size() && word(i) != "endrecord") ++i;
      return i + 1;
    }
    if (name == "proc" || name == "func" || name == "trap") return routine(i, name);
    if (name == "endproc" || name == "endfunc" || name == "endtrap") {
      flow_.end();
      end_scope();
      in_main_ = false;
      return i + 1;
    }
    if (name == "error" || name == "undo" || name == "backward") {  // a handler may run whatever happened before
      flow_.end();
      flow_.begin(message(name, " of line ", line(i)), true);
      in_main_ = false;
      break_order();
      return behind_brackets(text_, i + 1, text_.tokens.size());
    }
    if (name == "if") {
      const std::size_t k = behind_condition(i + 1);
      flow_.open(false);
      calls(i + 1, k);
      if (word(k) == "then") return k + 1;
      std::size_t end = until(k, ';');
      if (word(k) == "if")
        other(k, end, {});
      else
        end = statement(k);
      flow_.close();
      return end;
    }
    if (name == "elseif") {
      flow_.branch();
      return condition(until(i, ';', {"then"}));
    }
    if (name == "else") {
      flow_.branch();
      return i + 1;
    }
    if (name == "for" || name == "while") {
      flow_.open(true);
      return condition(until(i, ';', {"do"}));
    }
    if (name == "test") {
      flow_.open(false);
      const std::size_t end = until(i, ';', {"case", "default", "endtest"});
      calls(i + 1, end);
      return end;
    }
    if (name == "case" || name == "default") {
      flow_.branch();
      return condition(until(i, ':'));
    }
    if (name == "endif" || name == "endfor" || name == "endwhile" || name == "endtest") {
      flow_.close();
      return i + 1;
    }
    if (name == "goto") {
      flow_.jump(word(i + 1));
      return i + 2;
    }
    if (name == "return" || name == "raise" || name == "retry" || name == "trynext" || name == "exit" ||
        name == "raisetouser" || name == "errraise") {
      const std::size_t end = until(i, ';');
      calls(i + 1, end);
      flow_.leave_routine();
      return end;
    }
    if (name == "exitcycle") {  // main begins anew, with all settings
      if (in_main_)
        flow_.jump(main_begins);
      else
        flow_.restart("main");
      return until(i, ';');
    }
    return i;
  }

  // PROC name(type parameter, ..)
  std::size_t routine(std::size_t i, const std::string& kind) {
    const std::size_t name = (std::min)(kind == "func" ? i + 2 : i + 1, text_.tokens.size() - 1);
    flow_.begin(word(name), kind == "trap" || called_by_text_.count(word(name)) != 0);
    in_main_ = word(name) == "main";
    if (in_main_) flow_.label(main_begins);
    break_order();
    const std::size_t end = behind_parameters(name);
    std::set<std::string> parameters;
    for (std::size_t k = name + 1; k + 1 < end; ++k)
      if (text_.is_word(k) && !text_.is_word(k + 1)) parameters.insert(word(k));
    begin_scope(parameters);
    return end;
  }

  // the token behind the condition of IF: THEN, or the instruction that it guards
  std::size_t behind_condition(std::size_t i) const {
    static const auto operators = words_of("and or xor not div mod");
    bool operand = false;
    while (i + 1 < text_.tokens.size() && !text_.is(i, ';')) {
      const std::string name = word(i);
      const bool named = !name.empty() && operators.count(name) == 0;
      if (name == "then" || (operand && (named || text_.is(i, '%')))) return i;
      const std::size_t next = behind_brackets(text_, i, text_.tokens.size());
      operand = next > i || named || text_.tokens[i].kind == ProgramToken::Kind::number ||
                text_.tokens[i].kind == ProgramToken::Kind::text;
      i = (std::max)(next, i + 1);
    }
    return (std::min)(i, text_.tokens.size() - 1);
  }

  std::size_t behind_brace(std::size_t i) const {
    return text_.is(i, '{') ? behind_brackets(text_, i, text_.tokens.size()) : i;
  }

  // name := value, its sign at k
  void assignment(std::size_t i, std::size_t k, std::size_t end) {
    const std::string name = word(i);
    const std::size_t targets = program_.targets.size(), refused = refused_.size();
    const bool whole = k == i + 1 && text_.is(k + 2, '[') && literal(k + 2, name) == end;
    assigned_.insert(name);
    if (!whole || program_.targets.size() == targets || refused_.size() != refused)
      changes_.push_back({line(i), {i, end}, scoped(name, scope_)});
    calls(k + 2, end);
  }

  // an instruction that is no move, or a call
  void other(std::size_t i, std::size_t end, const std::string& name) {
    const std::string statement = excerpt(text_, i, end);
    std::string why;
    if (routines_.count(name) != 0) {
      calls(i + 1, end);
      flow_.call(name);
      break_order();
      why = message("line ", line(i), ", ", statement, ": what the routine does to it is not known");
      if (routines_.at(name)) change(i + 1, end);
    } else {
      const std::string option = text_.is(i + 1, '\\') ? word(i + 2) : text_.is(i + 1, ';') ? "" : " ";
      const StatementClass kind = apply(line(i), name, option, statement);
      calls(i + 1, end);
      if (name == "connect" && routines_.count(word(until(i, ';', {"with"}) + 1)) == 0) unknown(line(i), statement);
      if (kind == StatementClass::own || kind == StatementClass::unknown)
        why = message("line ", line(i), ", ", statement, ": what it does to targets is not known");
      if (kind == StatementClass::own) break_order();
      static const auto outputs = words_of(rapid_outputs);
      if (kind == StatementClass::harmless && outputs.count(name) == 0) {
        change(i + 1, end);
        arguments(i, end, message("line ", line(i), ", ", statement, ": the instruction may change it"), false);
      }
    }
    if (!why.empty()) arguments(i, end, why);
  }

  // frames that a statement is given may be changed by it
  void change(std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      if (text_.is_word(k)) assigned_.insert(word(k));
  }

  // targets in the arguments of what is no move that is corrected
  void arguments(std::size_t i, std::size_t end, const std::string& why, bool constants = true) {
    Move found;
    found.token = i;
    found.moves = false;
    found.scope = scope_;
    found.constants = constants;
    found.unknown = why;
    for (std::size_t k = i + 1; k < end;) {
      const std::size_t first = k;
      k = text_.is(k, '[') ? literal(k, {}) : k + 1;
      found.arguments.push_back({first, k});
    }
    moves_.push_back(std::move(found));
  }

  // calls of functions in an expression
  void calls(std::size_t first, std::size_t last) {
    static const auto operators = words_of("and or xor not div mod");
    for (std::size_t k = first; k < last; ++k) {
      if (!text_.is_word(k) || !text_.is(k + 1, '(')) continue;
      const std::string name = word(k);
      if (operators.count(name) != 0) continue;
      if (const auto routine = routines_.find(name); routine != routines_.end()) {
        flow_.call(name);
        const std::size_t end = (std::min)(behind_brackets(text_, k + 1, last), last);
        if (!routine->second) continue;
        change(k + 2, end);
        arguments(k, end, message("line ", line(k), ", ", excerpt(text_, k, end), ": the routine may change it"));
      } else if (statements_.find(name).kind != StatementClass::harmless) {
        unknown(line(k), excerpt(text_, k, (std::min)(behind_brackets(text_, k + 1, last), last)));
      } else {
        written(k, (std::min)(behind_brackets(text_, k + 1, last), last));
      }
    }
  }

  // what the function at token i writes of its arguments
  void written(std::size_t i, std::size_t end) {
    static const auto options = words_of(rapid_writing_options);
    const std::string name = word(i), why = message("line ", line(i), ", ", excerpt(text_, i, end));
    const auto* const row =
        std::find_if(std::begin(rapid_writers), std::end(rapid_writers), [&](const auto& r) { return r.name == name; });
    const std::size_t first = row == std::end(rapid_writers) ? static_cast<std::size_t>(-1) : row->first;
    std::size_t number = 1, depth = 0;
    bool any = false;  // whether this argument is more than an option
    std::string option;
    for (std::size_t k = i + 2; k + 1 < end; ++k) {
      if (text_.is(k, '(') || text_.is(k, '[') || text_.is(k, '{')) ++depth;
      if ((text_.is(k, ')') || text_.is(k, ']') || text_.is(k, '}')) && depth > 0) --depth;
      if (depth == 0 && text_.is(k, ',')) {
        number += any ? 1 : 0;
        any = false;
        option.clear();
      } else if (depth == 0 && text_.is(k, '\\')) {
        option = word(++k);
      } else {
        any = any || option.empty();
        if (!text_.is_word(k) || !(option.empty() ? number >= first : options.count(option) != 0)) continue;
        change(k, k + 1);
        arguments(k - 1, k + 1, why + ": the function may change it", false);
      }
    }
  }

  static bool is_move(std::string_view name) {
    static const auto names = words_of(std::string(rapid_joint_moves) + ' ' + std::string(rapid_linear_moves) + ' ' +
                                       std::string(rapid_circular_moves));
    return names.count(name) != 0;
  }

  // CONST robtarget p10:=[..]; and the like
  std::size_t declaration(std::size_t i) {
    const std::string type = word(i + 1);
    if (!text_.is_word(i + 2)) return i + 1;
    const std::string name = word(i + 2);
    declare(name);
    if (word(i) == "const") {
      constants_.insert(scoped(name, scope_));
      constant_names_.insert(name);
    } else {
      variable_names_.insert(name);
    }
    std::size_t k = i + 3;
    if (text_.is(k, '{')) k = behind_brackets(text_, k, text_.tokens.size());
    const bool value = text_.is(k, ':') && text_.is(k + 1, '=');
    if (value) k += 2;
    const bool brackets = value && text_.is(k, '[');
    const std::size_t line = text_.tokens[i].line;
    if (type == "robtarget" || type == "jointtarget") {
      names_.try_emplace(scoped(name, scope_));
      if (brackets) {
        const std::size_t before = program_.targets.size() + refused_.size();
        const std::size_t end = literal(k, name);
        if (program_.targets.size() + refused_.size() == before)
          program_.uncorrected.push_back({line, excerpt(text_, i + 1, end), "no literal of this type"});
        return end;
      }
      if (value) {
        std::size_t end = k;
        while (end + 1 < text_.tokens.size() && !text_.is(end, ';')) ++end;
        program_.uncorrected.push_back({line, excerpt(text_, i + 1, end), "computed, not a literal"});
        return end;
      }
      return k;
    }
    if (type == "extjoint") unused_axes_.erase(name);
    if (!brackets) {
      if (type == "tooldata" || type == "wobjdata") unstated_.insert(name);
      return k;
    }
    if (type == "tooldata" || type == "wobjdata" || type == "extjoint" || type == "confdata") {
      const BracketValue data = read_brackets(text_, k, ';');
      if ((type == "tooldata" && !tool(name, data)) || (type == "wobjdata" && !workobject(name, data)))
        unstated_.insert(name);
      if (type == "extjoint" && unused(data)) unused_axes_.insert(name);
      return k;
    }
    read_brackets(text_, k, ';');  // of another type: never a target
    return k;
  }

  bool flag(const BracketValue& value, std::string_view expected) const {
    return !value.group && text_.is_word(value.token) && lower_case(text_.at(value.token)) == expected;
  }

  VERNIER_LOCAL static std::optional<Isometry3> frame(const BracketValue& pose) {
    if (!pose.group || pose.values.size() != 2 || !pose.values[0].numbers(3) || !pose.values[1].numbers(4)) return {};
    const auto& p = pose.values[0].values;
    const auto& q = pose.values[1].values;
    return frame_of_quaternion({*p[0].number, *p[1].number, *p[2].number},
                               {*q[0].number, *q[1].number, *q[2].number, *q[3].number});
  }

  // a tool that the robot holds: [TRUE,[[x,y,z],[q]],load]
  bool tool(const std::string& name, const BracketValue& data) {
    if (data.values.size() != 3 || !flag(data.values[0], "true")) return false;
    const auto found = frame(data.values[1]);
    if (found) state(program_.tools, name, *found);
    return found.has_value();
  }

  // a work object that stands still: [FALSE,TRUE,"",uframe,oframe]
  bool workobject(const std::string& name, const BracketValue& data) {
    if (data.values.size() != 5 || !flag(data.values[0], "false") || !flag(data.values[1], "true")) return false;
    const auto user = frame(data.values[3]), object = frame(data.values[4]);
    if (user && object) state(program_.workobjects, name, *user * *object);
    return user && object;
  }

  // of a name that is declared twice nobody knows which frame is meant
  void state(std::map<std::string, Isometry3>& frames, const std::string& name, const Isometry3& frame) {
    const auto [found, added] = frames.try_emplace(name, frame);
    if (!added && !found->second.isApprox(frame, 0)) unstated_.insert(name);
  }

  bool unused(const BracketValue& axes) const {
    if (!axes.group && text_.is_word(axes.token)) return unused_axes_.count(lower_case(text_.at(axes.token))) != 0;
    if (!axes.numbers(6)) return false;
    return std::all_of(axes.values.begin(), axes.values.end(), [](const auto& v) { return *v.number > 8.9e8; });
  }

  // [..] at token i: a target, an array of targets, or something else
  std::size_t literal(std::size_t i, const std::string& name) {
    const BracketValue value = read_brackets(text_, i, ';');
    collect(value, name);
    return i;
  }

  void collect(const BracketValue& value, const std::string& name) {
    const auto group = [](const BracketValue& v, std::size_t n) { return v.group && v.values.size() == n; };
    const auto single = [&](const BracketValue& v, std::size_t n) { return !v.group || group(v, n); };
    const auto& v = value.values;
    const bool pose =
        group(value, 4) && group(v[0], 3) && group(v[1], 4) && single(v[2], 4) && single(v[3], 6) && !v[2].number;
    const bool joints = group(value, 2) && group(v[0], 6) && single(v[1], 6);
    if (!pose && !joints) {
      for (const BracketValue& inner : v)
        if (inner.group) collect(inner, name);
      return;
    }
    const auto refuse = [&](const char* reason) {
      refused_.insert(value.token);
      program_.uncorrected.push_back(
          {value.line, excerpt(text_.text.substr(value.range.begin, value.range.end - value.range.begin)), reason});
    };
    if (!unused(v[pose ? 3 : 1])) return refuse("external axes are in use");
    ProgramTarget target;
    place(text_, value.range.begin, value.line, target);
    target.name = name;
    if (joints) {
      if (!v[0].numbers(6)) return refuse("joint values are no numbers");
      target.kind = TargetKind::joints;
      for (std::size_t j = 0; j < 6; ++j) {
        target.joints(static_cast<Index>(j)) = *v[0].values[j].number * std::numbers::pi / 180;
        target.numbers.push_back(v[0].values[j].range);
      }
    } else {
      if (!v[0].numbers(3) || !v[1].numbers(4)) return refuse("position or orientation are no numbers");
      BracketValue frame_value;
      frame_value.group = true;
      frame_value.values = {v[0], v[1]};
      const auto found = frame(frame_value);
      if (!found) return refuse("its orientation is no unit quaternion");
      target.pose = *found;
      for (std::size_t part = 0; part < 2; ++part)
        for (const BracketValue& number : v[part].values) target.numbers.push_back(number.range);
      if (!v[2].numbers(4)) return refuse("its configuration is no literal");
      for (const BracketValue& number : v[2].values) {
        if (!(std::abs(*number.number) < 1000)) return refuse("its configuration is out of range");
        target.configuration.push_back(static_cast<int>(std::lround(*number.number)));
        target.configuration_numbers.push_back(number.range);
      }
    }
    if (!name.empty())
      names_[scoped(name, scope_)].push_back(program_.targets.size());
    else
      inline_[value.token] = program_.targets.size();
    program_.targets.push_back(std::move(target));
  }

  // MoveL p10,v100,fine,tool0\WObj:=wobj1;
  std::size_t move(std::size_t i) {
    static const auto options = words_of(rapid_move_options);
    Move found;
    found.token = i;
    std::size_t k = i + 1, begin = k, depth = 0;
    std::size_t main_end = 0;
    const auto close = [&] {
      const std::size_t end = main_end == 0 ? k : main_end;
      if (end > begin) found.arguments.push_back({begin, end});
      main_end = 0;
      begin = k + 1;
    };
    while (k < text_.tokens.size() && !text_.is(k, ';')) {
      if (text_.is(k, '[') && depth == 0 && main_end == 0 && k == begin) {
        k = literal(k, {});
        continue;
      }
      if (text_.is(k, '(') || text_.is(k, '[') || text_.is(k, '{')) ++depth;
      if ((text_.is(k, ')') || text_.is(k, ']') || text_.is(k, '}')) && depth > 0) --depth;
      if (depth == 0 && text_.is(k, '\\')) {
        if (main_end == 0) main_end = k;
        const std::string option = word(k + 1);
        if (option == "wobj")
          found.workobject = text_.is(k + 2, ':') && text_.is(k + 3, '=') && text_.is_word(k + 4) ? word(k + 4) : "?";
        if (options.count(option) == 0)
          found.unknown = message("line ", line(i), ", ", excerpt(text_, i, i + 1), " \\", excerpt(text_, k + 1, k + 2),
                                  ": an option that is not known");
      }
      if (depth == 0 && text_.is(k, ',')) close();
      ++k;
    }
    if (k >= text_.tokens.size()) fail_at(text_, line(i), "an instruction is not ended by ;");
    close();
    found.tool = tool_of(word(i), found.arguments);
    if (is_parameter(found.tool)) found.tool.clear();
    if (is_parameter(found.workobject)) found.workobject = "?";
    for (std::size_t a = 0; a < (std::min)(targets_of(word(i)), found.arguments.size()); ++a)
      found.parameter = found.parameter || is_parameter(word(found.arguments[a].first));
    calls(i + 1, k);
    found.point = flow_.point();
    found.scope = scope_;
    const bool followed = !has_routine(word(i)) || is_followed(found);
    moves_.push_back(std::move(found));
    if (!followed) unknown(line(i), excerpt(text_, i, k));
    return k;
  }

  // whether the routine that a move calls is of this file, or harmless
  bool is_followed(const Move& move) const {
    if (move.arguments.size() < targets_of(word(move.token)) + 4) return false;
    const Span at = move.arguments.back();
    if (at.second != at.first + 1 || text_.tokens[at.first].kind != ProgramToken::Kind::text) return false;
    return routines_.count(quoted(at.first)) != 0 || assumed_.count(quoted(at.first)) != 0;
  }

  // A target that the program changes stays as it is.
  void changed(const Change& change) {
    const auto found = names_.find(change.variable);
    if (found == names_.end()) return;
    remark(change.line, excerpt(text_, change.expression.first, change.expression.second),
           "the program changes this target");
    for (const std::size_t k : found->second) program_.targets[k].numbers.clear();
  }

  static std::size_t targets_of(const std::string& move) {
    static const auto circular = words_of(rapid_circular_moves);
    return circular.count(move) != 0 ? 2 : 1;
  }

  // the tool is the last argument, or stands in front of a signal or routine
  std::string tool_of(const std::string& move, const std::vector<Span>& arguments) const {
    const std::size_t targets = targets_of(move);
    const bool signal = move.starts_with("move") && (move.ends_with("do") || move.ends_with("ao") ||
                                                     move.ends_with("go") || move.ends_with("sync"));
    if (arguments.size() <= targets) return {};
    const Span at = arguments[signal ? (std::min)(targets + 2, arguments.size() - 1) : arguments.size() - 1];
    return at.second == at.first + 1 ? word(at.first) : std::string();
  }

  void use(const Move& move) {
    static const auto joint_moves = words_of(rapid_joint_moves);
    if (move.token == 0) {
      add_step(steps_, {{}, {}, {}, TargetMove::unknown});
      return;
    }
    const std::string name = word(move.token);
    const TargetMove kind = !move.moves                    ? TargetMove::unknown
                            : joint_moves.count(name) != 0 ? TargetMove::joint
                                                           : TargetMove::linear;
    const std::size_t targets = move.moves ? targets_of(name) : move.arguments.size();
    for (std::size_t a = 0; a < (std::min)(targets, move.arguments.size()); ++a) {
      const auto [first, last] = move.arguments[a];
      ProgramStep step{{}, move.tool, move.moves ? move.workobject : "", kind};
      step.point = move.point;
      step.unknown = move.unknown;
      if (const auto found = inline_.find(first); found != inline_.end()) {
        step.target = found->second;
        add_step(steps_, step);
        continue;
      }
      const std::string variable = scoped(word(first), move.scope);
      const auto declared = names_.find(variable);
      const bool element = text_.is(first + 1, '{');
      const std::size_t end = !move.moves ? last : element ? behind_brackets(text_, first + 1, last) : first + 1;
      if (text_.is_word(first) && end == last && declared != names_.end() && !declared->second.empty() &&
          !move.parameter && (move.constants || constants_.count(variable) == 0)) {
        step.element = declared->second.size() > 1;
        for (const std::size_t k : declared->second) {
          step.target = k;
          add_step(steps_, step);
        }
        continue;
      }
      if (!move.moves) continue;
      add_step(steps_, {{}, {}, {}, kind});
      if (refused_.count(first) != 0) continue;
      remark(line(first < last ? first : move.token),
             excerpt(text_, move.token, move.token + 1) + " " + excerpt(text_, first, last),
             !text_.is_word(first) || end != last ? "computed, not a literal"
             : move.parameter                     ? "a parameter"
             : declared == names_.end()           ? "declared in another file"
                                                  : "a variable without literal value");
    }
  }

  std::map<std::string, std::vector<std::size_t>> names_{};  // targets of each variable, scoped
  std::map<std::size_t, std::size_t> inline_{};              // target by its first token
  std::set<std::string> unused_axes_{};
  std::set<std::string> assigned_{};  // variables
  std::vector<Move> moves_{};
  std::vector<Change> changes_{};
  std::set<std::string> constants_{};                          // scoped
  std::set<std::string> constant_names_{}, variable_names_{};  // as they are declared
  std::set<std::string> unstated_{};                           // frames that are not known
  std::set<std::string> assumed_{};                            // harmless names that users state
  std::set<std::string, std::less<>> called_by_text_{};        // routines
  bool in_main_ = false;
  static constexpr const char* main_begins = "main begins";  // no label has blanks
  std::map<std::string, bool> routines_{};  // of this file, and whether they may change their arguments
  std::set<std::size_t> refused_{};         // first tokens of values that are no targets, and are listed
};

VERNIER_IMPL void read_rapid(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                             RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "!", .quotes = "\"", .lines = false});
  const StatementTable table(std::string(rapid_harmless) + ' ' + std::string(rapid_functions), rapid_statements,
                             assumed);
  RapidReader(tokens, program, table, assumed).read();
}

}  // namespace vernier::detail
