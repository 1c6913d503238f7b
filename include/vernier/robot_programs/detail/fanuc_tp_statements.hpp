// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Statements of Fanuc TP: first words of instructions, options of moves. Data alone: the guide has this table, too.

#include <string_view>

#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

/// First words, of assignments the names of what they change.
inline constexpr std::string_view fanuc_harmless =
    "r pr sr ar ai ao di do f fi gi go m plm ri ro si so ui uo wi wo wsi wso timer timer_overflow override ualm "
    "message wait pause abort end rsr lock unlock joint_max_speed linear_max_speed payload error_prog resume_prog "
    "maint_prog clear_resume_prog return_path_dsbl col arc weld weave vr strlen findstr substr vision $waittmout "
    "$waitrelmt $mcr.$genoverride";

/// Other instructions.
inline constexpr ProgramStatement fanuc_statements[] = {
    {"skip", "condition", StatementClass::harmless},
    {"offset", "condition", StatementClass::harmless},
    {"tool_offset", "condition", StatementClass::harmless},
    {"voffset", "condition", StatementClass::harmless},
    {"uframe", "", StatementClass::voids, ProgramState::frame_data},
    {"utool", "", StatementClass::voids, ProgramState::frame_data},
    {"softfloat", "end", StatementClass::ends, ProgramState::following},
    {"softfloat", "", StatementClass::voids, ProgramState::following},
    {"touch", "offset", StatementClass::voids, ProgramState::displacement},
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
