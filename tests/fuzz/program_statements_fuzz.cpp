// SPDX-License-Identifier: BSD-3-Clause
// Programs of moves with statements of the tables between them, in blocks and loops: a target behind a statement that
// voids it is never corrected, and one behind harmless statements alone always is.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "reader_fuzz.hpp"
#include "vernier/core/check.hpp"
#include "vernier/robot_programs/detail/fanuc_tp_statements.hpp"
#include "vernier/robot_programs/detail/krl_statements.hpp"
#include "vernier/robot_programs/detail/rapid_statements.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"
#include "vernier/robot_programs/detail/urscript_statements.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace {

using namespace vernier;
using detail::ProgramState;
using detail::ProgramStatement;
using detail::StatementClass;
using Void = std::set<ProgramState>;

/// A line of the program.
struct Item {
  enum class Kind { move, statement, open, close } kind;
  bool linear = false, loop = false;  // of a move, of a block
  StatementClass effect = StatementClass::harmless;
  ProgramState state = ProgramState::everything;
  std::string text{};
};

/// Bytes as choices.
class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool any() const { return at_ < size_; }
  std::size_t below(std::size_t n) { return any() ? data_[at_++] % n : 0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// What a language has.
struct Dialect {
  ProgramLanguage language;
  std::vector<std::string> harmless;
  std::vector<ProgramStatement> others;
};

Dialect dialect(ProgramLanguage language) {
  Dialect out{language, {}, {}};
  const auto fill = [&](std::string_view names, std::span<const ProgramStatement> rows) {
    for (const std::string& name : detail::words_of(names)) out.harmless.push_back(name);
    for (const ProgramStatement& row : rows)
      if (row.kind == StatementClass::voids || row.kind == StatementClass::ends) out.others.push_back(row);
  };
  switch (language) {
    case ProgramLanguage::rapid: fill(detail::rapid_harmless, detail::rapid_statements); break;
    case ProgramLanguage::krl: fill(detail::krl_harmless, detail::krl_statements); break;
    case ProgramLanguage::urscript: fill(detail::urscript_harmless, detail::urscript_statements); break;
    case ProgramLanguage::fanuc_tp: fill(detail::fanuc_harmless, detail::fanuc_statements); break;
  }
  std::erase_if(out.harmless,
                [](const std::string& name) { return name == "connect" || name == "end" || name == "abort"; });
  return out;
}

std::string statement_text(ProgramLanguage language, std::string_view name, std::string_view option) {
  const bool other = option == "*";
  switch (language) {
    case ProgramLanguage::rapid:
      return message(name, option.empty() ? "" : other ? " x1" : message(" \\", option), ";");
    case ProgramLanguage::krl:
      if (name == "bas") return message("BAS (", option, ",1)");
      return name[0] == '$' ? message(name, "=", other || option.empty() ? "1" : option) : message(name, " 1");
    case ProgramLanguage::urscript: return message(name, "(1)");
    default: return message("   1:  ", name, option.empty() ? "[1]=1" : other ? " X" : message(" ", option), " ;");
  }
}

std::string unknown_text(ProgramLanguage language, Choices& choices) {
  std::string name = "zz";
  for (std::size_t k = choices.below(6); k > 0; --k) name += "abcdefghijklmnopqrstuvwxyz_0123456789"[choices.below(37)];
  switch (language) {
    case ProgramLanguage::rapid: return choices.below(2) == 0 ? name + " x1;" : "n:=" + name + "(1);";
    case ProgramLanguage::krl: return choices.below(2) == 0 ? name + "(1)" : "n=1+" + name + "(1)";
    case ProgramLanguage::urscript: return choices.below(2) == 0 ? name + "(1)" : "n=1+" + name + "(1)";
    default: return choices.below(2) == 0 ? "   1:  CALL " + name + " ;" : "   1:  " + name + " ;";
  }
}

Item item(const Dialect& dialect, Choices& choices, std::size_t& depth) {
  const std::size_t which = choices.below(8);
  if (which < 3) return {Item::Kind::move, choices.below(2) == 1};
  if (which == 3 && depth < 5) {
    ++depth;
    return {Item::Kind::open, false, choices.below(2) == 1};
  }
  if (which == 4 && depth > 0) {
    --depth;
    return {Item::Kind::close};
  }
  Item out{Item::Kind::statement};
  if (which == 5) {
    out.effect = StatementClass::voids;
    out.text = unknown_text(dialect.language, choices);
  } else if (which == 6) {
    const std::string& name =
        dialect.harmless[(choices.below(256) * 256 + choices.below(256)) % dialect.harmless.size()];
    out.text = statement_text(dialect.language, name, dialect.language == ProgramLanguage::fanuc_tp ? "" : "*");
  } else {
    const ProgramStatement& row = dialect.others[choices.below(dialect.others.size())];
    out.effect = row.kind;
    out.state = row.state;
    out.text = statement_text(dialect.language, row.name, row.option);
  }
  return out;
}

/// What is void behind the items from `at` to the end of their block; marks the moves of which the target is.
Void walk(const std::vector<Item>& items, std::size_t& at, Void now, std::vector<bool>& refused) {
  for (; at < items.size() && items[at].kind != Item::Kind::close; ++at) {
    const Item& one = items[at];
    if (one.kind == Item::Kind::move) {
      const TargetMove move = one.linear ? TargetMove::linear : TargetMove::joint;
      for (const ProgramState state : now)
        if (detail::matters(state, TargetKind::pose, move)) refused[at] = true;
    } else if (one.kind == Item::Kind::statement) {
      if (one.effect == StatementClass::voids) now.insert(one.state);
      if (one.effect == StatementClass::ends) now.erase(one.state);
    } else {
      const std::size_t first = at + 1;
      Void inside = now;
      for (int round = 0; round < (one.loop ? 2 : 1); ++round) {
        at = first;
        const Void after = walk(items, at, inside, refused);
        inside.insert(after.begin(), after.end());
      }
      now.insert(inside.begin(), inside.end());
    }
  }
  return now;
}

/// The program, and the line or number of each move.
std::string program_text(ProgramLanguage language, const std::vector<Item>& items, std::vector<std::size_t>& places) {
  std::string text, positions;
  std::vector<bool> loops;
  std::size_t line = 2, number = 0;
  const auto pick = [&](const char* rapid, const char* krl, const char* urscript, const char* fanuc) {
    const char* const each[] = {rapid, krl, urscript, fanuc};
    return std::string(each[static_cast<int>(language)]);
  };
  for (std::size_t k = 0; k < items.size(); ++k) {
    const Item& one = items[k];
    std::string out = one.text;
    if (one.kind == Item::Kind::move) {
      ++number;
      out = pick(one.linear ? "MoveL " : "MoveJ ", one.linear ? "LIN " : "PTP ", one.linear ? "movel(" : "movej(",
                 one.linear ? "   1:L P[" : "   1:J P[") +
            pick("[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;",
                 "{X 1,Y 2,Z 3,A 0,B 0,C 0,S 2,T 2}", "p[1,2,3,0,0,0])", "");
      if (language == ProgramLanguage::fanuc_tp) {
        out += message(number, one.linear ? "] 5mm/sec FINE ;" : "] 5% FINE ;");
        positions += message("P[", number,
                             "]{\n GP1:\n UF : 0, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n X = 1 mm, Y = 2 mm, Z = 3 mm,\n "
                             "W = 1 deg, P = 2 deg, R = 3 deg\n};\n");
      }
      places[k] = language == ProgramLanguage::fanuc_tp ? number : line + 1;
    } else if (one.kind == Item::Kind::open) {
      loops.push_back(one.loop);
      out = one.loop ? pick("WHILE TRUE DO", "LOOP", "while True:", "   1:  FOR R[1]=1 TO 2 ;")
                     : pick("IF x>1 THEN", "IF x>1 THEN", "if x>1:", "   1:  IF (R[1]=1) THEN ;");
    } else if (one.kind == Item::Kind::close) {
      out = loops.back() ? pick("ENDWHILE", "ENDLOOP", "end", "   1:  ENDFOR ;")
                         : pick("ENDIF", "ENDIF", "end", "   1:  ENDIF ;");
      loops.pop_back();
    }
    text += out + "\n";
    ++line;
  }
  for (; !loops.empty(); loops.pop_back())
    text += loops.back() ? pick("ENDWHILE\n", "ENDLOOP\n", "end\n", "   1:  ENDFOR ;\n")
                         : pick("ENDIF\n", "ENDIF\n", "end\n", "   1:  ENDIF ;\n");
  return pick("MODULE m\nPROC main()\n", "&REL 1\nDEF m()\n", "# m\ndef m():\n", "/PROG M\n/MN\n") + text +
         pick("ENDPROC\nENDMODULE\n", "END\n", "end\n", "/POS\n") + positions + (positions.empty() ? "" : "/END\n");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Dialect> dialects{dialect(ProgramLanguage::rapid), dialect(ProgramLanguage::krl),
                                             dialect(ProgramLanguage::urscript), dialect(ProgramLanguage::fanuc_tp)};
  Choices choices(data, std::min<std::size_t>(size, 400));
  const Dialect& dialect = dialects[choices.below(4)];
  std::vector<Item> items;
  std::size_t depth = 0;
  while (choices.any()) items.push_back(item(dialect, choices, depth));
  std::vector<bool> refused(items.size(), false);
  std::vector<std::size_t> places(items.size(), 0);
  const std::string text = program_text(dialect.language, items, places);
  std::size_t at = 0;
  walk(items, at, {}, refused);
  const RobotProgram program = parse_program(dialect.language, text, "m");
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (items[k].kind != Item::Kind::move) continue;
    const auto is_it = [&](std::size_t line, const std::string& name) {
      return dialect.language == ProgramLanguage::fanuc_tp ? name == message("P[", places[k], "]") : line == places[k];
    };
    const bool corrected = std::any_of(program.targets.begin(), program.targets.end(),
                                       [&](const ProgramTarget& target) { return is_it(target.line, target.name); });
    const bool listed = std::any_of(program.uncorrected.begin(), program.uncorrected.end(),
                                    [&](const Uncorrected& one) { return is_it(one.line, one.text); });
    if (refused[k] && corrected) fuzz::finding("a target that is void is corrected", text);
    if (refused[k] && !listed) fuzz::finding("a target that is void is not listed", text);
    if (!refused[k] && !corrected) fuzz::finding("a target that nothing voids is not corrected", text);
  }
  return 0;
}
