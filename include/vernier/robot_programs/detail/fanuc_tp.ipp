#pragma once

#include <array>
#include <charconv>
#include <map>
#include <numbers>
#include <set>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::detail {

/// Reads the positions of a Fanuc teach pendant program in its text form.
class FanucReader {
 public:
  FanucReader(const ProgramText& from, RobotProgram& to) : text_(from), program_(to) {}

  void read() {
    program_.tools["0"] = program_.workobjects["0"] = Isometry3::Identity();
    const std::size_t moves = section("mn"), positions = section("pos");
    if (section("prog") == none || moves == none || positions == none || positions < moves)
      throw DataError(message(text_.name, ": no sections /PROG, /MN and /POS, so this is no Fanuc program"));
    program_.stamp_at = text_.tokens[moves].end;
    for (std::size_t i = positions; i < text_.tokens.size();)
      i = word(i) == "p" && text_.is(i + 1, '[') ? position(i) : i + 1;
    const std::size_t first = text_.tokens[moves].end, last = text_.text.find("/POS", first);
    if (last != std::string_view::npos)
      instructions(text_.text.substr(first, last - first), text_.tokens[moves].line + 1);
    std::vector<bool> keep(program_.targets.size(), true);
    for (ProgramStep& step : steps_)
      if (step.target && relative_.count(*step.target) != 0) step.target.reset();
    for (const std::size_t k : relative_) keep[k] = false;
    use_targets(text_, steps_, keep, program_);
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::string word(std::size_t i) const { return text_.is_word(i) ? lower_case(text_.at(i)) : std::string(); }

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
    std::array<std::optional<double>, 6> values{};
    std::array<ByteRange, 6> ranges{};
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
      if (key.size() == 2 && key[0] == 'j') joints = true;
      if (key.size() == 2 && key[0] == 'e') {
        const std::optional<double> axis = signed_number(text_, k + 2, next, range);
        external = external || !axis || !same_value(*axis, 0);
      }
    }
    if (!group) return refuse("no group 1");
    if (other_group) return refuse("a second motion group");
    if (external) return refuse("external axes are in use");
    if (joints) return refuse("joint values, in which J2 and J3 depend on each other");
    Vector6 v;
    for (std::size_t c = 0; c < 6; ++c) {
      if (!values[c]) return refuse("a component is missing or no number");
      v(static_cast<Index>(c)) = *values[c];
      out.numbers.push_back(ranges[c]);
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

  //    1:J P[1] 100% FINE    ;
  void instructions(std::string_view text, std::size_t line) {
    while (!text.empty()) {
      std::size_t end = text.find(';');
      if (end == std::string_view::npos) end = text.size() - 1;
      std::string_view instruction = text.substr(0, end + 1);
      text.remove_prefix(end + 1);
      while (!instruction.empty() && (instruction.front() == ' ' || instruction.front() == '\t' ||
                                      instruction.front() == '\r' || instruction.front() == '\n')) {
        line += instruction.front() == '\n' ? 1 : 0;
        instruction.remove_prefix(1);
      }
      const std::size_t at = line;
      for (const char c : instruction) line += c == '\n' ? 1 : 0;
      const std::size_t colon = instruction.find(':');
      if (colon == std::string_view::npos || instruction.find_first_not_of("0123456789 \t") != colon) continue;
      instruction.remove_prefix(colon + 1);
      const std::size_t begin = instruction.find_first_not_of(" \t");
      if (begin != std::string_view::npos) one(instruction.substr(begin), at);
    }
  }

  void one(std::string_view text, std::size_t line) {
    const std::string_view kinds = "JLCA";
    if (text.size() < 4 || kinds.find(text[0]) == std::string_view::npos || (text[1] != ' ' && text[1] != '\t')) return;
    if (text.find("P[") == std::string_view::npos && text.find("PR[") == std::string_view::npos) return;
    const TargetMove kind = text[0] == 'J' ? TargetMove::joint : TargetMove::linear;
    const auto remark = [&](const char* reason) {
      program_.uncorrected.push_back({line, excerpt(text.substr(0, text.size() - 1)), reason});
    };
    bool any = false;
    std::size_t options = text.size();
    for (std::size_t i = 1; i + 2 < text.size() && !(any && kind == TargetMove::joint); ++i) {
      if (text[i - 1] != ' ' && text[i - 1] != '\t') continue;
      const bool position = text.substr(i, 2) == "P[", registers = text.substr(i, 3) == "PR[";
      if (!position && !registers) {
        if (any && text[i] >= '0' && text[i] <= '9') {  // the speed: what follows are options
          options = i;
          break;
        }
        continue;
      }
      any = true;
      const std::size_t first = i + (position ? 2 : 3), last = text.find_first_of(":]", first);
      const std::size_t close = (std::min)(text.find(']', first), text.size());
      i = close;  // words of its comment are no options
      if (registers || last == std::string_view::npos) {
        steps_.push_back({{}, {}, {}, kind});
        remark("a position register");
        continue;
      }
      const auto found = known_.find("P[" + std::string(text.substr(first, last - first)) + "]");
      if (found == known_.end()) {
        steps_.push_back({{}, {}, {}, kind});
        remark("no position of this file");
      } else if (found->second == none) {
        steps_.push_back({{}, {}, {}, kind});
      } else {
        steps_.push_back({found->second, {}, {}, kind});
      }
      options = close;
    }
    const std::string rest = lower_case(text.substr((std::min)(options, text.size())));
    if (rest.find("offset") != std::string::npos) remark("an offset that a register adds");
    const std::string increment = " inc";  // not the beginning of a longer word
    std::size_t at = rest.find(increment);
    while (at != std::string::npos && at + increment.size() < rest.size() &&
           is_word_character(rest[at + increment.size()]))
      at = rest.find(increment, at + 1);
    if (at != std::string::npos) {
      remark("a relative move");
      incremental(steps_.back());
    }
  }

  // a position of which only the difference counts is none
  void incremental(ProgramStep& step) {
    if (!step.target) return;
    relative_.insert(*step.target);
    step.target.reset();
  }

  const ProgramText& text_;
  RobotProgram& program_;
  std::map<std::string, std::size_t> known_{};  // index of its target
  std::set<std::size_t> relative_{};
  std::vector<ProgramStep> steps_{};
};

VERNIER_IMPL void read_fanuc_tp(std::string_view text, const std::string& name, RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = "", .quotes = "\"'"});
  FanucReader(tokens, program).read();
}

}  // namespace vernier::detail
