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
#include "vernier/core/same_value.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::detail {

/// Reads the targets of a KRL program or data list.
class KrlReader {
 public:
  KrlReader(const ProgramText& from, RobotProgram& to) : text_(from), program_(to) {}

  void read() {
    find_head();
    program_.tools["0"] = program_.workobjects["0"] = Isometry3::Identity();
    for (std::size_t i = 0; i < text_.tokens.size();) {
      std::size_t end = i;
      while (!text_.is_line_end(end)) ++end;
      if (end > i) line(i, end);
      i = end + 1;
    }
    for (const Use& use : uses_) resolve(use);
    for (std::size_t k = 0; k < program_.targets.size(); ++k) flange_data(program_.targets[k]);
    for (const auto& [tool, number] : changed_frames_) forget(tool ? program_.tools : program_.workobjects, number);
    for (const auto& [name, change] : changes_)
      if (names_.count(name) != 0)
        program_.uncorrected.push_back({text_.tokens[change.first].line, excerpt(text_, change.first, change.second),
                                        "the program changes this target"});
    std::vector<bool> keep(program_.targets.size());
    for (std::size_t k = 0; k < keep.size(); ++k) keep[k] = typed_.count(program_.targets[k].name) != 0;
    use_targets(text_, steps_, keep, program_);
  }

 private:
  struct Span {
    std::size_t first, second;
  };
  struct Use {
    Span argument{0, 0};  // empty: a routine begins
    std::size_t instruction = 0;
    TargetMove move = TargetMove::unknown;
    std::string tool{}, base{};
  };
  struct Component {
    std::string name{};
    std::optional<double> number{};
    ByteRange range{0, 0};
    Span value{0, 0};
  };
  struct FlangeData {
    std::string tool{}, base{};
    bool external = false;
  };

  std::string word(std::size_t i) const { return text_.is_word(i) ? lower_case(text_.at(i)) : std::string(); }

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

  void line(std::size_t i, std::size_t end) {
    while (i < end && (word(i) == "decl" || word(i) == "global" || word(i) == "const" || word(i) == "public")) ++i;
    if (i >= end) return;
    const std::string first = word(i);
    if (first == "def" || first == "deffct") {
      uses_.push_back({});
      tool_.clear();
      base_.clear();
      return;
    }
    static constexpr std::array<std::string_view, 4> types{"e6pos", "pos", "e6axis", "axis"};
    if (std::find(types.begin(), types.end(), first) != types.end() && text_.is_word(i + 1) && i + 1 < end) {
      for (std::size_t k = i + 1; k < end;) {  // names, the last one perhaps with a value
        const std::string name = word(k);
        if (name.empty()) break;
        typed_.insert(name);
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
    if (first == "bas") return bas(i, end);
    if (move(i, end)) return;
    if (!text_.is_word(i)) return;
    std::size_t k = i + 1;  // an assignment
    if (text_.is(k, '[')) k = behind_brackets(text_, k, end);
    const std::size_t behind_name = k;
    while (text_.is(k, '.') && text_.is_word(k + 1)) k += 2;
    if (k >= end || !text_.is(k, '=') || text_.is(k + 1, '=')) return;
    if (k != behind_name)
      component(first, i, end);
    else
      value(first, i, k + 1, end);
  }

  // name.X = value, at tokens from i to end
  void component(const std::string& name, std::size_t i, std::size_t end) {
    if (name == "$tool")
      tool_ = "?";
    else if (name == "$base")
      base_ = "?";
    else if (name == "tool_data" || name == "base_data")
      changed_frames_.insert({name == "tool_data", index(i + 1)});
    else
      changes_.push_back({name, {i, end}});
  }

  // name = value, at tokens from i to end
  void value(const std::string& name, std::size_t at, std::size_t i, std::size_t end) {
    const bool tool = name == "$tool" || name == "tool_data", base = name == "$base" || name == "base_data";
    if (!tool && !base) {
      if (!text_.is(i, '{')) {
        changes_.push_back({name, {at, end}});
        return;
      }
      const std::size_t before = program_.targets.size();
      target(name, i, end);
      for (std::size_t k = before; k < program_.targets.size(); ++k) names_[name].push_back(k);
      return;
    }
    std::string number;  // of TOOL_DATA[n]
    if (name == "tool_data" || name == "base_data") number = index(at + 1);
    auto& frames = tool ? program_.tools : program_.workobjects;
    std::string& current = tool ? tool_ : base_;
    if (text_.is(i, '{')) {
      const std::string key = number.empty() ? message(text_.at(at), " of line ", text_.tokens[at].line) : number;
      const std::vector<Component> parts = components(i, end);
      const std::optional<Isometry3> frame = i == end ? frame_of(parts) : std::nullopt;
      const auto stated = frames.find(key);
      if (!frame || (stated != frames.end() && !stated->second.isApprox(*frame, 0)))
        changed_frames_.insert({tool, key});
      else
        frames[key] = *frame;
      if (number.empty()) current = frame ? key : "?";
      return;
    }
    if (!number.empty()) {
      changed_frames_.insert({tool, number});
      return;
    }
    current = "?";
    const std::string source = word(i);
    if (source == "$nullframe" && i + 1 == end) current = "0";
    if (source == (tool ? "tool_data" : "base_data") && behind_brackets(text_, i + 1, end) == end)
      current = index(i + 1);
    if (current.empty()) current = "?";
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

  // BAS(#TOOL,n), BAS(#BASE,n)
  void bas(std::size_t i, std::size_t end) {
    if (i + 6 > end || !text_.is(i + 1, '(') || !text_.is(i + 2, '#') || !text_.is(i + 4, ',')) return;
    const bool number = text_.tokens[i + 5].kind == ProgramToken::Kind::number;
    if (word(i + 3) == "tool") tool_ = number ? std::string(text_.at(i + 5)) : "?";
    if (word(i + 3) == "base") base_ = number ? std::string(text_.at(i + 5)) : "?";
  }

  void fdat(const std::string& name, std::size_t i, std::size_t end) {
    if (!text_.is(i, '{')) return;
    FlangeData data;
    for (const Component& part : components(i, end)) {
      const std::string text = part.number ? message(static_cast<long long>(std::clamp(*part.number, -1e9, 1e9))) : "?";
      if (part.name == "tool_no") data.tool = text;
      if (part.name == "base_no") data.base = text;
      if (part.name == "ipo_frame") data.external = word(part.value.second - 1) == "tcp";
    }
    flange_data_[name] = data;
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
      if (status != nullptr && turn != nullptr) {
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
    std::size_t first = i + 1;
    for (int a = 0; a < targets && first < end; ++a) {
      std::size_t last = first;
      while (last < end && !text_.is(last, ',') && !is_option(last))
        last = text_.is(last, '{') || text_.is(last, '(') || text_.is(last, '[') ? behind_brackets(text_, last, end)
                                                                                 : last + 1;
      if (relative) {
        uses_.push_back({});
        program_.uncorrected.push_back({text_.tokens[i].line, excerpt(text_, i, last), "a relative move"});
      } else {
        if (text_.is(first, '{') && behind_brackets(text_, first, end) == last) target({}, first, end);
        uses_.push_back({{first, last}, i, kind, tool_, base_});
      }
      first = last + 1;
    }
    return true;
  }

  bool is_option(std::size_t i) const {
    const std::string name = word(i);
    return name.find("c_") == 0 || name == "with";
  }

  void resolve(const Use& use) {
    const auto [first, last] = use.argument;
    ProgramStep step{{}, use.tool, use.base, use.move};
    if (first >= last) {
      steps_.push_back({{}, {}, {}, TargetMove::unknown});
      return;
    }
    if (const auto found = literals_.find(first); found != literals_.end()) {
      step.target = found->second;
      steps_.push_back(step);
      return;
    }
    const bool name_alone =
        text_.is_word(first) &&
        (last == first + 1 || (text_.is(first + 1, '[') && behind_brackets(text_, first + 1, last) == last));
    const auto named = names_.find(word(first));
    if (name_alone && named != names_.end() && !named->second.empty()) {
      step.element = named->second.size() > 1;
      for (const std::size_t k : named->second) {
        step.target = k;
        add_step(steps_, step);
      }
      return;
    }
    steps_.push_back({{}, {}, {}, use.move});
    if (text_.is(first, '{') && behind_brackets(text_, first, last) == last) return;  // refused before
    program_.uncorrected.push_back(
        {text_.tokens[use.instruction].line, excerpt(text_, use.instruction, last),
         name_alone ? "no literal of this file, perhaps of its data list" : "computed, not a literal"});
  }

  // The data list says by FP1 which tool and base XP1 is in.
  void flange_data(ProgramTarget& target) {
    if (target.kind != TargetKind::pose || target.name.size() < 2 || target.name[0] != 'x') return;
    const auto found = flange_data_.find("f" + target.name.substr(1));
    if (found == flange_data_.end()) return;
    target.tool = found->second.external ? "external" : found->second.tool;
    target.workobject = found->second.external ? "external" : found->second.base;
  }

  const ProgramText& text_;
  RobotProgram& program_;
  std::string tool_{}, base_{};
  std::set<std::string> typed_{};
  std::map<std::string, std::vector<std::size_t>> names_{};
  std::map<std::size_t, std::size_t> literals_{};  // target by its first token
  std::map<std::string, FlangeData> flange_data_{};
  std::vector<std::pair<std::string, Span>> changes_{};
  std::set<std::pair<bool, std::string>> changed_frames_{};  // whether of a tool; number, empty where it is computed
  std::vector<Use> uses_{};
  std::vector<ProgramStep> steps_{};
};

VERNIER_IMPL void read_krl(std::string_view text, const std::string& name, RobotProgram& program) {
  const ProgramText tokens = ProgramText::of(text, name, {.comments = ";&", .quotes = "\"'"});
  KrlReader(tokens, program).read();
}

}  // namespace vernier::detail
