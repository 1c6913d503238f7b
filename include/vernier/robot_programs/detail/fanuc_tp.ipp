// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <numbers>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/fanuc_tp_statements.hpp"
#include "vernier/robot_programs/detail/program_readers.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"

namespace vernier::detail {

/// Reads the positions of a Fanuc teach pendant program in its text form.
class FanucReader final : private StatementReader {
 public:
  FanucReader(const ProgramText& from, RobotProgram& to, const StatementTable& table,
              const std::vector<std::string>& assumed)
      : StatementReader(from, to, table) {
    for (const std::string& name : assumed) assumed_.insert(lower_case(name));
  }

  void read() {
    program_.tools["0"] = program_.workobjects["0"] = Isometry3::Identity();
    const std::size_t moves = section("mn"), positions = section("pos");
    if (section("prog") == none || moves == none || positions == none || positions < moves)
      throw DataError(message(text_.name, ": no sections /PROG, /MN and /POS, so this is no Fanuc program"));
    program_.stamp_at = text_.tokens[moves].end;
    for (std::size_t i = positions; i < text_.tokens.size();)
      i = word(i) == "p" && text_.is(i + 1, '[') ? position(i) : i + 1;
    header(moves);
    const std::size_t first = text_.tokens[moves].end, last = text_.text.rfind('/', text_.tokens[positions].begin);
    instructions(text_.text.substr(first, last - first));
    for (const std::size_t k : displaced_)  // for moves that add a register to it, a literal is no target
      if (plain_.count(k) == 0) relative_.insert(k);
    for (ProgramStep& step : steps_)
      if (step.target && relative_.count(*step.target) != 0) step.target.reset();
    for (const std::size_t k : relative_) {
      remark(program_.targets[k].line, program_.targets[k].name, "moves use it as an increment or with an offset");
      changed_.insert(k);
    }
    solve();
    for (ProgramStep& step : steps_) compare_frames(step);
    for (const std::size_t k : changed_) program_.targets[k].numbers.clear();
    use_targets(text_, steps_, std::vector<bool>(program_.targets.size(), true), program_);
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  // the line end behind /NAME
  std::size_t section(std::string_view name) const {
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i) {
      if (!text_.is(i, '/') || word(i + 1) != name || (i > 0 && !text_.is_line_end(i - 1))) continue;
      while (!text_.is_line_end(i)) ++i;
      return i;
    }
    return none;
  }

  // P[n:"name"]{ GP1: .. };
  std::size_t position(std::size_t i) {
    const std::size_t first = i;
    const std::size_t head = behind_brackets(text_, i + 1, text_.tokens.size());
    std::size_t open = head;
    while (open < text_.tokens.size() && text_.is_line_end(open)) ++open;
    if (!text_.is(open, '{') || text_.tokens[i + 2].kind != ProgramToken::Kind::number) return i + 1;
    const std::size_t close = behind_brackets(text_, open, text_.tokens.size());
    if (!text_.is(close - 1, '}')) fail_at(text_, text_.tokens[first].line, "a brace { is not closed");
    const std::string name = message("P[", text_.at(i + 2), "]");
    const std::size_t line = text_.tokens[first].line;
    if (known_.count(name) != 0) fail_at(text_, line, message(name, " is there twice"));
    known_[name] = none;
    const auto refuse = [&](const char* reason) {
      program_.uncorrected.push_back({line, name, reason});
      return close;
    };
    ProgramTarget out;
    place(text_, text_.tokens[first].begin, line, out);
    out.name = name;
    static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "w", "p", "r"};
    std::array<std::optional<double>, 6> values{}, angles{};
    std::array<ByteRange, 6> ranges{}, angle_ranges{};
    bool other_group = false, group = false, joints = false, external = false;
    for (std::size_t k = open + 1; k < close - 1; ++k) {
      const std::string key = word(k);
      if (key == "gp1") group = true;
      if (key.size() == 3 && key.find("gp") == 0 && key != "gp1") other_group = true;
      if (other_group) continue;
      std::size_t next = k + 2;
      ByteRange range{0, 0};
      if ((key == "uf" || key == "ut") && text_.is(k + 1, ':')) {
        const bool number = text_.tokens[k + 2].kind == ProgramToken::Kind::number;
        (key == "uf" ? out.workobject : out.tool) = number ? std::string(text_.at(k + 2)) : "?";
      }
      if (key == "config" && text_.is(k + 1, ':') && text_.tokens[k + 2].kind == ProgramToken::Kind::text)
        configuration(text_.tokens[k + 2], out);
      if (!text_.is(k + 1, '=')) continue;
      for (std::size_t c = 0; c < 6; ++c)
        if (key == names[c]) {
          values[c] = signed_number(text_, k + 2, next, range);
          if (word(next) != (c < 3 ? "mm" : "deg")) values[c].reset();
          ranges[c] = range;
        }
      if (key.size() == 2 && key[0] == 'j') {
        joints = true;
        const std::size_t c = static_cast<std::size_t>(key[1]) - '1';
        if (key[1] > '6') external = external || !is_zero(k + 2);
        if (c < 6) {
          angles[c] = signed_number(text_, k + 2, next, range);
          if (word(next) != "deg") angles[c].reset();
          angle_ranges[c] = range;
        }
      }
      if (key.size() == 2 && key[0] == 'e') external = external || !is_zero(k + 2);
    }
    if (!group) return refuse("no group 1");
    if (other_group) return refuse("a second motion group");
    Vector6 v;
    for (std::size_t c = 0; c < 6; ++c) {
      const std::optional<double>& value = joints ? angles[c] : values[c];
      if (!value) return refuse("a component is missing or no number");
      v(static_cast<Index>(c)) = *value;
      out.numbers.push_back(joints ? angle_ranges[c] : ranges[c]);
    }
    if (external) return refuse("external axes are in use");
    if (joints) {
      out.kind = TargetKind::joints;
      out.joints = v * (std::numbers::pi / 180);
      out.configuration.clear();
      out.configuration_numbers.clear();
      known_[name] = program_.targets.size();
      program_.targets.push_back(std::move(out));
      return close;
    }
    if (out.configuration.empty()) return refuse("its configuration is missing or of another kind");
    if (out.configuration[3] != 0 || out.configuration[4] != 0)
      return refuse("turn numbers whose axes depend on the type of robot");
    out.pose.translation() = v.head<3>() * 1e-3;
    v.tail<3>() *= std::numbers::pi / 180;
    out.pose.linear() = rotation_of_zyx(v(5), v(4), v(3));
    known_[name] = program_.targets.size();
    program_.targets.push_back(std::move(out));
    return close;
  }

  // whether an axis beyond the sixth, whose value is at token i, stands still at zero
  bool is_zero(std::size_t i) const {
    std::size_t next = i;
    ByteRange range{0, 0};
    const std::optional<double> axis = signed_number(text_, i, next, range);
    return axis && same_value(*axis, 0);
  }

  // 'N U T, 0, 0, 0'
  void configuration(const ProgramToken& token, ProgramTarget& target) const {
    const std::string_view text = text_.text.substr(token.begin, token.end - token.begin);
    if (text.size() < 2 || text.back() != text.front()) return;
    std::array<int, 6> out{-1, -1, -1, 0, 0, 0};
    std::vector<ByteRange> ranges;
    for (std::size_t i = 1; i + 1 < text.size();) {
      const char c = text[i];
      if (c == 'N' || c == 'F') out[0] = c == 'F' ? 1 : 0;
      if (c == 'U' || c == 'D') out[1] = c == 'U' ? 1 : 0;
      if (c == 'T' || c == 'B') out[2] = c == 'T' ? 1 : 0;
      if ((c >= '0' && c <= '9') || c == '-') {
        int number = 0;
        const auto [end, error] = std::from_chars(text.data() + i, text.data() + text.size(), number);
        if (error != std::errc() || ranges.size() == 3 || number < -100 || number > 100) return;
        const auto length = static_cast<std::size_t>(end - (text.data() + i));
        out[3 + ranges.size()] = number;
        ranges.push_back({token.begin + i, token.begin + i + length});
        i += length;
        continue;
      }
      ++i;
    }
    if (out[0] < 0 || out[1] < 0 || out[2] < 0 || ranges.size() != 3) return;
    target.configuration.assign(out.begin(), out.end());
    target.configuration_numbers = std::move(ranges);
  }

  // What applications say in front of the instructions. Names in no table concern what is no target.
  void header(std::size_t end) {
    for (std::size_t i = 0; i + 2 < end; ++i) {
      if (!text_.is_word(i) || !text_.is(i + 1, ':')) continue;
      const std::string name = word(i), value = lower_case(text_.at(i + 2));
      if (statements_.find(name, value).kind != StatementClass::unknown)
        apply(text_.tokens[i].line, name, value, excerpt(text_, i, i + 3));
    }
  }

  // the line of a byte
  std::size_t line_at(const char* byte) const {
    const auto at = static_cast<std::size_t>(byte - text_.text.data());
    return std::lower_bound(text_.tokens.begin(), text_.tokens.end() - 1, at,
                            [](const ProgramToken& token, std::size_t b) { return token.end <= b; })
        ->line;
  }

  //    1:J P[1] 100% FINE    ;
  void instructions(std::string_view text) {
    while (!text.empty()) {
      std::size_t end = text.find(';');
      if (end == std::string_view::npos) end = text.size() - 1;
      std::string_view instruction = text.substr(0, end + 1);
      text.remove_prefix(end + 1);
      while (!instruction.empty() && is_blank(instruction.front())) instruction.remove_prefix(1);
      const std::size_t at = line_at(instruction.data());
      const std::size_t colon = instruction.find_first_not_of("0123456789 \t");
      if (instruction.empty()) continue;
      if (colon == std::string_view::npos || instruction[colon] != ':') {
        if (instruction != ";") unknown(at, excerpt(instruction));
        continue;
      }
      instruction.remove_prefix(colon + 1);
      while (!instruction.empty() && (instruction.back() == ';' || is_blank(instruction.back())))
        instruction.remove_suffix(1);
      while (!instruction.empty() && is_blank(instruction.front())) instruction.remove_prefix(1);
      one(instruction, at);
    }
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  // the word at the beginning of a text, with what follows a $ to the end of its name
  static std::string first_word(std::string_view text) {
    std::size_t end = 0;
    while (end < text.size() && (is_word_character(text[end]) || (text[0] == '$' && text[end] == '.'))) ++end;
    return lower_case(text.substr(0, end));
  }

  // a text without what stands in its square brackets and quotes
  static std::string without_brackets(std::string_view text) {
    std::string out;
    std::size_t depth = 0;
    char quote = 0;
    for (const char c : text) {
      if (quote == 0 && c == ']' && depth > 0) --depth;
      if (depth == 0 && quote == 0 && c != '\'' && c != '"') out += c;
      if (c == quote)
        quote = 0;
      else if (quote == 0 && (c == '\'' || c == '"'))
        quote = c;
      else if (quote == 0 && c == '[')
        ++depth;
    }
    return out;
  }

  void one(std::string_view text, std::size_t line) {
    for (int part = 0; !text.empty() && part < 20; ++part) {  // IF ..,CALL X
      while (text.starts_with('(')) text.remove_prefix(1);    // (DO[1]=ON) is an assignment, too
      if (text.empty()) break;
      const std::string name = first_word(text);
      std::string_view rest = text.substr(name.size());
      while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
      if (text[0] == '!' || text.starts_with("//") || text.starts_with("--")) break;  // a remark
      const std::size_t comma = behind_condition(text);
      const bool conditional = ((name == "if" || name == "select") && is_condition(rest) && comma < text.size()) ||
                               text[0] == '=' || (name == "else" && rest.starts_with(','));
      if (conditional) {
        text = comma == std::string_view::npos ? std::string_view() : text.substr(comma + 1);
        while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
        flow_.open(false);
        if (part == 0) opened_ = 0;
        ++opened_;
        continue;
      }
      instruction(text, name, rest, line);
      text = {};
    }
    if (!text.empty() && opened_ > 0) unknown(line, excerpt(text));
    for (; opened_ > 0; --opened_) flow_.close();
  }

  // the comma behind the condition of IF and SELECT
  static std::size_t behind_condition(std::string_view text) {
    std::size_t depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '[' || text[i] == '(') ++depth;
      if ((text[i] == ']' || text[i] == ')') && depth > 0) --depth;
      if (text[i] == ',' && depth == 0) return i;
    }
    return std::string_view::npos;
  }

  // what stands in the first square brackets, without a comment
  static std::string number_in(std::string_view text) {
    const std::size_t open = text.find('[');
    if (open == std::string_view::npos) return {};
    return std::string(text.substr(open + 1, text.find_first_of(":]", open) - open - 1));
  }

  void instruction(std::string_view text, const std::string& name, std::string_view rest, std::size_t line) {
    const std::string what = excerpt(text), form = form_of(rest);
    const bool alone = rest.empty();
    if (is_motion(text)) {
      motion(text, line);
    } else if (name == "if" && is_condition(rest) && form.ends_with("then")) {
      flow_.open(false);
    } else if (name == "for" && is_condition(rest)) {
      flow_.open(true);
    } else if (name == "else" && alone) {
      flow_.branch();
    } else if ((name == "endif" || name == "endfor") && alone) {
      flow_.close();
    } else if (name == "lbl" && rest.starts_with('[')) {
      flow_.label(number_in(text));
    } else if (name == "jmp" && form == "lbl[]") {
      jump(text);
    } else if ((name == "end" || name == "abort") && alone) {
      flow_.leave_routine();
    } else if ((name == "call" || name == "run" || name == "monitor") && !form.starts_with("end ")) {
      call(line, form, what);
      jump(text);  // of another branch of SELECT
    } else if ((name == "uframe_num" || name == "utool_num") && rest.starts_with('=')) {
      rest.remove_prefix(1);
      while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
      const ProgramState state = name == "uframe_num" ? ProgramState::workobject : ProgramState::tool;
      if (rest.empty() || rest.find_first_not_of("0123456789") != std::string_view::npos)
        lose(state, line, what);
      else
        flow_.set(state, {std::string(rest), {}, line});
    } else if (name == "p" && rest.starts_with('[')) {
      change(line, number_in(text), what);
    } else {
      apply_form(line, name, form, what);
      jump(text);
    }
  }

  // What stands behind the first word as tables have it: in lower case, brackets and quotes empty, single blanks.
  static std::string form_of(std::string_view rest) {
    std::string out;
    char quote = 0;
    std::size_t depth = 0;
    for (const char c : lower_case(rest)) {
      if (quote != 0 || (depth > 0 && c != '[' && c != ']')) {
        if (c == quote) {
          out += '\'';
          quote = 0;
        }
        continue;
      }
      if (c == ']' && depth > 0) --depth;
      const bool blank = is_blank(c);
      if (c == '\'' || c == '"') {
        out += '\'';
        quote = c;
      } else if (depth == 0 && !(blank && (out.empty() || out.back() == ' '))) {
        out += blank ? ' ' : c;
      }
      if (c == '[') ++depth;
    }
    while (out.ends_with(' ')) out.pop_back();
    return out;
  }

  // whether a text begins as conditions do: R[1]=, !DI[1], (..), $X=
  static bool is_condition(std::string_view text) {
    if (text.empty() || text[0] == '(' || text[0] == '!' || text[0] == '$') return !text.empty();
    std::size_t end = first_word(text).size();
    if (end == 0) return false;
    while (end < text.size() && is_blank(text[end])) ++end;
    return end < text.size() && std::string_view("[=<>").find(text[end]) != std::string_view::npos;
  }

  // whether a rest has the form of a row
  static bool fits(std::string_view row, std::string_view form) {
    while (!row.empty()) {
      if (row == "..") return true;
      if (row == "?") return is_condition(form);
      if (row[0] == '#') {
        std::size_t end = (std::min)(form.find_first_not_of("0123456789."), form.size());
        if (form.starts_with("r[]")) end = 3;
        if (form.starts_with("ar[]")) end = 4;
        if (end == 0) return false;
        form.remove_prefix(end);
      } else {
        if (form.empty() || form[0] != row[0]) return false;
        form.remove_prefix(1);
      }
      row.remove_prefix(1);
    }
    return form.empty();
  }

  // Another rest than that of a row makes the name of a macro.
  void apply_form(std::size_t line, const std::string& name, const std::string& form, const std::string& what) {
    static const auto words = words_of(fanuc_harmless);
    const bool written = form.starts_with('[') || form.starts_with('=');
    std::string option = form.empty() || written ? "" : " ";
    for (const ProgramStatement& row : fanuc_statements)
      if (row.name == name && row.option != "*" && fits(row.option, form)) option = row.option;
    if (words.count(name) == 0 || written || assumed_.count(name) != 0)
      apply(line, name, option, what);
    else
      unknown(line, what);
  }

  // P[n]=, P[n,m]=, P[R[n]]=: the literal stays as it is
  void change(std::size_t line, const std::string& number, const std::string& what) {
    const std::string digits = number.substr(0, (std::min)(number.find_first_not_of("0123456789"), number.size()));
    if (const auto found = known_.find("P[" + digits + "]"); found != known_.end()) {
      remark(line, what, "the program changes this target");
      if (found->second != none) changed_.insert(found->second);
    } else if (digits.empty()) {
      remark(line, what, "the program changes this target");
      for (const auto& [name, k] : known_)
        if (k != none && changed_.insert(k).second)
          remark(program_.targets[k].line, name, message("line ", line, ", ", what, ": the program may change it"));
    }
  }

  // JMP LBL[n], TIMEOUT,LBL[n], Skip,LBL[n]
  void jump(std::string_view text) {
    const std::size_t at = lower_case(text).find("lbl[");
    if (at == std::string::npos) return;
    const std::string number = number_in(text.substr(at));
    flow_.jump(number.find_first_not_of("0123456789") == std::string::npos ? number : std::string());
  }

  // Tables have no names of routines. Which one CALL SR[n] means is not known.
  bool call(std::size_t line, std::string_view form, const std::string& what) {
    const std::string name = first_word(form);
    const bool harmless = assumed_.count(name) != 0 && !form.substr(name.size()).starts_with('[');
    if (harmless)
      break_order();
    else
      unknown(line, what);
    return harmless;
  }

  static bool is_motion(std::string_view text) {
    const std::string_view kinds = "JLCAS";
    if (text.size() < 4 || kinds.find(text[0]) == std::string_view::npos || !is_blank(text[1])) return false;
    return text.find("P[") != std::string_view::npos || text.find("PR[") != std::string_view::npos;
  }

  void motion(std::string_view text, std::size_t line) {
    const TargetMove kind = text[0] == 'J' ? TargetMove::joint : TargetMove::linear;
    const auto listed = [&](const char* reason) { remark(line, excerpt(text), reason); };
    const std::size_t point = flow_.point(), first_step = steps_.size();
    const auto stop = [&](std::optional<std::size_t> target) {
      ProgramStep step{target, {}, {}, kind};
      step.point = point;
      add_step(steps_, step);
    };
    bool any = false;
    std::size_t options = text.size();
    for (std::size_t i = 1; i + 2 < text.size() && !(any && kind == TargetMove::joint); ++i) {
      if (!is_blank(text[i - 1])) continue;
      const bool position = text.substr(i, 2) == "P[", registers = text.substr(i, 3) == "PR[";
      if (!position && !registers) {
        if (any && (text[i] == 'R' || text[i] == 'A' || text[i] == 'W' || (text[i] >= '0' && text[i] <= '9'))) {
          options = i;  // the speed: what follows are options
          break;
        }
        continue;
      }
      any = true;
      const std::size_t first = i + (position ? 2 : 3), last = text.find_first_of(":]", first);
      const std::size_t close = (std::min)(text.find(']', first), text.size());
      i = close;  // words of its comment are no options
      const auto found = last == std::string_view::npos
                             ? known_.end()
                             : known_.find("P[" + std::string(text.substr(first, last - first)) + "]");
      if (registers || last == std::string_view::npos) {
        stop({});
        listed("a position register");
      } else if (found == known_.end()) {
        stop({});
        const bool number = text[first] >= '0' && text[first] <= '9';
        listed(number ? "no position of this file" : "computed, not a literal");
        if (number) continue;
        for (const auto& [name, k] : known_) {  // P[R[n]]: any of them
          ProgramStep step{k == none ? std::nullopt : std::optional(k), {}, {}, kind, true};
          step.point = point;
          add_step(steps_, step);
        }
      } else {
        stop(found->second == none ? std::nullopt : std::optional(found->second));
      }
      options = close;
    }
    move_options(without_brackets(lower_case(text.substr((std::min)(options, text.size())))), first_step, line, text);
    jump(text);
  }

  // Options behind the speed. Of those that are not known nobody knows where the move ends.
  void move_options(const std::string& rest, std::size_t first_step, std::size_t line, std::string_view text) {
    static const auto options = words_of(fanuc_move_options);
    const std::size_t last_step = steps_.size();
    bool displaced = false, relative = false;
    for (std::size_t i = 0; i < rest.size();) {
      if (!is_word_character(rest[i]) || (rest[i] >= '0' && rest[i] <= '9')) {
        ++i;
        continue;
      }
      std::size_t end = i;
      while (end < rest.size() && is_word_character(rest[end])) ++end;
      std::string option = rest.substr(i, end - i);
      i = end;
      if (option == "call") {
        while (i < rest.size() && is_blank(rest[i])) ++i;
        const std::string_view routine = std::string_view(rest).substr(i);
        if (!call(line, routine, excerpt(text)))  // it may run before the move ends
          refuse_steps(first_step, last_step,
                       message("line ", line, ", ", excerpt(text), ": ", reason_of(ProgramState::everything)));
        i += first_word(routine).size();
        continue;
      }
      while (!option.empty() && option.back() >= '0' && option.back() <= '9') option.pop_back();
      const bool offset = option.find("offset") != std::string::npos, increment = option == "inc";
      displaced = displaced || offset;
      relative = relative || increment;
      if (options.count(option) == 0 && !offset && !increment)
        refuse_steps(first_step, last_step,
                     message("line ", line, ", ", excerpt(text), ": ", option, " is no option that is known"));
    }
    if (displaced) remark(line, excerpt(text), "an offset that a register adds");
    if (relative) remark(line, excerpt(text), "a relative move");
    for (std::size_t s = first_step; s < last_step; ++s) {
      if (steps_[s].target) (displaced ? displaced_ : plain_).insert(*steps_[s].target);
      if (relative) incremental(steps_[s]);
    }
  }

  void refuse_steps(std::size_t first, std::size_t last, const std::string& why) {
    for (std::size_t s = first; s < last; ++s)
      if (steps_[s].unknown.empty()) steps_[s].unknown = why;
  }

  // A position states its tool and frame. The controller refuses others, or takes them without a word.
  void compare_frames(ProgramStep& step) const {
    if (!step.target) return;
    const ProgramTarget& target = program_.targets[*step.target];
    if (step.unknown.empty() && ((!step.tool.empty() && step.tool != target.tool) ||
                                 (!step.workobject.empty() && step.workobject != target.workobject)))
      step.unknown = message("a move uses it with UFRAME_NUM ", step.workobject.empty() ? "?" : step.workobject,
                             " and UTOOL_NUM ", step.tool.empty() ? "?" : step.tool, ", which are not those of it");
    step.tool.clear();
    step.workobject.clear();
  }

  // a position of which only the difference counts is none
  void incremental(ProgramStep& step) {
    if (!step.target) return;
    relative_.insert(*step.target);
    step.target.reset();
  }

  std::map<std::string, std::size_t> known_{};   // index of its target
  std::set<std::size_t> relative_{};             // targets of relative moves
  std::set<std::size_t> displaced_{}, plain_{};  // targets of moves that add an offset, and of others
  std::set<std::size_t> changed_{};              // targets that stay, and are listed
  std::set<std::string> assumed_{};              // harmless names that users state
  int opened_ = 0;                               // conditions in one instruction
};

VERNIER_IMPL void read_fanuc_tp(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                                RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "", .quotes = "\"'"});
  FanucReader(tokens, program, StatementTable(fanuc_harmless, fanuc_statements, assumed), assumed).read();
}

}  // namespace vernier::detail
