// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the readers of all languages do with statements: those that may change what targets mean are followed.

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vernier/robot_programs/detail/program_flow.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

/// Whether a state matters to a target of a move.
VERNIER_API bool matters(ProgramState state, TargetKind kind, TargetMove move);

/// A reader's statements and moves.
class StatementReader {
 protected:
  /// @param from   the program
  /// @param to     what is found in it
  /// @param table  of the language's statements
  StatementReader(const ProgramText& from, RobotProgram& to, const StatementTable& table)
      : text_(from), program_(to), statements_(table) {}
  ~StatementReader() = default;

  /// A word in lower case; empty where token i is none.
  std::string word(std::size_t i) const { return text_.is_word(i) ? lower_case(text_.at(i)) : std::string(); }
  /// Lists something that is not corrected.
  void remark(std::size_t line, std::string what, std::string reason) {
    program_.uncorrected.push_back({line, std::move(what), std::move(reason)});
  }
  /// A state is not known behind a statement.
  VERNIER_API void lose(ProgramState state, std::size_t line, const std::string& statement);
  /// Lists a statement of which nobody knows what it does, and a call of another file; nothing is known behind it.
  VERNIER_API void unknown(std::size_t line, const std::string& statement);
  /// Does what the table says about a statement.
  /// @param name      in lower case
  /// @param option    likewise
  /// @param statement as it stands, for messages
  VERNIER_API StatementClass apply(std::size_t line, const std::string& name, const std::string& option,
                                   const std::string& statement);
  /// The name of a frame that the text states: the one given, or that of an equal frame stated before.
  VERNIER_API std::string named_frame(ProgramState state, std::string name, const Isometry3& frame);
  /// A routine begins; its parameters and what it declares hide variables of the file.
  void begin_scope(const std::set<std::string>& parameters) {
    scope_ = locals_.size();
    locals_.push_back(parameters);
    parameters_ = parameters;
  }
  /// The routine ends.
  void end_scope() {
    scope_ = 0;
    parameters_.clear();
  }
  /// A variable is declared: of the present routine, if there is one.
  void declare(const std::string& name) {
    if (scope_ != 0) locals_[scope_].insert(name);
  }
  /// The name of a variable, which tells those of a routine from those of the file.
  VERNIER_API std::string scoped(const std::string& name, std::size_t scope) const;
  bool is_parameter(const std::string& name) const { return parameters_.count(name) != 0; }
  /// The order of moves ends: where the arm stands is not known.
  virtual void break_order() { add_step(steps_, {{}, {}, {}, TargetMove::unknown}); }
  /// Takes targets away; moves to them have none.
  VERNIER_API void drop(const std::vector<bool>& dropped);
  /// Gives moves what holds at their points.
  VERNIER_API void solve();

  const ProgramText& text_;
  RobotProgram& program_;
  const StatementTable& statements_;
  ProgramFlow flow_{};
  std::vector<ProgramStep> steps_{};
  std::size_t scope_ = 0;  // of the present routine; 0: the file

 private:
  std::vector<std::set<std::string>> locals_ = std::vector<std::set<std::string>>(1);  // of each scope
  std::set<std::string> parameters_{};                                                 // of the present routine
  std::map<std::pair<ProgramState, std::array<double, 16>>, std::string> named_{};     // frames by their numbers
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/statement_reader.ipp"
#endif
