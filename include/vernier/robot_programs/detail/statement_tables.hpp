// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Statements of robot programs, by what they do to the meaning of targets. Each language has a file of tables beside
/// this one. A statement that is in no table voids, because nobody knows what it does.

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/robot_programs/detail/program_flow.hpp"

namespace vernier::detail {

/// What a statement does.
enum class StatementClass : unsigned char {
  harmless,  ///< nothing to targets
  ends,      ///< its state is as at the beginning of a program
  voids,     ///< its state is not known from here on
  own,       ///< targets among its arguments are not corrected
  moves,     ///< the arm moves without a target
  unknown,   ///< in no table
};

/// A statement that is not harmless.
struct ProgramStatement {
  std::string_view name;    ///< in lower case
  std::string_view option;  ///< its switch, value or second word in lower case; empty: none; `*`: any other one
  StatementClass kind;      ///< what it does
  ProgramState state = ProgramState::everything;  ///< of `ends` and `voids`
};

/// The statements of a language, looked up by name.
class StatementTable {
 public:
  /// @param harmless names of statements to which an option means nothing
  /// @param others   the rest
  /// @param assumed  names that users state to be harmless
  VERNIER_API StatementTable(std::string_view harmless, std::span<const ProgramStatement> others,
                             const std::vector<std::string>& assumed);
  /// What a statement does; unknown where it is in no table.
  VERNIER_API ProgramStatement find(const std::string& name, const std::string& option = {}) const;

 private:
  std::set<std::string, std::less<>> harmless_;
  std::multimap<std::string_view, ProgramStatement> others_{};
};

/// Words that blanks separate.
VERNIER_API std::set<std::string, std::less<>> words_of(std::string_view text);

/// Why a state is not known, behind the statement that sets it.
constexpr std::string_view reason_of(ProgramState state) {
  switch (state) {
    case ProgramState::joint_moves: return "configurations of joint moves do not count";
    case ProgramState::linear_moves: return "configurations of linear moves do not count";
    case ProgramState::displacement: return "positions are displaced";
    case ProgramState::orientation: return "linear moves need not reach their orientation";
    case ProgramState::external_axes: return "external axes are displaced";
    case ProgramState::external_tool: return "the tool stands still";
    case ProgramState::tracking: return "work objects move";
    case ProgramState::frame_data: return "frames are changed";
    case ProgramState::following: return "the arm gives way";
    default: return "what it does to targets is not known";
  }
}

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/statement_tables.ipp"
#endif
