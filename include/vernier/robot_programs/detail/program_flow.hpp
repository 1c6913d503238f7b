// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What holds where a program moves: statements set it, and conditions, loops, jumps and calls decide where it arrives.

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// What the meaning of a target depends on, beside its numbers.
enum class ProgramState : unsigned char {
  tool,           ///< the tool of poses
  workobject,     ///< the work object of poses
  joint_moves,    ///< whether configurations count in joint moves
  linear_moves,   ///< whether configurations count in linear moves
  displacement,   ///< an offset of all poses
  orientation,    ///< whether linear moves reach the orientations of poses
  external_axes,  ///< an offset of external axes
  external_tool,  ///< whether the arm holds the tool
  tracking,       ///< whether work objects follow something that moves
  frame_data,     ///< frames behind the names and numbers of tools and work objects
  following,      ///< whether the arm gives way to forces
  everything,     ///< all targets
};
inline constexpr std::size_t program_states = 12;  ///< their number

/// The value of a state: a name, or why it is not known.
struct StateValue {
  std::string name{};    ///< empty: as at the beginning of a program
  std::string reason{};  ///< why it is not known; empty where it is
  std::size_t line = 0;  ///< of the statement that sets it
};

/// The statements of a program as far as they set states, with its routines, blocks, jumps and calls.
///
/// A point gets the value of every way that may lead there. Where the ways differ, the value is not known. A block may
/// be passed over; a loop may be repeated; a jump may fall through. A call does what the routine does. A routine begins
/// with what holds at its calls, or as a program does if nothing calls it. What a routine sets that may run at any time
/// (traps, interrupts, threads, error handlers) may hold at every point.
class ProgramFlow {
 public:
  VERNIER_API ProgramFlow();

  /// Begins a routine within the present one.
  VERNIER_API void begin(const std::string& name, bool any_time);
  /// Ends it; statements belong to the one around it again.
  VERNIER_API void end();
  void open(bool loop) { add({loop ? Kind::loop : Kind::block, {}, {}, 0}); }  ///< a block begins
  void branch() { add({Kind::branch, {}, {}, 0}); }                            ///< another branch of it begins
  void close() { add({Kind::close, {}, {}, 0}); }                              ///< it ends
  void leave_loop() { add({Kind::leave_loop, {}, {}, 0}); }                    ///< its innermost loop may end or repeat
  void leave_routine() { add({Kind::leave_routine, {}, {}, 0}); }              ///< the routine may end
  void label(const std::string& name) { add({Kind::label, {}, name, 0}); }     ///< a label stands here
  void jump(const std::string& name) { add({Kind::jump, {}, name, 0}); }       ///< to a label; empty: to any
  void call(const std::string& name) { add({Kind::call, {}, name, 0}); }       ///< of a routine of this program
  /// The program may begin anew, with the states that it has set: at this routine, or where the file does not have it,
  /// at any that nothing calls.
  void restart(const std::string& name) { restart_ = name; }
  /// A state has a value from here on.
  VERNIER_API void set(ProgramState state, const StateValue& value);
  /// Data of this name, which are no state, are set here.
  VERNIER_API void set_data(const std::string& name, const StateValue& value);
  static constexpr std::size_t most_data = program_states - 1;  ///< most names that `of_data` follows at once
  /// The solved flow of data instead of states, of a flow that is not solved.
  VERNIER_API ProgramFlow of_data(const std::vector<std::string>& names) const;
  /// Whether every way to a point sets the data with this place among those names.
  VERNIER_API bool is_set(std::size_t point, std::size_t data) const;
  /// A place to ask for.
  VERNIER_API std::size_t point();

  /// Finds what holds at each point.
  VERNIER_API void solve();
  /// The value of a state at a point, once solved.
  VERNIER_API StateValue at(std::size_t point, ProgramState state) const;

 private:
  enum class Kind : unsigned char {
    block,
    loop,
    branch,
    close,
    leave_loop,
    leave_routine,
    label,
    jump,
    call,
    set,
    set_data,
    point
  };
  static constexpr int none = -1, several = -2;  // no other value; routines of one name

  struct Event {
    Kind kind;
    ProgramState state;
    std::string name;  // of a label, routine or data
    int value;         // of a state, or number of a point
  };
  struct Element {  // values that may hold: that at the beginning of the routine, and another one
    bool entry = false;
    int value = none;
    bool operator==(const Element&) const = default;
  };
  using State = std::array<Element, program_states>;
  struct Routine {
    bool any_time = false, called = false, recursive = false;
    enum class Progress : unsigned char { fresh, active, done } progress = Progress::fresh;
    std::vector<Event> events{};
    State exit{};     // what a call does
    State touched{};  // every value that it sets
    State entry{};    // what holds at its calls
    std::vector<std::pair<std::size_t, State>> calls{};
  };
  struct Place {
    std::size_t routine = 0;
    State state{};
  };
  struct Block {
    bool loop;
    std::size_t event;
    State before, after;
  };

  void add(Event event) { routines_[open_.back()].events.push_back(std::move(event)); }
  static std::size_t index(ProgramState state) { return static_cast<std::size_t>(state); }
  VERNIER_API static StateValue different(const StateValue& a, const StateValue& b);
  VERNIER_API int kept(const StateValue& value);
  VERNIER_API int joined(int a, int b);
  VERNIER_API bool join(State& to, const State& from);
  VERNIER_API State after(const State& before, const State& change);
  VERNIER_API void run(std::size_t routine, std::size_t depth);
  VERNIER_API bool pass(std::size_t routine, std::size_t depth, std::map<std::string, State>& labels,
                        std::map<std::size_t, State>& loops);
  VERNIER_API State called(std::size_t from, const Event& call, const State& state, std::size_t depth);

  std::vector<Routine> routines_{};
  std::vector<std::size_t> open_{};  // routines around the present statement
  std::map<std::string, int> by_name_{};
  std::vector<StateValue> values_{};
  std::map<std::pair<std::string, std::string>, int> known_values_{};
  std::vector<Place> places_{};
  std::vector<std::size_t> finished_{};  // routines, callees first
  State beginning_{}, any_time_{};
  int unfollowed_ = none;  // the value after a call that is not followed
  std::string restart_{};  // the routine at which the program may begin anew; empty: it does not
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/program_flow.ipp"
#endif
