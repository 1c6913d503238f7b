// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Statements of Fanuc TP: first words of instructions, options of moves. Data alone: the guide has this table, too.

#include <string_view>

#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

/// Words in front of [ or =, of assignments the names of what they change. Another word behind them makes the name of a
/// macro: GO HOME.
inline constexpr std::string_view fanuc_harmless =
    "r pr sr ar ai ao di do f fi gi go m plm ri ro si so ui uo wi wo wsi wso timer timer_overflow override ualm "
    "message rsr joint_max_speed linear_max_speed payload error_prog resume_prog maint_prog vr $waittmout $waitrelmt "
    "$mcr.$genoverride";

/// Other instructions, and what applications state in front of them. Harmless ones have exactly this rest: `#` is a
/// number or register, `?` a condition, `..` anything; what stands in brackets and quotes is left out.
inline constexpr ProgramStatement fanuc_statements[] = {
    {"wait", "#(sec)", StatementClass::harmless},
    {"wait", "?", StatementClass::harmless},
    {"pause", "", StatementClass::harmless},
    {"abort", "", StatementClass::harmless},
    {"end", "", StatementClass::harmless},
    {"monitor", "end ..", StatementClass::harmless},
    {"lock", "preg", StatementClass::harmless},
    {"unlock", "preg", StatementClass::harmless},
    {"lock", "vreg", StatementClass::harmless},
    {"unlock", "vreg", StatementClass::harmless},
    {"clear_resume_prog", "", StatementClass::harmless},
    {"return_path_dsbl", "", StatementClass::harmless},
    {"col", "detect on", StatementClass::harmless},
    {"col", "detect off", StatementClass::harmless},
    {"col", "guard adjust", StatementClass::harmless},
    {"col", "guard adjust #", StatementClass::harmless},
    {"col", "guard adjust #%", StatementClass::harmless},
    {"arc", "start[]", StatementClass::harmless},
    {"arc", "start e#[]", StatementClass::harmless},
    {"arc", "end[]", StatementClass::harmless},
    {"arc", "end e#[]", StatementClass::harmless},
    {"weld", "start[]", StatementClass::harmless},
    {"weld", "start e#[]", StatementClass::harmless},
    {"weld", "end[]", StatementClass::harmless},
    {"weld", "end e#[]", StatementClass::harmless},
    {"weave", "sine[]", StatementClass::harmless},
    {"weave", "sine #[]", StatementClass::harmless},
    {"weave", "circle[]", StatementClass::harmless},
    {"weave", "figure 8[]", StatementClass::harmless},
    {"weave", "l[]", StatementClass::harmless},
    {"weave", "end", StatementClass::harmless},
    {"weave", "end[]", StatementClass::harmless},
    {"vision", "run_find ''..", StatementClass::harmless},
    {"vision", "get_offset ''..", StatementClass::harmless},
    {"vision", "get_nfound ''..", StatementClass::harmless},
    {"vision", "get_passfail ''..", StatementClass::harmless},
    {"vision", "get_reading ''..", StatementClass::harmless},
    {"vision", "set_reference ''..", StatementClass::harmless},
    {"vision", "override ''..", StatementClass::harmless},
    {"skip", "condition ?", StatementClass::harmless},
    {"offset", "condition pr[]..", StatementClass::harmless},
    {"tool_offset", "condition pr[]..", StatementClass::harmless},
    {"voffset", "condition vr[]..", StatementClass::harmless},
    {"line_track_schedule_number", "0", StatementClass::harmless},
    {"line_track_schedule_number", "*", StatementClass::voids, ProgramState::tracking},
    {"enable_singularity_avoidance", "true", StatementClass::voids, ProgramState::orientation},
    {"pltz_mode_enable", "true", StatementClass::voids, ProgramState::everything},
    {"uframe", "", StatementClass::voids, ProgramState::frame_data},
    {"utool", "", StatementClass::voids, ProgramState::frame_data},
    {"softfloat", "end", StatementClass::ends, ProgramState::following},
    {"softfloat", "", StatementClass::voids, ProgramState::following},
    {"touch", "offset ..", StatementClass::voids, ProgramState::displacement},
    {"track", "*", StatementClass::voids, ProgramState::everything},
    {"line", "*", StatementClass::voids, ProgramState::everything},
    {"stop_tracking", "*", StatementClass::voids, ProgramState::everything},
};

/// Words behind the speed of a move that leave its positions as they are.
inline constexpr std::string_view fanuc_move_options =
    "fine cnt cd cr acc pth break skip skipjump lbl ta tb db ap_ld rt_ld alim pspd ev ind arc weld start end sec msec "
    "mm cm min inch deg r ar weld_speed max_speed time before after distance point_logic do ro go ao f on off pulse "
    "pr";

}  // namespace vernier::detail
