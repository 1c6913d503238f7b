// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/robot_programs/detail/statement_reader.hpp"

namespace vernier::detail {

VERNIER_IMPL void StatementReader::lose(ProgramState state, std::size_t line, const std::string& statement) {
  flow_.set(state, {{}, message("line ", line, ", ", statement, ": ", reason_of(state)), line});
}

VERNIER_IMPL void StatementReader::unknown(std::size_t line, const std::string& statement) {
  program_.uncorrected.push_back(
      {line, statement, std::string(reason_of(ProgramState::everything)), MissingInput::effect});
  lose(ProgramState::everything, line, statement);
  break_order();
}

VERNIER_IMPL StatementClass StatementReader::apply(std::size_t line, const std::string& name, const std::string& option,
                                                   const std::string& statement) {
  const ProgramStatement row = statements_.find(name, option);
  switch (row.kind) {
    case StatementClass::ends: flow_.set(row.state, {{}, {}, line}); break;
    case StatementClass::voids: lose(row.state, line, statement); break;
    case StatementClass::moves:
      remark(line, statement, "a move without a target of its own");
      break_order();
      break;
    case StatementClass::unknown: unknown(line, statement); break;
    case StatementClass::harmless:
    case StatementClass::own: break;
  }
  return row.kind;
}

VERNIER_IMPL bool matters(ProgramState state, TargetKind kind, TargetMove move) {
  switch (state) {
    case ProgramState::everything:
    case ProgramState::following: return true;
    case ProgramState::joint_moves: return kind == TargetKind::pose && move == TargetMove::joint;
    case ProgramState::linear_moves:
    case ProgramState::orientation: return kind == TargetKind::pose && move == TargetMove::linear;
    default: return kind == TargetKind::pose;
  }
}

VERNIER_IMPL std::string StatementReader::named_frame(ProgramState state, std::string name, const Isometry3& frame) {
  auto& frames = state == ProgramState::tool ? program_.tools : program_.workobjects;
  std::array<double, 16> numbers;
  std::copy_n(frame.data(), numbers.size(), numbers.begin());
  while (frames.count(name) != 0) name += '*';
  const auto [found, added] = named_.try_emplace({state, numbers}, name);
  if (added) frames[name] = frame;
  return found->second;
}

VERNIER_IMPL std::string StatementReader::scoped(const std::string& name, std::size_t scope) const {
  return locals_[scope].count(name) != 0 ? message(name, '@', scope) : name;
}

VERNIER_IMPL void StatementReader::drop(const std::vector<bool>& dropped) {
  std::vector<std::size_t> index(dropped.size());
  std::vector<ProgramTarget> kept;
  for (std::size_t k = 0; k < dropped.size(); ++k) {
    index[k] = kept.size();
    if (!dropped[k]) kept.push_back(std::move(program_.targets[k]));
  }
  program_.targets = std::move(kept);
  for (ProgramStep& step : steps_) {
    if (!step.target) continue;
    if (dropped[*step.target])
      step.target.reset();
    else
      step.target = index[*step.target];
  }
}

VERNIER_IMPL void StatementReader::solve() {
  flow_.solve();
  for (ProgramStep& step : steps_) {
    if (!step.target || step.point == ProgramStep::no_point) continue;
    const TargetKind kind = program_.targets[*step.target].kind;
    const bool own_tool = !step.tool.empty(), own_object = !step.workobject.empty();
    for (std::size_t s = 0; s < program_states; ++s) {
      const auto state = static_cast<ProgramState>(s);
      if (!matters(state, kind, step.move)) continue;
      if ((state == ProgramState::tool && own_tool) || (state == ProgramState::workobject && own_object)) continue;
      const StateValue value = flow_.at(step.point, state);
      if (!value.reason.empty() && step.unknown.empty()) step.unknown = value.reason;
      if (value.name.empty()) continue;
      if (state == ProgramState::tool) step.tool = value.name;
      if (state == ProgramState::workobject) step.workobject = value.name;
    }
  }
}

}  // namespace vernier::detail
