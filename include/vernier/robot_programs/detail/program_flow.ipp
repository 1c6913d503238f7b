// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/robot_programs/detail/program_flow.hpp"

namespace vernier::detail {

VERNIER_IMPL ProgramFlow::ProgramFlow() {
  for (Element& element : beginning_) element = {false, kept({})};
  unfollowed_ = kept({{}, "routines of one name, or that call each other, are not followed", 0});
  routines_.emplace_back();
  open_.push_back(0);
}

VERNIER_IMPL void ProgramFlow::begin(const std::string& name, bool any_time) {
  open_.push_back(routines_.size());
  const auto [found, added] = by_name_.try_emplace(name, static_cast<int>(routines_.size()));
  if (!added) found->second = several;
  routines_.emplace_back();
  routines_.back().any_time = any_time;
}

VERNIER_IMPL void ProgramFlow::end() {
  if (open_.size() > 1) open_.pop_back();
}

VERNIER_IMPL void ProgramFlow::set(ProgramState state, const StateValue& value) {
  add({Kind::set, state, {}, kept(value)});
}

VERNIER_IMPL void ProgramFlow::set_data(const std::string& name, const StateValue& value) {
  add({Kind::set_data, {}, name, kept(value)});
}

VERNIER_IMPL ProgramFlow ProgramFlow::of_data(const std::vector<std::string>& names) const {
  ProgramFlow out = *this;
  for (Routine& routine : out.routines_) {
    std::erase_if(routine.events, [](const Event& event) { return event.kind == Kind::set; });
    for (Event& event : routine.events) {
      if (event.kind != Kind::set_data) continue;
      const auto found = std::find(names.begin(), names.end(), event.name);
      if (found == names.end()) continue;
      event.kind = Kind::set;
      event.state = static_cast<ProgramState>(found - names.begin());
    }
  }
  out.solve();
  return out;
}

VERNIER_IMPL bool ProgramFlow::is_set(std::size_t point, std::size_t data) const {
  const StateValue value = at(point, static_cast<ProgramState>(data));
  return value.reason.empty() && !value.name.empty() && at(point, ProgramState::everything).reason.empty();
}

VERNIER_IMPL std::size_t ProgramFlow::point() {
  add({Kind::point, {}, {}, static_cast<int>(places_.size())});
  places_.push_back({open_.back(), {}});
  return places_.size() - 1;
}

/// The index of a value; equal names are one, wherever they are set.
VERNIER_IMPL int ProgramFlow::kept(const StateValue& value) {
  const auto [found, added] = known_values_.try_emplace({value.name, value.reason}, static_cast<int>(values_.size()));
  if (added) values_.push_back(value);
  return found->second;
}

/// One of two values that are known, nobody knows which.
VERNIER_IMPL StateValue ProgramFlow::different(const StateValue& a, const StateValue& b) {
  const std::size_t line = (std::max)(a.line, b.line);
  return {{}, message("line ", line, " sets the tool or work object, but not on all ways there"), line};
}

/// One of two values; none where there is no other one.
VERNIER_IMPL int ProgramFlow::joined(int a, int b) {
  if (a == b || b == none) return a;
  if (a == none) return b;
  const StateValue &one = values_[static_cast<std::size_t>(a)], &other = values_[static_cast<std::size_t>(b)];
  if (!one.reason.empty() && !other.reason.empty()) return (std::min)(a, b);
  if (!one.reason.empty()) return a;
  if (!other.reason.empty()) return b;
  return kept(different(one, other));
}

/// Adds what may hold on another way; whether that changes anything.
VERNIER_IMPL bool ProgramFlow::join(State& to, const State& from) {
  bool changed = false;
  for (std::size_t s = 0; s < program_states; ++s) {
    const Element old = to[s];
    to[s] = {old.entry || from[s].entry, joined(old.value, from[s].value)};
    changed = changed || !(to[s] == old);
  }
  return changed;
}

/// What holds after a change: where that keeps the value at its beginning, the one before.
VERNIER_IMPL ProgramFlow::State ProgramFlow::after(const State& before, const State& change) {
  State out = change;
  for (std::size_t s = 0; s < program_states; ++s)
    if (change[s].entry) out[s] = {before[s].entry, joined(before[s].value, change[s].value)};
  return out;
}

/// The state behind a call.
VERNIER_IMPL ProgramFlow::State ProgramFlow::called(std::size_t from, const Event& call, const State& state,
                                                    std::size_t depth) {
  constexpr std::size_t deepest = 100;
  const auto found = by_name_.find(call.name);
  if (found == by_name_.end()) return state;
  if (found->second != several) {
    const auto callee = static_cast<std::size_t>(found->second);
    routines_[callee].called = true;
    routines_[from].calls.emplace_back(callee, state);
    if (routines_[callee].progress == Routine::Progress::fresh && depth < deepest) run(callee, depth + 1);
    if (routines_[callee].progress == Routine::Progress::done) {
      join(routines_[from].touched, routines_[callee].touched);
      return after(state, routines_[callee].exit);
    }
    routines_[callee].recursive = true;
  }
  State lost{};
  lost[index(ProgramState::everything)] = {false, unfollowed_};
  join(routines_[from].touched, lost);
  State out = state;
  out[index(ProgramState::everything)] = {false, unfollowed_};
  return out;
}

/// Finds what a routine does.
VERNIER_IMPL void ProgramFlow::run(std::size_t routine, std::size_t depth) {
  constexpr int most_passes = 50;
  routines_[routine].progress = Routine::Progress::active;
  std::map<std::string, State> labels;
  std::map<std::size_t, State> loops;
  int passes = 0;
  while (pass(routine, depth, labels, loops) && ++passes < most_passes) {
  }
  if (passes == most_passes) {  // loops nested so deeply that values still arrive
    for (const Event& event : routines_[routine].events)
      if (event.kind == Kind::point)
        places_[static_cast<std::size_t>(event.value)].state[index(ProgramState::everything)] = {false, unfollowed_};
    routines_[routine].exit[index(ProgramState::everything)] = {false, unfollowed_};
  }
  routines_[routine].progress = Routine::Progress::done;
  finished_.push_back(routine);
}

/// Walks through a routine once; whether a label or loop gets more than before.
VERNIER_IMPL bool ProgramFlow::pass(std::size_t routine, std::size_t depth, std::map<std::string, State>& labels,
                                    std::map<std::size_t, State>& loops) {
  constexpr std::size_t deepest = 1000;  // blocks
  bool changed = false;
  State now, exit{};
  for (Element& element : now) element.entry = true;
  routines_[routine].calls.clear();
  std::vector<Block> blocks;
  std::vector<std::size_t> open_loops;  // of the blocks
  std::size_t too_deep = 0;
  const auto repeat = [&](std::size_t loop) { changed = join(loops[loop], now) || changed; };
  for (std::size_t e = 0; e < routines_[routine].events.size(); ++e) {
    const Event event = routines_[routine].events[e];
    switch (event.kind) {
      case Kind::block:
      case Kind::loop:
        if (blocks.size() == deepest) {
          ++too_deep;
          now[index(ProgramState::everything)] = {false, unfollowed_};
          break;
        }
        if (event.kind == Kind::loop) {
          join(now, loops[e]);
          open_loops.push_back(blocks.size());
        }
        blocks.push_back({event.kind == Kind::loop, e, now, now});
        break;
      case Kind::branch:
        if (blocks.empty() || too_deep > 0) break;
        join(blocks.back().after, now);
        now = blocks.back().before;
        break;
      case Kind::close:
        if (too_deep > 0)
          --too_deep;
        else if (!blocks.empty()) {
          join(blocks.back().after, now);
          if (blocks.back().loop) {
            repeat(blocks.back().event);
            open_loops.pop_back();
          }
          now = blocks.back().after;
          blocks.pop_back();
        }
        break;
      case Kind::leave_loop:
        if (open_loops.empty()) break;
        repeat(blocks[open_loops.back()].event);
        join(blocks[open_loops.back()].after, now);
        break;
      case Kind::leave_routine: join(exit, now); break;
      case Kind::label:
        changed = join(labels[event.name], now) || changed;
        now = labels[event.name];
        join(now, labels[{}]);
        break;
      case Kind::jump: changed = join(labels[event.name], now) || changed; break;
      case Kind::call: now = called(routine, event, now, depth); break;
      case Kind::set: {
        State only{};
        only[index(event.state)] = {false, event.value};
        join(routines_[routine].touched, only);
        now[index(event.state)] = {false, event.value};
        break;
      }
      case Kind::set_data: break;
      case Kind::point: places_[static_cast<std::size_t>(event.value)].state = now; break;
    }
  }
  join(exit, now);
  routines_[routine].exit = exit;
  return changed;
}

VERNIER_IMPL void ProgramFlow::solve() {
  for (std::size_t r = 0; r < routines_.size(); ++r)
    if (routines_[r].progress == Routine::Progress::fresh) run(r, 0);
  const auto values_only = [](State state) {
    for (Element& element : state) element.entry = false;
    return state;
  };
  State anywhere = beginning_;
  for (const Routine& routine : routines_) {
    join(anywhere, values_only(routine.touched));
    if (routine.any_time) join(any_time_, values_only(routine.touched));
  }
  const auto restart = by_name_.find(restart_);
  const int first = restart == by_name_.end() ? several : restart->second;
  for (std::size_t k = finished_.size(); k-- > 0;) {  // callers first
    Routine& routine = routines_[finished_[k]];
    const bool anew = first == several ? !routine.called : first == static_cast<int>(finished_[k]);
    if (routine.any_time || (anew && !restart_.empty())) routine.entry = anywhere;
    if (!routine.called) join(routine.entry, beginning_);
    if (routine.recursive) {
      join(routine.entry, anywhere);
      routine.entry[index(ProgramState::everything)] = {false, unfollowed_};
    }
    for (const auto& [callee, state] : routine.calls) join(routines_[callee].entry, after(routine.entry, state));
  }
}

VERNIER_IMPL StateValue ProgramFlow::at(std::size_t point, ProgramState state) const {
  const Place& place = places_[point];
  const Element here = place.state[index(state)], before = routines_[place.routine].entry[index(state)];
  StateValue out;
  bool first = true;
  for (const int may : {here.value, here.entry ? before.value : none, any_time_[index(state)].value}) {
    if (may == none) continue;
    const StateValue& value = values_[static_cast<std::size_t>(may)];
    if (!value.reason.empty()) return value;
    if (!first && value.name != out.name) return different(value, out);
    out = value;
    first = false;
  }
  return out;
}

}  // namespace vernier::detail
