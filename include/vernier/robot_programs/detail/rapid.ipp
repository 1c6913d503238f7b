#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::detail {

/// Reads the targets of a RAPID module.
class RapidReader {
 public:
  RapidReader(const ProgramText& from, RobotProgram& to) : text_(from), program_(to) {}

  void read() {
    find_module();
    program_.tools["tool0"] = program_.workobjects["wobj0"] = Isometry3::Identity();
    for (std::size_t i = 0; i < text_.tokens.size();) i = statement(i);
    for (const auto& [line, expression] : changes_) {
      const std::string name = lower_case(text_.at(expression.first));
      assigned_.insert(name);
      if (names_.count(name) != 0)
        program_.uncorrected.push_back(
            {line, excerpt(text_, expression.first, expression.second), "the program changes this target"});
    }
    for (const std::string& name : assigned_) {  // frames that the program changes are not those that it states
      program_.tools.erase(name);
      program_.workobjects.erase(name);
    }
    for (const Move& move : moves_) use(move);
    use_targets(text_, steps_, std::vector<bool>(program_.targets.size(), true), program_);
  }

 private:
  struct Span {
    std::size_t first, second;
  };
  struct Move {
    std::size_t token = 0;  // none: routines begin
    std::vector<Span> arguments{};
    std::string tool{}, workobject = "wobj0";
  };

  std::string word(std::size_t i) const { return text_.is_word(i) ? lower_case(text_.at(i)) : std::string(); }

  void find_module() {
    for (std::size_t i = 0; i + 1 < text_.tokens.size(); ++i) {
      if (word(i) != "module" || !text_.is_word(i + 1)) continue;
      std::size_t k = i + 2;
      if (text_.is(k, '(')) k = behind_brackets(text_, k, text_.tokens.size());
      while (k < text_.tokens.size() && !text_.is_line_end(k)) ++k;
      program_.stamp_at = text_.tokens[(std::min)(k, text_.tokens.size() - 1)].end;
      return;
    }
    throw DataError(message(text_.name, ": no MODULE, so this is no RAPID program"));
  }

  std::size_t statement(std::size_t i) {
    if (text_.is(i, '[')) return literal(i, {});
    if (!text_.is_word(i)) return i + 1;
    const std::string name = word(i);
    if (name == "proc" || name == "func" || name == "trap") {
      moves_.push_back({});
      return i + 1;
    }
    if (name == "const" || name == "pers" || name == "var") return declaration(i);
    if (is_move(name) && !follows(i, ":=.\\,")) {
      if (!text_.is(i + 1, ':') && !text_.is(i + 1, '(') && !text_.is(i + 1, '.')) return move(i);
    }
    if (i > 0 && (text_.is(i - 1, '\\') || text_.is(i - 1, '.'))) return i + 1;
    std::size_t k = i + 1;  // a change of a variable or of a part of it
    if (text_.is(k, '{')) k = behind_brackets(text_, k, text_.tokens.size());
    while (text_.is(k, '.') && text_.is_word(k + 1)) k += 2;
    if (!text_.is(k, ':') || !text_.is(k + 1, '=')) return i + 1;
    if (k == i + 1 && text_.is(k + 2, '[')) {
      assigned_.insert(name);
      return literal(k + 2, name);
    }
    std::size_t end = k;
    while (end < text_.tokens.size() && !text_.is(end, ';') && !text_.is_line_end(end)) ++end;
    changes_.push_back({text_.tokens[i].line, {i, end}});
    return end;
  }

  bool follows(std::size_t i, std::string_view signs) const {
    return i > 0 && text_.tokens[i - 1].kind == ProgramToken::Kind::sign &&
           signs.find(text_.text[text_.tokens[i - 1].begin]) != std::string_view::npos;
  }

  static bool is_move(std::string_view name) {
    static constexpr std::array<std::string_view, 28> names{
        "movej",     "movel",     "movec",     "moveabsj", "movejdo", "moveldo", "movecdo",
        "movejao",   "movelao",   "movecao",   "movejgo",  "movelgo", "movecgo", "movejsync",
        "movelsync", "movecsync", "triggj",    "triggl",   "triggc",  "arcl",    "arcc",
        "arclstart", "arclend",   "arccstart", "arccend",  "spotl",   "displ",   "paintl"};
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  // CONST robtarget p10:=[..]; and the like
  std::size_t declaration(std::size_t i) {
    const std::string type = word(i + 1);
    if (!text_.is_word(i + 2)) return i + 1;
    const std::string name = word(i + 2);
    std::size_t k = i + 3;
    if (text_.is(k, '{')) k = behind_brackets(text_, k, text_.tokens.size());
    const bool value = text_.is(k, ':') && text_.is(k + 1, '=');
    if (value) k += 2;
    const bool brackets = value && text_.is(k, '[');
    const std::size_t line = text_.tokens[i].line;
    if (type == "robtarget" || type == "jointtarget") {
      names_.try_emplace(name);
      if (brackets) {
        const std::size_t before = program_.targets.size();
        const std::size_t end = literal(k, name);
        if (program_.targets.size() == before && refused_line_ != line)
          program_.uncorrected.push_back({line, excerpt(text_, i + 1, end), "no literal of this type"});
        return end;
      }
      if (value) {
        std::size_t end = k;
        while (end < text_.tokens.size() && !text_.is(end, ';') && !text_.is_line_end(end)) ++end;
        program_.uncorrected.push_back({line, excerpt(text_, i + 1, end), "computed, not a literal"});
        return end;
      }
      return k;
    }
    if (!brackets) return k;
    if (type == "tooldata" || type == "wobjdata" || type == "extjoint" || type == "confdata") {
      const BracketValue data = read_brackets(text_, k, ';');
      if (type == "tooldata") tool(name, data);
      if (type == "wobjdata") workobject(name, data);
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
  void tool(const std::string& name, const BracketValue& data) {
    if (data.values.size() != 3 || !flag(data.values[0], "true")) return;
    if (const auto found = frame(data.values[1])) program_.tools[name] = *found;
  }

  // a work object that stands still: [FALSE,TRUE,"",uframe,oframe]
  void workobject(const std::string& name, const BracketValue& data) {
    if (data.values.size() != 5 || !flag(data.values[0], "false") || !flag(data.values[1], "true")) return;
    const auto user = frame(data.values[3]), object = frame(data.values[4]);
    if (user && object) program_.workobjects[name] = *user * *object;
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
      refused_line_ = value.line;
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
      if (v[2].numbers(4))
        for (const BracketValue& number : v[2].values) {
          if (!(std::abs(*number.number) < 1000)) return refuse("its configuration is out of range");
          target.configuration.push_back(static_cast<int>(std::lround(*number.number)));
          target.configuration_numbers.push_back(number.range);
        }
    }
    if (!name.empty())
      names_[name].push_back(program_.targets.size());
    else
      inline_[value.token] = program_.targets.size();
    program_.targets.push_back(std::move(target));
  }

  // MoveL p10,v100,fine,tool0\WObj:=wobj1;
  std::size_t move(std::size_t i) {
    Move found;
    found.token = i;
    std::size_t k = i + 1, begin = k, depth = 0;
    std::size_t main_end = 0;
    const auto close = [&] {
      const std::size_t end = main_end == 0 ? k : main_end;
      if (end > begin) {
        found.arguments.push_back({begin, end});
        found.tool = end == begin + 1 ? word(begin) : std::string();
      }
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
        if (word(k + 1) == "wobj")
          found.workobject = text_.is(k + 2, ':') && text_.is(k + 3, '=') && text_.is_word(k + 4) ? word(k + 4) : "?";
      }
      if (depth == 0 && text_.is(k, ',')) close();
      ++k;
    }
    if (k >= text_.tokens.size()) fail_at(text_, text_.tokens[i].line, "an instruction is not ended by ;");
    close();
    moves_.push_back(std::move(found));
    return k;
  }

  void use(const Move& move) {
    if (move.token == 0) {
      steps_.push_back({{}, {}, {}, TargetMove::unknown});
      return;
    }
    const std::string name = word(move.token);
    const std::size_t targets = name.find("movec") == 0 || name == "triggc" || name.find("arcc") == 0 ? 2 : 1;
    const TargetMove kind =
        name.find("movej") == 0 || name == "moveabsj" || name == "triggj" ? TargetMove::joint : TargetMove::linear;
    const std::string tool = move.arguments.size() > targets ? move.tool : std::string();
    for (std::size_t a = 0; a < targets; ++a) {
      if (a >= move.arguments.size()) break;
      std::size_t first = move.arguments[a].first, last = move.arguments[a].second;
      while (first < last && text_.is_line_end(first)) ++first;
      while (last > first && text_.is_line_end(last - 1)) --last;
      ProgramStep step{{}, tool, move.workobject, kind};
      if (const auto found = inline_.find(first); found != inline_.end()) {
        step.target = found->second;
        steps_.push_back(step);
        continue;
      }
      const auto declared = names_.find(word(first));
      const bool element = text_.is(first + 1, '{');
      const std::size_t end = element ? behind_brackets(text_, first + 1, last) : first + 1;
      if (text_.is_word(first) && end == last && declared != names_.end() && !declared->second.empty()) {
        step.element = declared->second.size() > 1;
        for (const std::size_t k : declared->second) {
          step.target = k;
          add_step(steps_, step);
        }
        continue;
      }
      steps_.push_back({{}, {}, {}, kind});
      if (text_.is(first, '[')) continue;  // refused before
      program_.uncorrected.push_back({text_.tokens[first < last ? first : move.token].line,
                                      excerpt(text_, move.token, move.token + 1) + " " + excerpt(text_, first, last),
                                      !text_.is_word(first) || end != last ? "computed, not a literal"
                                      : declared == names_.end()           ? "declared in another file, or a parameter"
                                                                           : "a variable without literal value"});
    }
  }

  const ProgramText& text_;
  RobotProgram& program_;
  std::map<std::string, std::vector<std::size_t>> names_{};  // targets of each variable
  std::map<std::size_t, std::size_t> inline_{};              // target by its first token
  std::set<std::string> unused_axes_{};
  std::set<std::string> assigned_{};  // variables
  std::vector<Move> moves_{};
  std::vector<std::pair<std::size_t, Span>> changes_{};
  std::vector<ProgramStep> steps_{};
  std::size_t refused_line_ = 0;
};

VERNIER_IMPL void read_rapid(std::string_view text, const std::string& name, RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "!", .quotes = "\""});
  RapidReader(tokens, program).read();
}

}  // namespace vernier::detail
