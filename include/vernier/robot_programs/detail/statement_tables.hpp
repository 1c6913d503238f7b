#pragma once

/// @file
/// Statements of the languages of robot programs, by what they do to the meaning of targets. Data alone: the guide has
/// these tables, too. What is in none of them voids, because nobody knows what it does.

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

// ---- RAPID: instructions, options of moves, functions ----

/// Instructions to which an option means nothing more.
inline constexpr std::string_view rapid_harmless =
    "accset acteventbuffer add aliascamera aliasio aliasioreset bitclear bitset bookerrno brakecheck break "
    "cancelload checkprogref cirpathmode clear cleariobuff clearpath clearrawbytes clkreset clkstart clkstop close "
    "closedir connect consolewrite copyfile copyrawbytes cornerpathwarning corrclear corrcon corrdiscon corrwrite "
    "cyclicbrakecheck deacteventbuffer decr egmgetid egmreset egmsetupai egmsetupao egmsetupgi egmsetupltapp "
    "egmsetupuc erasemodule errlog errwrite fricidevaluate fricidinit fricidsetfriclevels "
    "getdataval getgroupsignalinfo getjointdata getsysdata gettorquemargin gettrapdata gripload idelete idisable "
    "ienable ierror incr invertdo iobusstart iobusstate iodisable ioenable ipathpos ipers irmqmessage isignalai "
    "isignalao isignaldi isignaldo isignalgi isignalgo isleep itimer ivarvalue iwatch load makedir matrixsolve "
    "matrixsolveqr matrixsvd mechunitload motionprocessmodeset motionsup open opendir packdnheader packrawbytes "
    "pathacclim pathlengthreset pathlengthstart pathlengthstop pathrecstart pathrecstop pathresol procerrrecovery "
    "pulsedo readanybin readblock readcfgdata readerrdata readrawbytes removeallcyclicbool removecyclicbool removedir "
    "removefile renamefile reset resetaxisdistance resetaxismovetime resetppmoved resetretrycount resettorquemargin "
    "restopath rewind rmqemptyqueue rmqfindslot rmqgetmessage rmqgetmsgdata rmqgetmsgheader rmqreadwait rmqsendmessage "
    "rmqsendwait safetycontrollersyncrequest save scwrite set setao setdatasearch setdo setgo setupcyclicbool siclose "
    "siconnect sigetcyclic sisetcyclic skipwarn socketaccept socketbind socketclose socketconnect socketcreate "
    "socketlisten socketreceive socketreceivefrom socketsend socketsendto speedlimaxis speedlimcheckpoint speedrefresh "
    "spystart spystop startload startmove startmoveretry stclose stop stopen stopmove stopmovereset storepath "
    "systemstopaction testsigndefine testsignreset texttabinstall tperase tpreaddnum tpreadfk tpreadnum tpshow tpwrite "
    "triggcheckio triggdatacopy triggdatareset triggequip triggint triggio triggrampao triggspeed triggstopproc "
    "tunereset tuneservo uimsgbox uimsgwrite uimsgwriteabort uishow unload unpackrawbytes velset waitai waitao waitdi "
    "waitdo waitgi waitgo waitload waitrob waitsynctask waittestandset waittime waituntil warmstart worldacclim write "
    "writeanybin writebin writeblock writecfgdata writerawbytes writestrbin writevar wzboxdef wzcyldef wzdisable "
    "wzdoset wzenable wzfree wzhomejointdef wzlimjointdef wzlimsup wzsphdef arcrefresh camflush camgetparameter "
    "camgetresult camloadjob camreqimage camsetexposure camsetparameter camsetprogrammode camsetrunmode "
    "camstartloadjob camwaitloadjob recoverymenu setbrush setbrushfac settmsignal";

/// Of these, those that change none of their arguments; another one may change a variable that it is given.
inline constexpr std::string_view rapid_outputs = "tpwrite errwrite errlog write uimsgwrite waituntil";

/// Instructions that change what targets mean, or that use them in ways of their own.
inline constexpr ProgramStatement rapid_statements[] = {
    {"confj", "", StatementClass::ends, ProgramState::joint_moves},
    {"confj", "on", StatementClass::ends, ProgramState::joint_moves},
    {"confj", "off", StatementClass::voids, ProgramState::joint_moves},
    {"confl", "", StatementClass::ends, ProgramState::linear_moves},
    {"confl", "on", StatementClass::ends, ProgramState::linear_moves},
    {"confl", "off", StatementClass::voids, ProgramState::linear_moves},
    {"pdispset", "*", StatementClass::voids, ProgramState::displacement},
    {"pdispon", "*", StatementClass::voids, ProgramState::displacement},
    {"pdispoff", "", StatementClass::ends, ProgramState::displacement},
    {"eoffsset", "*", StatementClass::voids, ProgramState::external_axes},
    {"eoffson", "*", StatementClass::voids, ProgramState::external_axes},
    {"eoffsoff", "", StatementClass::ends, ProgramState::external_axes},
    {"singarea", "", StatementClass::ends, ProgramState::orientation},
    {"singarea", "off", StatementClass::ends, ProgramState::orientation},
    {"singarea", "*", StatementClass::voids, ProgramState::orientation},
    {"softact", "*", StatementClass::voids, ProgramState::following},
    {"softdeact", "*", StatementClass::ends, ProgramState::following},
    {"syncmoveon", "*", StatementClass::voids, ProgramState::tracking},
    {"syncmoveoff", "*", StatementClass::ends, ProgramState::tracking},
    {"syncmoveresume", "*", StatementClass::voids, ProgramState::tracking},
    {"syncmovesuspend", "*", StatementClass::voids, ProgramState::tracking},
    {"syncmoveundo", "*", StatementClass::voids, ProgramState::tracking},
    {"waitwobj", "*", StatementClass::voids, ProgramState::frame_data},
    {"dropwobj", "*", StatementClass::voids, ProgramState::frame_data},
    {"waitsensor", "*", StatementClass::voids, ProgramState::frame_data},
    {"dropsensor", "*", StatementClass::voids, ProgramState::frame_data},
    {"synctosensor", "*", StatementClass::voids, ProgramState::everything},
    {"supsyncsensoron", "*", StatementClass::voids, ProgramState::everything},
    {"actunit", "*", StatementClass::voids, ProgramState::frame_data},
    {"deactunit", "*", StatementClass::voids, ProgramState::frame_data},
    {"mtoolrotcalib", "*", StatementClass::voids, ProgramState::frame_data},
    {"mtooltcpcalib", "*", StatementClass::voids, ProgramState::frame_data},
    {"stoolrotcalib", "*", StatementClass::voids, ProgramState::frame_data},
    {"stooltcpcalib", "*", StatementClass::voids, ProgramState::frame_data},
    {"bechecktcp", "*", StatementClass::voids, ProgramState::frame_data},
    {"beupdatetcp", "*", StatementClass::voids, ProgramState::frame_data},
    {"recalctcp", "*", StatementClass::voids, ProgramState::frame_data},
    {"setsysdata", "*", StatementClass::voids, ProgramState::frame_data},
    {"setdataval", "*", StatementClass::voids, ProgramState::everything},
    {"setalldataval", "*", StatementClass::voids, ProgramState::everything},
    {"callbyvar", "*", StatementClass::voids, ProgramState::everything},
    {"softelbow", "*", StatementClass::voids, ProgramState::everything},
    {"cssact", "*", StatementClass::voids, ProgramState::everything},
    {"fcact", "*", StatementClass::voids, ProgramState::everything},
    {"fcrefstart", "*", StatementClass::voids, ProgramState::everything},
    {"egmactjoint", "*", StatementClass::voids, ProgramState::everything},
    {"egmactmove", "*", StatementClass::voids, ProgramState::everything},
    {"egmactpose", "*", StatementClass::voids, ProgramState::everything},
    {"hollowwristreset", "*", StatementClass::voids, ProgramState::everything},
    {"indreset", "*", StatementClass::voids, ProgramState::everything},
    {"indamove", "*", StatementClass::voids, ProgramState::everything},
    {"indcmove", "*", StatementClass::voids, ProgramState::everything},
    {"inddmove", "*", StatementClass::voids, ProgramState::everything},
    {"indrmove", "*", StatementClass::voids, ProgramState::everything},
    {"searchl", "*", StatementClass::own},
    {"searchc", "*", StatementClass::own},
    {"searchextj", "*", StatementClass::own},
    {"ssearchl", "*", StatementClass::own},
    {"moveextj", "*", StatementClass::own},
    {"movepnp", "*", StatementClass::own},
    {"egmmovel", "*", StatementClass::own},
    {"egmmovec", "*", StatementClass::own},
    {"contactl", "*", StatementClass::own},
    {"calibl", "*", StatementClass::own},
    {"calibj", "*", StatementClass::own},
    {"measurewearl", "*", StatementClass::own},
    {"cssdeactmovel", "*", StatementClass::own},
    {"fcpress1lstart", "*", StatementClass::own},
    {"fcpressl", "*", StatementClass::own},
    {"fcpressc", "*", StatementClass::own},
    {"fcpressend", "*", StatementClass::own},
    {"capl", "*", StatementClass::own},
    {"capc", "*", StatementClass::own},
    {"arcadaptl", "*", StatementClass::own},
    {"arcadaptc", "*", StatementClass::own},
    {"arccalcl", "*", StatementClass::own},
    {"arccalcc", "*", StatementClass::own},
    {"stepbwdpath", "*", StatementClass::moves},
    {"pathrecmovebwd", "*", StatementClass::moves},
    {"pathrecmovefwd", "*", StatementClass::moves},
    {"setleadthrough", "*", StatementClass::moves},
    {"loadid", "*", StatementClass::moves},
    {"manloadidproc", "*", StatementClass::moves},
    {"egmrunjoint", "*", StatementClass::moves},
    {"egmrunpose", "*", StatementClass::moves},
};

/// Moves that are corrected: their first argument is a target, of circular ones the first two.
inline constexpr std::string_view rapid_joint_moves =
    "movej moveabsj movejao movejdo movejgo movejsync triggabsj triggj triggjios spotj nutj";
inline constexpr std::string_view rapid_linear_moves =
    "movel movelao moveldo movelgo movelsync triggl trigglios arcl arcl1 arcl2 arclstart arcl1start arcl2start arclend "
    "arcl1end arcl2end spotl spotml displ paintl nutl";
inline constexpr std::string_view rapid_circular_moves =
    "movec movecao movecdo movecgo movecsync triggc arcc arcc1 arcc2 arccstart arcc1start arcc2start arccend arcc1end "
    "arcc2end dispc paintc";

/// Options of moves that leave their targets as they are.
inline constexpr std::string_view rapid_move_options =
    "conc id v t z inpos wobj tload noeoffs t2 t3 t4 t5 t6 t7 t8 triggdata1 triggdata2 triggdata3 all weave seamname "
    "sched retr noconc dodelay";

/// Functions that do nothing beside computing a value.
inline constexpr std::string_view rapid_functions =
    "abs absdnum acos acosdnum ainput aoutput argname asin asindnum atan atan2 atan2dnum atandnum bitand bitanddnum "
    "bitcheck bitcheckdnum bitlsh bitlshdnum bitneg bitnegdnum bitor bitordnum bitrsh bitrshdnum bitxor bitxordnum "
    "bytetostr calcjointt calcrobt calcrotaxframez calcrotaxisframe camgetexposure camgetloadedjob camgetname "
    "camnumberofresults cdate cjointt clkread corrread cos cosdnum cpos crobt crossprod cspeedoverride ctime ctool "
    "cwobj dectohex defaccframe defdframe defframe dim dinput distance dnumtonum dnumtostr dotprod doutput egmgetstate "
    "eulerzyx eventtype exechandler execlevel exp filesize filetime filetimednum fssize getaxisdistance "
    "getaxismovetime getmaxnumberofcyclicbool getmecunitname getmodalpayloadmode getmotortorque getnextcyclicbool "
    "getnextmechunit getnextsym getnumberofcyclicbool getserviceinfo getsignal getsignaldnum getsignalorigin "
    "getsysinfo gettaskname gettime gettspstatus getuasusername ginput ginputdnum goutput goutputdnum hextodec "
    "indinpos "
    "indspeed iounitstate isbrakecheckactive iscyclicbool isfile isleadthrough ismechunitactive ispers isstopmoveact "
    "isstopstateevent issyncmoveon issysid isvar max maxextlinearspeed maxextreorientspeed maxrobreorientspeed "
    "maxrobspeed min mirpos modexist modtime modtimednum motionplannerno nonmotionmode norient numtodnum numtostr offs "
    "opmode orientzyx orobt paridposvalid paridrobvalid pathlengthget pathlevel pathrecvalidbwd pathrecvalidfwd "
    "pfrestart poseinv posemult posevect pow powdnum ppmovedinmanmode present progmemfree rawbyteslen readbin readdir "
    "readmotor readnum readstr readstrbin readvar reltool remainingretries rmqgetslotname robname robos round "
    "rounddnum runmode sin sindnum socketgetstatus socketpeek sqrt sqrtdnum stcalcforce stcalctorque stiscalib "
    "stisclosed stisindgun stisopen strdigcalc strdigcmp strfind strformat strlen strmap strmatch strmemb strorder "
    "strpart strtobyte strtoval tan tandnum taskisactive taskisexecuting taskrunmec taskrunrob tasksinsync testandset "
    "testdi testsignread textget texttabfreetouse texttabget triggdatavalid trunc truncdnum tryint type uialphaentry "
    "uiclientexist uidnumentry uidnumtune uilistview uimessagebox uinumentry uinumtune validio valtostr vectmagn";

// ---- KRL: statements, system variables, calls of BAS, functions ----

/// System variables whose values mean nothing to targets.
inline constexpr std::string_view krl_harmless =
    "$vel $acc $jerk $apo $advance $ov_pro $ov_appl $vel_axis $acc_axis $jerk_axis $vel_extax $acc_extax $vel_ma "
    "$acc_ma "
    "$vel_oric $red_vel $red_vel_c $gear_jerk $collmon_tol_pro $load $load_a1 $load_a2 $load_a3 $act_tool $act_base "
    "$act_ex_ax "
    "$cir_type "
    "$circ_type $circ_mode $out $outs $anout $timer $timer_stop $timer_flag $flag $cycflag $h_pos $h_pos_tol $loop_msg "
    "$loop_cont $bwdstart $single_step $pro_mode $pro_name $ipo_wait_for $ipo_wait_for_on $ipo_wait_state $opt_move "
    "$spl_tech $cp_vel_type $cp_statmon $cp_spd_fly $torqmon $torqmon_com $torqmon_def $set_io_size $date $notaus";

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

/// Routines and functions of the controller that leave targets as they are, and words that begin a harmless statement.
inline constexpr std::string_view krl_functions =
    "abs acos asin atan atan2 cos sin sqrt tan eb ek lk sacc_cp sacc_joint sapo sapo_ptp sbase sgear_jerk sipo_mode "
    "sjerk sload sori_typ stool stool2 "
    "svel_cp svel_joint use_cm_pro_values forward inverse inv_pos cast_from cast_to cclose ciocontrol "
    "cioctl copen "
    "cread cwrite sopen sread swrite sclose err_clear err_raise exists_krldlg exists_krlmsg clear_krlmsg set_krldlg "
    "set_krldlganswer set_krlmsg get_msgbuffer get_sig_inf get_decl_place getcycdef getsysstate get_system_data "
    "getvarsize "
    "ioctl ir_stopm ismessageset is_key_pressed m_comment mbx_rec msgdialog msgnotify msgquit msgstate msgwait "
    "pulse remotecmd remoteread "
    "rob_stop rob_stop_release set_brake_delay sync synccmd cancelprogsync timer_limit varstate vartype wspacegive "
    "wspacetake stradd strclear strcomp strcopy strdecllen strfind strlen strtoaxis strtobool strtoe3axis strtoe3pos "
    "strtoe6axis strtoe6pos strtoframe strtoint strtopos strtoreal strtostring frand "
    "halt wait anin anout digin interrupt confirm import on_error_proceed brake asystop asycancel "
    "bool char int real string frame load inertia fdat ldat pdat signal channel struc enum ext extfct extp extfctp "
    "const_vel stop time_block";

/// Beginnings of functions that may change a variable that they are given.
inline constexpr std::string_view krl_inputs = "strto cast_ cread sread get_ mbx_";

// ---- URScript: functions ----

/// Functions that leave targets as they are.
inline constexpr std::string_view urscript_harmless =
    "acos asin assert atan atan2 binary_list_to_integer ceil conveyor_pulse_decode convert_pose cos d2r "
    "enable_external_ft_sensor "
    "encoder_enable_pulse_decode encoder_enable_set_tick_count encoder_get_tick_count encoder_set_tick_count "
    "encoder_unwind_delta_tick_count end_freedrive_mode end_screw_driving end_teach_mode estimate_payload floor force "
    "force_mode_get_damping force_mode_get_gain_scaling force_mode_set_damping force_mode_set_gain_scaling "
    "frame_tracking_disable ft_rtde_input_enable get_actual_joint_accelerations get_actual_joint_positions "
    "get_actual_joint_positions_history get_actual_joint_speeds get_actual_tcp_pose get_actual_tcp_speed "
    "get_actual_tool_flange_pose get_analog_in get_analog_out get_base_acceleration get_children "
    "get_configurable_digital_in get_configurable_digital_out get_controller_temp get_conveyor_tick_count "
    "get_coriolis_and_centrifugal_torques get_digital_in get_digital_out get_euromap_input get_euromap_output get_flag "
    "get_forward_kin get_frame_parent get_freedrive_status get_gravity get_inverse_kin get_inverse_kin_has_solution "
    "get_jacobian get_jacobian_time_derivative get_joint_temp get_joint_torques get_list_length get_mass_matrix "
    "get_pose "
    "get_rtde_value get_standard_analog_in get_standard_analog_out get_standard_digital_in get_standard_digital_out "
    "get_steptime get_target_joint_accelerations get_target_joint_positions get_target_joint_speeds get_target_payload "
    "get_target_payload_cog get_target_payload_inertia get_target_tcp_pose get_target_tcp_pose_along_path "
    "get_target_tcp_speed get_target_tcp_speed_along_path get_target_waypoint get_tcp_force get_tcp_offset "
    "get_tool_accelerometer_reading get_tool_analog_in get_tool_current get_tool_digital_in get_tool_digital_out "
    "get_tool_temp high_holding_torque_disable high_holding_torque_enable integer_to_binary_list interpolate_pose inv "
    "is_frame is_steady is_within_safety_limits jerk_gain_scaling_get jerk_gain_scaling_set length log make_list "
    "modbus_add_rw_signal modbus_add_signal modbus_delete_signal modbus_get_error modbus_get_signal_status "
    "modbus_get_time_since_signal_invalid modbus_reset_connection modbus_send_custom_command "
    "modbus_set_digital_input_action modbus_set_output_register modbus_set_output_signal "
    "modbus_set_runstate_dependent_choice modbus_set_signal_update_frequency modbus_set_signal_watchdog "
    "motion_version_get norm normalize path_offset_get path_offset_set_alpha_filter path_offset_set_max_offset "
    "pause_on_error_code point_dist popup pose_add pose_dist pose_inv pose_sub pose_trans position_deviation_warning "
    "pow "
    "powerdown protective_stop r2d random read_input_boolean_register read_input_float_register "
    "read_input_integer_register read_output_boolean_register read_output_float_register read_output_integer_register "
    "read_port_bit read_port_register request_boolean_from_primary_client request_float_from_primary_client "
    "request_integer_from_primary_client request_string_from_primary_client rotvec2rpy rpc_factory rpy2rotvec "
    "rtde_set_watchdog set_analog_inputrange set_analog_out set_analog_outputdomain set_base_acceleration "
    "set_baselight_iec "
    "set_baselight_off set_baselight_solid set_configurable_digital_input_action set_configurable_digital_out "
    "set_conveyor_tick_count set_digital_out set_euromap_output set_euromap_runstate_dependent_choice set_flag "
    "set_gp_boolean_input_action set_gravity set_input_actions_to_default set_mass_properties set_payload "
    "set_payload_cog "
    "set_payload_from_attached_frames set_payload_mass set_runstate_configurable_digital_output_to_value "
    "set_runstate_gp_boolean_output_to_value set_runstate_standard_analog_output_to_value "
    "set_runstate_standard_digital_output_to_value set_runstate_tool_digital_output_to_value "
    "set_safety_mode_transition_hardness set_standard_analog_input_domain set_standard_analog_out "
    "set_standard_digital_input_action set_standard_digital_out set_target_payload set_tool_analog_input_domain "
    "set_tool_communication set_tool_digital_input_action set_tool_digital_out set_tool_digital_output_mode "
    "set_tool_output_mode set_tool_voltage sin size sleep socket_close socket_get_var socket_open "
    "socket_read_ascii_float "
    "socket_read_binary_integer socket_read_byte_list socket_read_line socket_read_string socket_send_byte "
    "socket_send_int socket_send_line socket_send_string socket_set_var sqrt stopj stopl str_at str_cat str_empty "
    "str_find str_len str_sub struct sync tan textmsg time to_num to_str tool_contact tool_wrench_limit_disable "
    "tool_wrench_limit_set transpose wrench_trans write_output_boolean_register write_output_float_register "
    "write_output_integer_register write_port_bit write_port_register zero_ftsensor";

/// Moves that are corrected: their first argument is a target, of `movec` the first two.
inline constexpr std::string_view urscript_joint_moves = "movej optimovej servoj";
inline constexpr std::string_view urscript_linear_moves = "movel optimovel movep movec servoc";

/// Functions that change what targets mean, or that move without one.
inline constexpr ProgramStatement urscript_statements[] = {
    {"force_mode", "", StatementClass::voids, ProgramState::following},
    {"end_force_mode", "", StatementClass::ends, ProgramState::following},
    {"path_offset_enable", "", StatementClass::voids, ProgramState::displacement},
    {"path_offset_set", "", StatementClass::voids, ProgramState::displacement},
    {"path_offset_disable", "", StatementClass::ends, ProgramState::displacement},
    {"track_conveyor_linear", "", StatementClass::voids, ProgramState::tracking},
    {"track_conveyor_circular", "", StatementClass::voids, ProgramState::tracking},
    {"stop_conveyor_tracking", "", StatementClass::ends, ProgramState::tracking},
    {"add_frame", "", StatementClass::voids, ProgramState::frame_data},
    {"attach_frame", "", StatementClass::voids, ProgramState::frame_data},
    {"move_frame", "", StatementClass::voids, ProgramState::frame_data},
    {"delete_frame", "", StatementClass::voids, ProgramState::frame_data},
    {"delete_all_frames", "", StatementClass::voids, ProgramState::frame_data},
    {"reset_world_model", "", StatementClass::voids, ProgramState::frame_data},
    {"frame_tracking_enable", "", StatementClass::voids, ProgramState::everything},
    {"reset_revolution_counter", "", StatementClass::voids, ProgramState::everything},
    {"screw_driving", "", StatementClass::voids, ProgramState::everything},
    {"motion_version_set", "", StatementClass::voids, ProgramState::everything},
    {"speedj", "", StatementClass::moves},
    {"speedl", "", StatementClass::moves},
    {"direct_torque", "", StatementClass::moves},
    {"set_pos", "", StatementClass::moves},
    {"freedrive_mode", "", StatementClass::moves},
    {"freedrive_mode_no_incorrect_payload_check", "", StatementClass::moves},
    {"teach_mode", "", StatementClass::moves},
};

// ---- Fanuc: first words of instructions, options of moves ----

/// First words, of assignments the names of what they change.
inline constexpr std::string_view fanuc_harmless =
    "r pr sr ar ai ao di do f fi gi go m plm ri ro si so ui uo wi wo wsi wso timer timer_overflow override ualm "
    "message "
    "wait pause abort end rsr lock unlock joint_max_speed linear_max_speed payload error_prog resume_prog maint_prog "
    "clear_resume_prog return_path_dsbl col arc weld weave vr strlen findstr substr vision $waittmout $waitrelmt "
    "$mcr.$genoverride";

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
    "mm "
    "cm min inch deg r ar weld_speed max_speed time before after distance point_logic do ro go ao f on off pulse pr";

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
