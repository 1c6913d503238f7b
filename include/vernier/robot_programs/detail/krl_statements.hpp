// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Statements of KRL: statements, system variables, calls of BAS, functions. Data alone: the guide has this table, too.

#include <string_view>

#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

/// System variables whose values mean nothing to targets.
inline constexpr std::string_view krl_harmless =
    "$vel $acc $jerk $apo $advance $ov_pro $ov_appl $vel_axis $acc_axis $jerk_axis $vel_extax $acc_extax $vel_ma "
    "$acc_ma $vel_oric $red_vel $red_vel_c $gear_jerk $collmon_tol_pro $load $load_a1 $load_a2 $load_a3 $act_tool "
    "$act_base $act_ex_ax $cir_type $circ_type $circ_mode $out $outs $anout $timer $timer_stop $timer_flag $flag "
    "$cycflag $h_pos $h_pos_tol $loop_msg $loop_cont $bwdstart $single_step $pro_mode $pro_name $ipo_wait_for "
    "$ipo_wait_for_on $ipo_wait_state $opt_move $spl_tech $cp_vel_type $cp_statmon $cp_spd_fly $torqmon $torqmon_com "
    "$torqmon_def $set_io_size $date $notaus";

/// Statements, system variables and calls of BAS that change what targets mean.
inline constexpr ProgramStatement krl_statements[] = {
    {"$ipo_mode", "#base", StatementClass::ends, ProgramState::external_tool},
    {"$ipo_mode", "*", StatementClass::voids, ProgramState::external_tool},
    {"$ori_type", "#var", StatementClass::ends, ProgramState::orientation},
    {"$ori_type", "#joint", StatementClass::ends, ProgramState::orientation},
    {"$ori_type", "*", StatementClass::voids, ProgramState::orientation},
    {"$robroot", "*", StatementClass::voids, ProgramState::frame_data},
    {"$world", "*", StatementClass::voids, ProgramState::frame_data},
    {"$ersysroot", "*", StatementClass::voids, ProgramState::frame_data},
    {"$target_status", "*", StatementClass::voids, ProgramState::linear_moves},
    {"bas", "#acc_cp", StatementClass::harmless},
    {"bas", "#acc_ptp", StatementClass::harmless},
    {"bas", "#vel_cp", StatementClass::harmless},
    {"bas", "#vel_ptp", StatementClass::harmless},
    {"bas", "#acc_glue", StatementClass::harmless},
    {"bas", "#ptp_dat", StatementClass::harmless},
    {"bas", "#out_sync", StatementClass::harmless},
    {"bas", "#out_async", StatementClass::harmless},
    {"bas", "#group", StatementClass::harmless},
    {"asyptp", "*", StatementClass::voids, ProgramState::everything},
    {"asycont", "*", StatementClass::voids, ProgramState::everything},
    {"move_emi", "*", StatementClass::voids, ProgramState::everything},
};

/// Routines and functions of the controller that leave targets as they are.
inline constexpr std::string_view krl_functions =
    "abs acos asin atan atan2 cos sin sqrt tan eb ek lk sacc_cp sacc_joint sapo sapo_ptp sbase sgear_jerk sipo_mode "
    "sjerk sload sori_typ stool stool2 svel_cp svel_joint use_cm_pro_values forward inverse inv_pos cast_from cast_to "
    "cclose ciocontrol cioctl copen cread cwrite sopen sread swrite sclose err_clear err_raise exists_krldlg "
    "exists_krlmsg clear_krlmsg set_krldlg set_krldlganswer set_krlmsg get_msgbuffer get_sig_inf get_decl_place "
    "getcycdef getsysstate get_system_data getvarsize ioctl ir_stopm ismessageset is_key_pressed m_comment mbx_rec "
    "msgdialog msgnotify msgquit msgstate msgwait pulse remotecmd remoteread rob_stop rob_stop_release "
    "set_brake_delay synccmd cancelprogsync timer_limit varstate vartype wspacegive wspacetake stradd strclear "
    "strcomp strcopy strdecllen strfind strlen strtoaxis strtobool strtoe3axis strtoe3pos strtoe6axis strtoe6pos "
    "strtoframe strtoint strtopos strtoreal strtostring frand asystop asycancel";

/// Words that begin a harmless statement where a word follows; as a call they are routines of another file.
inline constexpr std::string_view krl_words =
    "wait anin anout digin interrupt confirm import brake bool char int real string frame load inertia fdat ldat pdat "
    "signal channel struc enum ext extfct extp extfctp const_vel stop time_block";
/// Words that are a harmless statement by themselves.
inline constexpr std::string_view krl_words_alone = "halt brake on_error_proceed";

/// Beginnings of functions that may change a variable that they are given.
inline constexpr std::string_view krl_inputs = "strto cast_ cread sread get_ mbx_";

}  // namespace vernier::detail
