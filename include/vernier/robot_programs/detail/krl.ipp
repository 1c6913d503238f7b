// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/krl_statements.hpp"
#include "vernier/robot_programs/detail/program_readers.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"

namespace vernier::detail {

/// Reads the targets of a KRL program or data list.
class KrlReader final : private StatementReader {
 public:
  KrlReader(const ProgramText& from, RobotProgram& to, const StatementTable& table)
      : StatementReader(from, to, table) {}

  void read() {
    find_head();
    find_routines();
    program_.tools["0"] = program_.workobjects["0"] = Isometry3::Identity();
    for (std::size_t i = 0; i < text_.tokens.size();) {
      std::size_t end = i;
      while (!text_.is_line_end(end)) ++end;
      if (end > i) line(i, end);
      i = end + 1;
    }
    for (const Use& use : uses_) resolve(use);
    flange_data();
    find_unset_frames();
    for (const auto& [tool, number] : changed_frames_) forget(tool ? program_.tools : program_.workobjects, number);
    drop_changed();
    solve();
    std::vector<bool> keep(program_.targets.size());
    for (std::size_t k = 0; k < keep.size(); ++k) keep[k] = typed_.count(program_.targets[k].name) != 0;
    use_targets(text_, steps_, keep, program_);
  }

 private:
  struct Span {
    std::size_t first, second;
  };
  struct Frames {  // of one motion or spline, beside those of the program
    std::string tool{}, base{};
    std::string unknown{};
  };
  struct Use {
    Span argument{0, 0};  // empty: the order of moves ends
    std::size_t instruction = 0;
    TargetMove move = TargetMove::unknown;
    std::size_t point = ProgramStep::no_point;
    Frames frames{};
    bool moves = true;       // whether it is a move
    bool parameter = false;  // of its routine
    std::size_t scope = 0;
  };
  using FrameData = std::pair<bool, std::string>;  // whether of a tool; number, empty where it is computed
  struct Component {
    std::string name{};
    std::optional<double> number{};
    ByteRange range{0, 0};
    Span value{0, 0};
  };
  struct FlangeData {
    std::string tool{}, base{};
    bool external = false;
    std::size_t scope = 0;  // whose it is; 0: of a data list
  };

  std::size_t line_of(std::size_t i) const { return text_.tokens[i].line; }
  void break_order() override { uses_.push_back({}); }

  void find_head() {
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i) {
      const std::string head = word(i);
      if (head != "def" && head != "deffct" && head != "defdat") continue;
      while (!text_.is_line_end(i)) ++i;
      program_.stamp_at = text_.tokens[i].end;
      return;
    }
    throw DataError(message(text_.name, ": neither DEF nor DEFDAT, so this is no KRL program"));
  }

  // the name of a routine is the word in front of its parameters
  std::string routine_name(std::size_t i) const {
    while (!text_.is_line_end(i) && !text_.is(i + 1, '(')) ++i;
    return word(i);
  }

  // also names of data that is assigned or given to routines
  void find_routines() {
    static const auto operators = words_of(
        "and or exor not b_and b_or b_exor b_not if for then sec when while until to step switch case return prio bas");
    std::vector<std::pair<std::size_t, bool>> open;  // round brackets: where they end, whether of a call
    for (std::size_t i = 0; i < text_.tokens.size(); ++i) {
      if (const std::string head = word(i); head == "def" || head == "deffct") routines_.insert(routine_name(i));
      while (!open.empty() && open.back().first <= i) open.pop_back();
      if (text_.is(i, '(') && text_.tokens[i].partner != 0)
        open.emplace_back(text_.tokens[i].partner,
                          (!open.empty() && open.back().second) ||
                              (i > 0 && text_.is_word(i - 1) && operators.count(word(i - 1)) == 0));
      if (!text_.is_word(i)) continue;
      const bool first = i == 0 || !text_.is(i - 1, '.');
      const std::string type = i > 0 ? word(i - 1) : std::string();
      const bool declared = type == "fdat" || type == "ldat";
      if ((!open.empty() && open.back().second) || (first && !declared && is_assigned(i)))
        changed_data_.insert(word(i));
    }
  }

  // name = , name[..].X = , ..
  bool is_assigned(std::size_t i) const {
    const std::size_t end = text_.tokens.size();
    std::size_t k = text_.is(i + 1, '[') ? behind_brackets(text_, i + 1, end) : i + 1;
    while (text_.is(k, '.') && text_.is_word(k + 1))
      k = text_.is(k + 2, '[') ? behind_brackets(text_, k + 2, end) : k + 2;
    return text_.is(k, '=') && !text_.is(k + 1, '=');
  }

  // the names of a routine's parameters, whose head is at token i
  std::set<std::string> parameters(std::size_t i) const {
    std::set<std::string> out;
    while (!text_.is_line_end(i) && !text_.is(i, '(')) ++i;
    for (; !text_.is_line_end(i) && !text_.is(i, ')'); ++i)
      if (text_.is_word(i) && !text_.is(i - 1, ':')) out.insert(word(i));
    return out;
  }

  void line(std::size_t i, std::size_t end) {
    constexpr int deepest = 20;  // instructions in one line
    if (nesting_ == deepest) return unknown(line_of(i), excerpt(text_, i, end));
    ++nesting_;
    instruction(i, end);
    --nesting_;
  }

  void instruction(std::size_t i, std::size_t end) {
    const std::size_t begin = i;
    while (i < end && (word(i) == "decl" || word(i) == "global" || word(i) == "const" || word(i) == "public")) ++i;
    if (i >= end) return;
    const std::string first = word(i);
    if (first == "def" || first == "deffct") {
      flow_.begin(routine_name(i), false);
      break_order();
      begin_scope(parameters(i));
      act_.clear();
      depth_ = 0;
      data_ = false;
      return;
    }
    if (first == "defdat") {
      data_ = true;
      end_scope();
      return;
    }
    if (first == "end" || first == "endfct" || first == "enddat") {
      if (first != "enddat") flow_.end();
      end_scope();
      return;
    }
    static constexpr std::array<std::string_view, 4> types{"e6pos", "pos", "e6axis", "axis"};
    if (std::find(types.begin(), types.end(), first) != types.end() && (text_.is_word(i + 1) || i + 1 == end)) {
      for (std::size_t k = i + 1; k < end;) {  // names, the last one perhaps with a value
        const std::string name = word(k);
        if (name.empty()) break;
        const bool of_file = scope_ == 0 || (i > begin && word(i - 1) == "global");
        of_file ? static_cast<void>(typed_.insert(name)) : declare(name);
        std::size_t next = k + 1;
        if (text_.is(next, '[')) next = behind_brackets(text_, next, end);
        if (text_.is(next, '=')) {
          value(name, k, next + 1, end);
          return;
        }
        k = text_.is(next, ',') ? next + 1 : end;
      }
      return;
    }
    if (first == "fdat" && text_.is_word(i + 1) && text_.is(i + 2, '=')) return fdat(word(i + 1), i + 3, end);
    if (first == "ldat" && text_.is_word(i + 1) && text_.is(i + 2, '=')) return ldat(i, end);
    if ((first == "interrupt" || first == "trigger") && !text_.is(i + 1, '(')) return at_any_time(i, end);
    if (i > begin || (data_ && text_.is_word(i) && text_.is_word(i + 1))) {  // a declaration
      for (std::size_t k = i + 1; k < end && text_.is_word(k);) {
        declare(word(k));
        k = text_.is(k + 1, '[') ? behind_brackets(text_, k + 1, end) : k + 1;
        k = text_.is(k, ',') ? k + 1 : end;
      }
      return calls(i + 1, end);
    }
    if (structure(i, end, first)) {
      act_.clear();
      return;
    }
    if (first == "bas" && text_.is(i + 1, '(')) return bas(i, end);
    if (move(i, end)) return;
    if (!text_.is_word(i)) return unknown(line_of(i), excerpt(text_, i, end));
    std::size_t k = i + 1;  // an assignment
    if (text_.is(k, '[')) k = behind_brackets(text_, k, end);
    const std::size_t behind_name = k;
    while (k < end && text_.is(k, '.') && text_.is_word(k + 1)) {
      k += 2;
      if (text_.is(k, '[')) k = behind_brackets(text_, k, end);
    }
    if (k >= end || !text_.is(k, '=') || text_.is(k + 1, '=')) return statement(i, end, first);
    calls(k + 1, end);
    if (first[0] == '$' && first != "$tool" && first != "$base")
      apply(line_of(i), first, option(k + 1), excerpt(text_, i, end));
    else if (k != behind_name)
      component(first, i, end);
    else
      value(first, i, k + 1, end);
  }

  // the value of a system variable as an option of its statement: #NAME
  std::string option(std::size_t i) const { return text_.is(i, '#') ? "#" + word(i + 1) : " "; }

  // a call, or another statement
  void statement(std::size_t i, std::size_t end, const std::string& first) {
    static const auto words = words_of(krl_words), alone = words_of(krl_words_alone);
    const std::string what = excerpt(text_, i, end);
    calls(i + 1, end);
    const bool harmless = (words.count(first) != 0 && i + 1 < end && (text_.is_word(i + 1) || text_.is(i + 1, ':'))) ||
                          (alone.count(first) != 0 && i + 1 == end);
    if (harmless) {
      act_.clear();
      return;
    }
    if (routines_.count(first) != 0) {
      flow_.call(first);
      break_order();
      arguments(i, end, message("line ", line_of(i), ", ", what, ": the routine may change it"));
    } else {
      const StatementClass kind = apply(line_of(i), first, " ", what);
      if (kind == StatementClass::unknown)
        arguments(i, end, message("line ", line_of(i), ", ", what, ": what it does to targets is not known"));
      else if (text_.is(i + 1, '('))
        arguments(i, end, message("line ", line_of(i), ", ", what, ": the routine may change it"));
    }
    act_.clear();
  }

  // targets that are passed to a routine
  void arguments(std::size_t i, std::size_t end, const std::string& why) {
    for (std::size_t k = i + 1; k < end; ++k) {
      const std::string name = word(k);
      if (name == "tool_data" || name == "base_data") changed_frames_.insert({name == "tool_data", index(k + 1)});
      if (name == "$tool" || name == "$base")
        flow_.set(name == "$tool" ? ProgramState::tool : ProgramState::workobject, {"?", {}, line_of(k)});
    }
    given(i, i + 1, end, why);
  }

  // calls of functions in an expression
  void calls(std::size_t first, std::size_t last) {
    static const auto operators = words_of(
                          "and or exor not b_and b_or b_exor b_not for then sec when while until to step case prio"),
                      inputs = words_of(krl_inputs);
    for (std::size_t k = first; k < last; ++k) {
      if (!text_.is_word(k) || !text_.is(k + 1, '(')) continue;
      const std::string name = word(k);
      if (operators.count(name) != 0) continue;
      const std::size_t end = behind_brackets(text_, k + 1, last);
      if (routines_.count(name) != 0) {
        flow_.call(name);
        act_.clear();
        arguments(k, end, message("line ", line_of(k), ", ", excerpt(text_, k, end), ": the routine may change it"));
      } else if (statements_.find(name).kind != StatementClass::harmless) {
        unknown(line_of(k), excerpt(text_, k, end));
      } else if (std::any_of(inputs.begin(), inputs.end(),
                             [&](const auto& begin) { return name.starts_with(begin); })) {
        arguments(k, end, message("line ", line_of(k), ", ", excerpt(text_, k, end), ": the function may change it"));
      }
    }
  }

  // INTERRUPT DECL 3 WHEN .. DO routine(), TRIGGER WHEN .. DO ..
  void at_any_time(std::size_t i, std::size_t end) {
    std::size_t k = i;
    while (k < end && word(k) != "do") ++k;
    calls(i + 1, k);
    std::size_t stop = k;
    while (stop < end && word(stop) != "prio") ++stop;
    if (k + 1 >= stop) return;
    flow_.begin(message("line ", line_of(i)), true);
    line(k + 1, stop);
    flow_.end();
  }

  // blocks and jumps
  bool structure(std::size_t i, std::size_t end, const std::string& first) {
    if (text_.is_word(i) && text_.is(i + 1, ':') && i + 2 == end) {
      flow_.label(first);
      return true;
    }
    if (text_.is(i + 1, '=') && i + 1 < end) return false;
    static const auto conditions = words_of("if while until switch case for return");
    if (text_.is(i + 1, '(') && conditions.count(first) == 0) return false;  // a routine of another file
    static const auto loops = words_of("for while loop repeat"), blocks = words_of("if switch"),
                      ends = words_of("endif endfor endwhile endloop until endswitch"),
                      branches = words_of("else case default");
    const bool opens = loops.count(first) != 0 || blocks.count(first) != 0;
    if (opens) {
      flow_.open(loops.count(first) != 0);
      ++depth_;
    } else if (branches.count(first) != 0) {
      flow_.branch();
    } else if (ends.count(first) != 0) {
      if (first == "until") calls(i + 1, end);
      flow_.close();
      depth_ -= depth_ > 0 ? 1 : 0;
      return true;
    } else if (first == "goto") {
      flow_.jump(word(i + 1));
    } else if (first == "exit") {
      flow_.leave_loop();
    } else if (first == "return" || first == "resume") {
      flow_.leave_routine();
    } else if (first == "spline" || first == "ptp_spline") {
      spline_ = with(i, end);
    } else if (first == "endspline") {
      spline_ = {};
    } else if (first != "continue") {
      return false;
    }
    calls(i + 1, end);
    std::size_t then = i;
    while (then < end && word(then) != "then") ++then;
    if (then + 1 < end) line(then + 1, end);
    return true;
  }

  // name.X = value, at tokens from i to end
  void component(const std::string& name, std::size_t i, std::size_t end) {
    if (name == "$tool")
      flow_.set(ProgramState::tool, {"?", {}, line_of(i)});
    else if (name == "$base")
      flow_.set(ProgramState::workobject, {"?", {}, line_of(i)});
    else if (name == "tool_data" || name == "base_data")
      changed_frames_.insert({name == "tool_data", index(i + 1)});
    else
      changed(name, i, end);
    if (name == "fdat_act" || name == "ldat_act") act_.clear();
  }

  // A routine's parameters are no variables of the file.
  void changed(const std::string& name, std::size_t i, std::size_t end) {
    if (is_parameter(name)) return;
    changes_.push_back({scoped(name, scope_), {i, end}});
    changed_.insert(scoped(name, scope_));
  }

  // name = value, at tokens from i to end
  void value(const std::string& name, std::size_t at, std::size_t i, std::size_t end) {
    const bool tool = name == "$tool" || name == "tool_data", base = name == "$base" || name == "base_data";
    if (name == "fdat_act" || name == "ldat_act") {
      act_[name] = i + 1 == end ? word(i) : std::string();
      if (name == "fdat_act" && text_.is(i, '{')) {
        fdat(name, i, end);
        act_[name] = name;
      }
    } else if (name == "$tool" || name == "$base") {
      flow_.set(tool ? ProgramState::tool : ProgramState::workobject, {frame(tool, at, i, end), {}, line_of(at)});
    } else if (tool || base) {
      frame_data(tool, index(at + 1), at, i, end);
    } else if (!text_.is(i, '{') || behind_brackets(text_, i, end) != end) {
      changed(name, at, end);
    } else if (is_parameter(name)) {
      remark(line_of(at), excerpt(text_, at, end), "a parameter");
    } else {
      const std::size_t before = program_.targets.size();
      target(name, i, end);
      for (std::size_t k = before; k < program_.targets.size(); ++k) names_[scoped(name, scope_)].push_back(k);
    }
  }

  // TOOL_DATA[n] = {..}, at tokens from i to end. One that is not always set, or to several values, is not known.
  void frame_data(bool tool, const std::string& number, std::size_t at, std::size_t i, std::size_t end) {
    auto& frames = tool ? program_.tools : program_.workobjects;
    const auto parts = text_.is(i, '{') ? components(i, end) : std::vector<Component>{};
    const std::optional<Isometry3> frame = i == end ? frame_of(parts) : std::nullopt;
    const auto stated = frames.find(number);
    if (!frame || number.empty() || depth_ > 0 || (stated != frames.end() && !stated->second.isApprox(*frame, 0))) {
      changed_frames_.insert({tool, number});
      return made_of(at, i, end);
    }
    frames[number] = *frame;
    if (data_)
      data_frames_.insert({tool, number});
    else
      flow_.set_data(data_name({tool, number}), {"stated", {}, line_of(i - 1)});
  }

  // With other numbers of the targets at tokens from i to end, a frame would be another one.
  void made_of(std::size_t at, std::size_t i, std::size_t end) {
    given(at, i, end, message("line ", line_of(at), ", ", excerpt(text_, at, end), ": a frame is made of it"));
  }

  // targets at tokens from i to end, which stay as they are
  void given(std::size_t at, std::size_t i, std::size_t end, const std::string& why) {
    for (; i < end; ++i)
      if (text_.is_word(i) && !is_parameter(word(i)))
        uses_.push_back(
            {{i, i + 1}, at, TargetMove::unknown, ProgramStep::no_point, {{}, {}, why}, false, false, scope_});
  }

  static std::string data_name(const FrameData& data) { return (data.first ? "tool " : "base ") + data.second; }

  // TOOL_DATA[n] that a program sets hold where every way to a use has set them.
  void find_unset_frames() {
    constexpr std::size_t most = 512;  // of both
    std::map<FrameData, std::vector<std::size_t>> uses;
    for (const auto& [data, point] : used_frames_)
      if ((data.first ? program_.tools : program_.workobjects).count(data.second) != 0 && data.second != "0" &&
          data_frames_.count(data) == 0 && changed_frames_.count(data) == 0)
        uses[data].push_back(point);
    if (uses.size() > most) {
      for (const auto& use : uses) changed_frames_.insert(use.first);
      return;
    }
    for (auto use = uses.begin(); use != uses.end();) {
      std::vector<std::string> names;
      const auto first = use;
      for (; use != uses.end() && names.size() < ProgramFlow::most_data; ++use) names.push_back(data_name(use->first));
      const ProgramFlow flow = flow_.of_data(names);
      std::size_t slot = 0;
      for (auto one = first; one != use; ++one, ++slot)
        if (!std::all_of(one->second.begin(), one->second.end(),
                         [&](std::size_t point) { return point != ProgramStep::no_point && flow.is_set(point, slot); }))
          changed_frames_.insert(one->first);
    }
  }

  // Targets that the program changes stay as they are.
  void drop_changed() {
    std::vector<bool> dropped(program_.targets.size(), false);
    for (const auto& [name, change] : changes_) {
      const auto named = names_.find(name);
      if (named == names_.end()) continue;
      remark(line_of(change.first), excerpt(text_, change.first, change.second), "the program changes this target");
      for (const std::size_t k : named->second) dropped[k] = true;
    }
    drop(dropped);
  }

  // the name of a frame that is the value at tokens from i to end; ? where it is not known
  std::string frame(bool tool, std::size_t at, std::size_t i, std::size_t end) {
    if (text_.is(i, '{')) {
      const std::vector<Component> parts = components(i, end);
      const std::optional<Isometry3> frame = i == end ? frame_of(parts) : std::nullopt;
      return frame ? named_frame(tool ? ProgramState::tool : ProgramState::workobject,
                                 message(text_.at(at), " of line ", line_of(at)), *frame)
                   : "?";
    }
    const std::string source = word(i);
    if (source == "$nullframe" && i + 1 == end) return "0";
    if (source != (tool ? "tool_data" : "base_data") || behind_brackets(text_, i + 1, end) != end) {
      made_of(at, i, end);
      return "?";
    }
    return numbered(tool, index(i + 1));
  }

  std::string numbered(bool tool, const std::string& number) {
    if (!number.empty()) used_frames_.push_back({{tool, number}, flow_.point()});
    return number.empty() ? "?" : number;
  }

  // .. WITH $TOOL={..}, $VEL.CP=1
  Frames with(std::size_t i, std::size_t end) {
    Frames out = spline_;
    while (i < end && word(i) != "with") ++i;
    while (i + 1 < end) {
      const std::size_t name = i + 1;
      std::size_t k = name + 1;
      if (text_.is(k, '[')) k = behind_brackets(text_, k, end);
      const bool part = text_.is(k, '.');
      while (k < end && !text_.is(k, '=')) ++k;
      i = k;
      while (i < end && !text_.is(i, ',') && !is_blending(i))
        i = text_.is(i, '{') || text_.is(i, '(') || text_.is(i, '[') ? behind_brackets(text_, i, end) : i + 1;
      const bool tool = word(name) == "$tool";
      if (tool || word(name) == "$base") {
        (tool ? out.tool : out.base) = part || k + 1 >= i ? "?" : frame(tool, name, k + 1, i);
        continue;
      }
      const StatementClass kind = statements_.find(word(name), option(k + 1)).kind;
      if (kind != StatementClass::harmless && kind != StatementClass::ends)
        out.unknown = message("line ", line_of(name), ", WITH ", excerpt(text_, name, i),
                              ": what it does to targets is not known");
      if (i < end && !text_.is(i, ',')) break;
    }
    return out;
  }

  // Frames that the program changes are not those that it states: of one number, or, without one, of all.
  static void forget(std::map<std::string, Isometry3>& frames, const std::string& number) {
    std::erase_if(frames, [&](const auto& frame) {
      return number.empty() ? frame.first.find_first_not_of("0123456789") == std::string::npos && frame.first != "0"
                            : frame.first == number;
    });
  }

  // [n]
  std::string index(std::size_t i) const {
    if (!text_.is(i, '[') || !text_.is(i + 2, ']') || text_.tokens[i + 1].kind != ProgramToken::Kind::number) return {};
    return std::string(text_.at(i + 1));
  }

  // BAS(#TOOL,n), BAS(#FRAMES), ..
  void bas(std::size_t i, std::size_t end) {
    const std::string command = text_.is(i + 2, '#') ? word(i + 3) : std::string();
    const auto set = [&](ProgramState state, const std::string& name) { flow_.set(state, {name, {}, line_of(i)}); };
    const bool argument = text_.is(i + 4, ',');
    if ((command == "tool" || command == "base") && argument) {
      const bool tool = command == "tool";
      const bool number = text_.tokens[i + 5].kind == ProgramToken::Kind::number && text_.is(i + 6, ')');
      set(tool ? ProgramState::tool : ProgramState::workobject,
          number ? numbered(tool, std::string(text_.at(i + 5))) : "?");
    } else if (command == "initmov") {
      set(ProgramState::tool, {});
      set(ProgramState::workobject, {});
    } else if (command == "ex_base") {
      set(ProgramState::workobject, "?");
    } else if (command == "frames" || command == "ptp_params" || command == "cp_params" || command == "cp_dat") {
      const auto data = flange_data_.find(act_["fdat_act"]);
      const bool known = data != flange_data_.end() && !data->second.external && here(data->second.scope);
      if (command != "cp_dat") {
        const auto number = [&](bool tool) {
          const std::string name = known ? (tool ? data->second.tool : data->second.base) : "";
          return name.empty() || name == "?" ? "?" : numbered(tool, name);
        };
        set(ProgramState::tool, number(true));
        set(ProgramState::workobject, number(false));
      }
      if (command.starts_with("cp_")) {
        const auto kept = kept_orientation_.find(act_["ldat_act"]);
        if (kept != kept_orientation_.end() && here(kept->second))
          set(ProgramState::orientation, {});
        else if (statements_.find("bas").kind != StatementClass::harmless)
          lose(ProgramState::orientation, line_of(i), excerpt(text_, i, end));
      }
    } else {
      apply(line_of(i), "bas", "#" + command, excerpt(text_, i, end));
    }
  }

  // Data of a routine are of no other one, those of a data list of all.
  bool here(std::size_t scope) const { return scope == 0 || scope == scope_; }

  // LDAT name={.., ORI_TYP #VAR}: whether linear moves with it reach their orientation
  void ldat(std::size_t i, std::size_t end) {
    std::size_t k = i + 3;
    bool kept = false;
    if (text_.is(k, '{'))
      for (const Component& part : components(k, end))
        if (part.name == "ori_typ") {
          const std::string type = option(part.value.first);
          kept = type == "#var" || type == "#joint";
          if (!kept)
            remark(line_of(i), excerpt(text_, i, i + 2), "linear moves with it need not reach their orientation");
        }
    const std::string name = word(i + 1);
    const bool again = !declared_ldat_.insert(name).second;
    if (kept && !again && k == end && changed_data_.count(name) == 0)
      kept_orientation_[name] = scope_;
    else
      kept_orientation_.erase(name);
  }

  void fdat(const std::string& name, std::size_t i, std::size_t end) {
    if (!text_.is(i, '{')) return;
    FlangeData data;
    data.scope = scope_;
    for (const Component& part : components(i, end)) {
      const std::string text = part.number ? message(static_cast<long long>(std::clamp(*part.number, -1e9, 1e9))) : "?";
      if (part.name == "tool_no") data.tool = text;
      if (part.name == "base_no") data.base = text;
      if (part.name == "ipo_frame") data.external = word(part.value.second - 1) == "tcp";
    }
    if (i != end) data.tool = data.base = "?";
    const bool act = name == "fdat_act";  // holds until the next statement
    const auto [found, added] = flange_data_.try_emplace(name, data);
    if (act) found->second = data;
    if (!act && (changed_data_.count(name) != 0 || !added)) found->second.tool = found->second.base = "?";
  }

  // {type: NAME value, ..} at token i, which is then behind it
  std::vector<Component> components(std::size_t& i, std::size_t end) const {
    const std::size_t close = behind_brackets(text_, i, end);
    if (close <= i + 1 || !text_.is(close - 1, '}')) fail_at(text_, text_.tokens[i].line, "a brace { is not closed");
    std::size_t k = i + 1;
    i = close;
    if (text_.is_word(k) && text_.is(k + 1, ':')) k += 2;
    std::vector<Component> out;
    while (k < close - 1) {
      Component part;
      part.name = word(k);
      std::size_t first = k + 1;
      if (text_.is(first, '[')) first = behind_brackets(text_, first, close - 1);
      std::size_t last = first;
      while (last < close - 1 && !text_.is(last, ','))
        last = text_.is(last, '{') || text_.is(last, '(') || text_.is(last, '[')
                   ? behind_brackets(text_, last, close - 1)
                   : last + 1;
      part.value = {first, last};
      std::size_t next = first;
      if (first < last) part.number = signed_number(text_, first, next, part.range);
      if (next != last) part.number.reset();
      if (first + 1 == last && text_.tokens[first].kind == ProgramToken::Kind::text) based(first, part);
      out.push_back(std::move(part));
      k = last + 1;
    }
    return out;
  }

  // 'B101', 'HFF'
  void based(std::size_t i, Component& part) const {
    const std::string_view text = text_.at(i);
    if (text.size() < 4 || text.back() != '\'') return;
    const int base = text[1] == 'B' || text[1] == 'b' ? 2 : text[1] == 'H' || text[1] == 'h' ? 16 : 0;
    if (base == 0) return;
    unsigned number = 0;
    const char* end = text.data() + text.size() - 1;
    const auto [stop, error] = std::from_chars(text.data() + 2, end, number, base);
    if (error != std::errc() || stop != end) return;
    part.number = number;
    part.range = {text_.tokens[i].begin, text_.tokens[i].end};
  }

  static const Component* find(const std::vector<Component>& parts, std::string_view name) {
    const Component* out = nullptr;
    for (const Component& part : parts)
      if (part.name == name) out = &part;
    return out;
  }

  VERNIER_LOCAL static std::optional<Isometry3> frame_of(const std::vector<Component>& parts) {
    static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "a", "b", "c"};
    Vector6 v;
    for (std::size_t k = 0; k < 6; ++k) {
      const Component* part = find(parts, names[k]);
      if (part == nullptr || !part->number) return {};
      v(static_cast<Index>(k)) = *part->number;
    }
    Isometry3 out = Isometry3::Identity();
    out.translation() = v.head<3>() * 1e-3;
    v.tail<3>() *= std::numbers::pi / 180;
    out.linear() = rotation_of_zyx(v(3), v(4), v(5));
    return out;
  }

  // {X ..} or {A1 ..} at tokens from i to end: a target, unless the rest of the line goes on with it
  void target(const std::string& name, std::size_t i, std::size_t end) {
    const std::size_t first = i;
    const std::vector<Component> parts = components(i, end);
    const bool pose = find(parts, "x") != nullptr || find(parts, "y") != nullptr || find(parts, "z") != nullptr;
    const bool axes = std::any_of(parts.begin(), parts.end(), [](const Component& part) {
      return part.name.size() == 2 && part.name[0] == 'a' && part.name[1] >= '1' && part.name[1] <= '6';
    });
    const auto refuse = [&](const char* reason) {
      program_.uncorrected.push_back({text_.tokens[first].line, excerpt(text_, first, i), reason});
    };
    if (!pose && !axes) {
      const bool turns = find(parts, "a") != nullptr || find(parts, "b") != nullptr || find(parts, "c") != nullptr;
      if (name.empty() && turns) refuse("components are missing, those of the position before are kept");  // of a move
      return;
    }
    for (int e = 1; e <= 6; ++e) {
      const Component* part = find(parts, message('e', e));
      if (part != nullptr && (!part->number || !same_value(*part->number, 0)))
        return refuse("external axes are in use");
    }
    ProgramTarget out;
    place(text_, text_.tokens[first].begin, text_.tokens[first].line, out);
    out.name = name;
    static constexpr std::array<std::string_view, 6> pose_names{"x", "y", "z", "a", "b", "c"};
    static constexpr std::array<std::string_view, 6> axis_names{"a1", "a2", "a3", "a4", "a5", "a6"};
    for (std::size_t k = 0; k < 6; ++k) {
      const Component* part = find(parts, pose ? pose_names[k] : axis_names[k]);
      if (part == nullptr) return refuse("components are missing, those of the position before are kept");
      if (!part->number) return refuse("its components are no numbers");
      out.numbers.push_back(part->range);
      out.joints(static_cast<Index>(k)) = *part->number * std::numbers::pi / 180;
    }
    if (!pose) {
      out.kind = TargetKind::joints;
    } else {
      out.joints = ProgramTarget{}.joints;
      out.pose = *frame_of(parts);
      const Component *status = find(parts, "s"), *turn = find(parts, "t");
      if ((status == nullptr) != (turn == nullptr)) return refuse("S without T, or T without S");
      if (status != nullptr) {
        for (const Component* part : {status, turn}) {
          if (!part->number || !(*part->number >= 0 && *part->number < 1024) ||
              !same_value(*part->number, std::floor(*part->number)))
            return refuse("S or T is no number of bits");
          out.configuration.push_back(static_cast<int>(*part->number));
          out.configuration_numbers.push_back(part->range);
        }
      }
    }
    literals_[first] = program_.targets.size();
    program_.targets.push_back(std::move(out));
  }

  bool move(std::size_t i, std::size_t end) {
    const std::string name = word(i);
    static constexpr std::array<std::string_view, 14> names{"ptp",      "lin",      "circ",      "sptp",    "slin",
                                                            "scirc",    "spl",      "ptp_rel",   "lin_rel", "circ_rel",
                                                            "sptp_rel", "slin_rel", "scirc_rel", "spl_rel"};
    if (std::find(names.begin(), names.end(), name) == names.end() || text_.is(i + 1, '=') || i + 1 >= end)
      return false;
    const bool relative = name.ends_with("_rel");
    const TargetMove kind = name.find("ptp") != std::string::npos ? TargetMove::joint : TargetMove::linear;
    const int targets = name.find("circ") != std::string::npos ? 2 : 1;
    calls(i + 1, end);
    Frames frames = with(i, end);
    if (frames.unknown.empty()) frames.unknown = other_argument(i, targets, end);
    const std::size_t point = flow_.point();
    std::size_t first = i + 1;
    for (int a = 0; a < targets && first < end; ++a) {
      const std::size_t last = argument_end(first, end);
      if (relative) {
        break_order();
        remark(line_of(i), excerpt(text_, i, last), "a relative move");
      } else {
        if (text_.is(first, '{') && behind_brackets(text_, first, end) == last) target({}, first, end);
        uses_.push_back({{first, last}, i, kind, point, frames, true, is_parameter(word(first)), scope_});
      }
      first = last + 1;
    }
    act_.clear();
    return true;
  }

  // the end of a move's argument that begins at token i
  std::size_t argument_end(std::size_t i, std::size_t end) const {
    for (std::size_t k = i; k < end;) {
      if (text_.is(k, ',') || (k > i && is_option(k))) return k;
      k = text_.is(k, '{') || text_.is(k, '(') || text_.is(k, '[') ? behind_brackets(text_, k, end) : k + 1;
    }
    return end;
  }

  // Of what follows the targets of a move other than blending and CA, nobody knows where it ends; empty: nothing.
  std::string other_argument(std::size_t i, int targets, std::size_t end) const {
    std::size_t k = i;
    for (; targets > 0 && k < end; --targets) k = argument_end(k + 1, end);
    while (k < end && (text_.is(k, ',') || is_blending(k) || word(k) == "ca"))
      k = word(k) == "ca" ? argument_end(k + 1, end) : k + 1;
    if (k >= end || is_option(k)) return {};
    return message("line ", line_of(i), ", ", excerpt(text_, i, end), ": what it does to targets is not known");
  }

  bool is_blending(std::size_t i) const {
    static const auto names = words_of("c_ptp c_dis c_vel c_ori c_spl");
    return names.count(word(i)) != 0;
  }
  bool is_option(std::size_t i) const { return is_blending(i) || word(i) == "with"; }

  void resolve(const Use& use) {
    const auto [first, last] = use.argument;
    ProgramStep step{{}, use.frames.tool, use.frames.base, use.move};
    step.point = use.point;
    step.unknown = use.frames.unknown;
    if (first >= last) {
      add_step(steps_, {{}, {}, {}, TargetMove::unknown});
      return;
    }
    if (const auto found = literals_.find(first); found != literals_.end()) {
      step.target = found->second;
      add_step(steps_, step);
      return;
    }
    const bool name_alone =
        text_.is_word(first) &&
        (last == first + 1 || (text_.is(first + 1, '[') && behind_brackets(text_, first + 1, last) == last));
    const std::string name = scoped(word(first), use.scope);
    const auto named = names_.find(name);
    if (name_alone && !use.parameter && named != names_.end() && !named->second.empty()) {
      step.element = named->second.size() > 1;
      for (const std::size_t k : named->second) {
        step.target = k;
        add_step(steps_, step);
      }
      return;
    }
    if (!use.moves) return;
    add_step(steps_, {{}, {}, {}, use.move});
    if (text_.is(first, '{') && behind_brackets(text_, first, last) == last) return;  // refused before
    const bool computed = !name_alone || changed_.count(name) != 0;
    program_.uncorrected.push_back({text_.tokens[use.instruction].line, excerpt(text_, use.instruction, last),
                                    use.parameter ? "a parameter"
                                    : computed    ? "computed, not a literal"
                                                  : "no literal of this file, perhaps of its data list"});
  }

  // The data list says by FP1 which tool and base XP1 is in. Its frames must hold at each move, or always.
  void flange_data() {
    std::vector<bool> has(program_.targets.size(), false), moves = has;
    const auto uses = [&](std::size_t k, std::size_t point) {
      const ProgramTarget& target = program_.targets[k];
      used_frames_.push_back({{true, target.tool}, point});
      used_frames_.push_back({{false, target.workobject}, point});
      moves[k] = true;
    };
    for (std::size_t k = 0; k < has.size(); ++k) {
      ProgramTarget& target = program_.targets[k];
      if (target.kind != TargetKind::pose || target.name.size() < 2 || target.name[0] != 'x') continue;
      const auto found = flange_data_.find("f" + target.name.substr(1));
      if (found == flange_data_.end()) continue;
      has[k] = true;
      target.tool = found->second.external ? "external" : found->second.tool;
      target.workobject = found->second.external ? "external" : found->second.base;
    }
    for (const ProgramStep& step : steps_)
      if (step.target && has[*step.target] && step.point != ProgramStep::no_point) uses(*step.target, step.point);
    for (std::size_t k = 0; k < has.size(); ++k)
      if (has[k] && !moves[k]) uses(k, ProgramStep::no_point);
  }

  std::set<std::string> typed_{};  // of the file: another one may use them
  std::map<std::string, std::vector<std::size_t>> names_{};
  std::map<std::size_t, std::size_t> literals_{};  // target by its first token
  std::map<std::string, FlangeData> flange_data_{};
  std::vector<std::pair<std::string, Span>> changes_{};
  std::set<std::string> changed_{};  // their names
  std::set<FrameData> changed_frames_{};
  std::set<FrameData> data_frames_{};                             // of a data list
  std::vector<std::pair<FrameData, std::size_t>> used_frames_{};  // and the point of the program's flow
  std::set<std::string> routines_{};                              // of this file
  std::set<std::string> changed_data_{};                          // names whose values may change after they are stated
  std::map<std::string, std::size_t> kept_orientation_{};         // LDAT with which orientations are reached; scope
  std::set<std::string> declared_ldat_{};
  std::map<std::string, std::string> act_{};  // what FDAT_ACT and LDAT_ACT are
  Frames spline_{};                           // of the present spline
  std::size_t depth_ = 0;                     // of blocks
  bool data_ = false;                         // in a data list
  int nesting_ = 0;                           // of instructions in one line
  std::vector<Use> uses_{};
};

VERNIER_IMPL void read_krl(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                           RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = ";&", .quotes = "\"'"});
  const StatementTable table(std::string(krl_harmless) + ' ' + std::string(krl_functions), krl_statements, assumed);
  KrlReader(tokens, program, table).read();
}

}  // namespace vernier::detail
