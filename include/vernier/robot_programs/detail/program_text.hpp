// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Tokens of robot programs, and what the readers of all languages share.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/robot_programs/program_target.hpp"

namespace vernier::detail {

/// A word, number or sign of a program.
struct ProgramToken {
  /// What it is.
  enum class Kind : unsigned char { word, number, text, sign, line_end } kind;
  std::size_t begin, end;   ///< bytes
  std::size_t line;         ///< counted from 1
  double value = 0;         ///< of a number
  std::size_t partner = 0;  ///< of an opening bracket: the token that closes it; 0 where none does
};

/// What marks a comment and quotes a text in a language.
struct ProgramSyntax {
  std::string_view comments;  ///< characters that begin a comment, to the end of the line
  std::string_view quotes;    ///< characters that begin and end a text
  bool lines = true;          ///< whether the end of a line ends a statement, and is a token
};

/// Bracketed values, `[[1,2],[x]]`, or a single one.
struct BracketValue {
  bool group = false;                  ///< whether it is bracketed
  std::vector<BracketValue> values{};  ///< of a group
  std::optional<double> number{};      ///< of a single one that is a number
  ByteRange range{0, 0};               ///< where it stands
  std::size_t token = 0;               ///< its first one
  std::size_t line = 0;                ///< its line

  /// Whether it is a group of n numbers.
  bool numbers(std::size_t n) const {
    if (!group || values.size() != n) return false;
    for (const BracketValue& value : values)
      if (!value.number) return false;
    return true;
  }
};

/// A move of a program, in the order of the text.
struct ProgramStep {
  std::optional<std::size_t> target;  ///< index of its literal; none where it has none, and where the order ends
  std::string tool, workobject;       ///< empty where unknown
  TargetMove move;                    ///< its kind
  bool element = false;               ///< one of several literals that it may use: no order is known
  static constexpr std::size_t no_point = static_cast<std::size_t>(-1);
  std::size_t point = no_point;  ///< where it is in the program's flow
  std::string unknown{};         ///< why what its target means is not known; empty where it is
};

/// Most moves, those that several literals serve counted as many times.
inline constexpr std::size_t most_steps = 1'000'000;
/// Adds a step, unless there are too many already; `use_targets` refuses those.
VERNIER_API inline void add_step(std::vector<ProgramStep>& steps, const ProgramStep& step) {
  if (steps.size() <= most_steps) steps.push_back(step);
}

/// The text of a program and its tokens, and what is found in it.
class ProgramText {
 public:
  /// @throws DataError for binary data and what exceeds the limits
  VERNIER_API static ProgramText of(std::string_view text, const std::string& name, const ProgramSyntax& syntax);

  std::string_view text{};             ///< all of it
  std::string name{};                  ///< of the file
  std::vector<ProgramToken> tokens{};  ///< the last one is a line end

  /// The bytes of a token.
  std::string_view at(std::size_t i) const { return text.substr(tokens[i].begin, tokens[i].end - tokens[i].begin); }
  /// Whether token i is this sign.
  bool is(std::size_t i, char sign) const {
    return i < tokens.size() && tokens[i].kind == ProgramToken::Kind::sign && text[tokens[i].begin] == sign;
  }
  /// Whether token i is a word.
  bool is_word(std::size_t i) const { return i < tokens.size() && tokens[i].kind == ProgramToken::Kind::word; }
  /// Whether token i ends a line.
  bool is_line_end(std::size_t i) const { return tokens[i].kind == ProgramToken::Kind::line_end; }
};

/// Whether a character may be part of a word.
VERNIER_API inline bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '$' ||
         static_cast<signed char>(c) < 0;
}
/// A DataError about a line.
VERNIER_API [[noreturn]] void fail_at(const ProgramText& text, std::size_t line, const std::string& what);
/// In lower-case letters.
VERNIER_API std::string lower_case(std::string_view word);
/// Printable characters, at most 60.
VERNIER_API std::string excerpt(std::string_view text);
/// From one token to before another.
VERNIER_API std::string excerpt(const ProgramText& text, std::size_t first, std::size_t last);
/// A number with its sign at token i; `next` is the token behind it.
VERNIER_API std::optional<double> signed_number(const ProgramText& text, std::size_t i, std::size_t& next,
                                                ByteRange& range);
/// The value that begins at token i, which is `[`; i is then behind it.
/// @param terminator sign that ends a statement, which may not occur inside; 0: none
VERNIER_API BracketValue read_brackets(const ProgramText& text, std::size_t& i, char terminator);
/// The token behind the bracket that closes the one at token i, at most `stop`; i itself where that is none.
VERNIER_API std::size_t behind_brackets(const ProgramText& text, std::size_t i, std::size_t stop);
/// Sets line and column of a target by its first byte.
VERNIER_API void place(const ProgramText& text, std::size_t byte, std::size_t line, ProgramTarget& target);

/// Gives targets what the moves say about them and sorts them by first use.
/// @param steps     moves in order
/// @param keep      of each target: whether it is one even where no move uses it
/// @param program   a target without ranges of numbers stays as it is; its reader has listed it
VERNIER_API void use_targets(const ProgramText& text, const std::vector<ProgramStep>& steps,
                             const std::vector<bool>& keep, RobotProgram& program);

/// Puts remarks into the order of lines; those of one line keep their order.
VERNIER_API void sort_by_line(std::vector<Uncorrected>& remarks);

/// R = Rz(a) Ry(b) Rx(c) of angles [rad]: KUKA's A, B, C; Fanuc's R, P, W.
VERNIER_API Matrix3 rotation_of_zyx(double a, double b, double c);
/// Those angles, b within a quarter turn; c = 0 where b is one.
VERNIER_API Vector3 zyx_of_rotation(const Matrix3& rotation);
/// A frame of a position [mm] and a quaternion, scalar first; none where that is far from a unit quaternion.
VERNIER_API std::optional<Isometry3> frame_of_quaternion(const Vector3& mm, const Eigen::Vector4d& quaternion);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/program_text.ipp"
#endif
