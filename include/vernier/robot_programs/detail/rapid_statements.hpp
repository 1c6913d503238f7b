// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Statements of RAPID: instructions, options of moves, functions. Data alone: the guide has this table, too.

#include <string_view>

#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

/// Instructions to which an option means nothing more.
inline constexpr std::string_view rapid_harmless =
    "accset acteventbuffer add aliascamera aliasio aliasioreset bitclear bitset bookerrno brakecheck break cancelload "
    "checkprogref cirpathmode clear cleariobuff clearpath clearrawbytes clkreset clkstart clkstop close closedir "
    "connect consolewrite copyfile copyrawbytes cornerpathwarning corrclear corrcon corrdiscon corrwrite "
    "cyclicbrakecheck deacteventbuffer decr egmgetid egmreset egmsetupai egmsetupao egmsetupgi egmsetupltapp "
    "egmsetupuc erasemodule errlog errwrite fricidevaluate fricidinit fricidsetfriclevels getdataval "
    "getgroupsignalinfo getjointdata getsysdata gettorquemargin gettrapdata gripload idelete idisable ienable ierror "
    "incr invertdo iobusstart iobusstate iodisable ioenable ipathpos ipers irmqmessage isignalai isignalao isignaldi "
    "isignaldo isignalgi isignalgo isleep itimer ivarvalue iwatch load makedir matrixsolve matrixsolveqr matrixsvd "
    "mechunitload motionprocessmodeset motionsup open opendir packdnheader packrawbytes pathacclim pathlengthreset "
    "pathlengthstart pathlengthstop pathrecstart pathrecstop pathresol procerrrecovery pulsedo readanybin readblock "
    "readcfgdata readerrdata readrawbytes removeallcyclicbool removecyclicbool removedir removefile renamefile reset "
    "resetaxisdistance resetaxismovetime resetppmoved resetretrycount resettorquemargin restopath rewind "
    "rmqemptyqueue rmqfindslot rmqgetmessage rmqgetmsgdata rmqgetmsgheader rmqreadwait rmqsendmessage rmqsendwait "
    "safetycontrollersyncrequest save scwrite set setao setdatasearch setdo setgo setupcyclicbool siclose siconnect "
    "sigetcyclic sisetcyclic skipwarn socketaccept socketbind socketclose socketconnect socketcreate socketlisten "
    "socketreceive socketreceivefrom socketsend socketsendto speedlimaxis speedlimcheckpoint speedrefresh spystart "
    "spystop startload startmove startmoveretry stclose stop stopen stopmove stopmovereset storepath systemstopaction "
    "testsigndefine testsignreset texttabinstall tperase tpreaddnum tpreadfk tpreadnum tpshow tpwrite triggcheckio "
    "triggdatacopy triggdatareset triggequip triggint triggio triggrampao triggspeed triggstopproc tunereset "
    "tuneservo uimsgbox uimsgwrite uimsgwriteabort uishow unload unpackrawbytes velset waitai waitao waitdi waitdo "
    "waitgi waitgo waitload waitrob waitsynctask waittestandset waittime waituntil warmstart worldacclim write "
    "writeanybin writebin writeblock writerawbytes writestrbin writevar wzboxdef wzcyldef wzdisable "
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
    {"writecfgdata", "*", StatementClass::voids, ProgramState::everything},
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
    "movel movelao moveldo movelgo movelsync triggl trigglios arcl arcl1 arcl2 arclstart arcl1start arcl2start "
    "arclend arcl1end arcl2end spotl spotml displ paintl nutl";
inline constexpr std::string_view rapid_circular_moves =
    "movec movecao movecdo movecgo movecsync triggc arcc arcc1 arcc2 arccstart arcc1start arcc2start arccend arcc1end "
    "arcc2end dispc paintc";

/// Options of moves that leave their targets as they are.
inline constexpr std::string_view rapid_move_options =
    "conc id v t z inpos wobj tload noeoffs t2 t3 t4 t5 t6 t7 t8 triggdata1 triggdata2 triggdata3 all weave seamname "
    "sched retr noconc dodelay";

/// Functions that compute a value; some write arguments, see below.
inline constexpr std::string_view rapid_functions =
    "abs absdnum acos acosdnum ainput aoutput argname asin asindnum atan atan2 atan2dnum atandnum bitand bitanddnum "
    "bitcheck bitcheckdnum bitlsh bitlshdnum bitneg bitnegdnum bitor bitordnum bitrsh bitrshdnum bitxor bitxordnum "
    "bytetostr calcjointt calcrobt calcrotaxframez calcrotaxisframe camgetexposure camgetloadedjob camgetname "
    "camnumberofresults cdate cjointt clkread corrread cos cosdnum cpos crobt crossprod cspeedoverride ctime ctool "
    "cwobj dectohex defaccframe defdframe defframe dim dinput distance dnumtonum dnumtostr dotprod doutput "
    "egmgetstate eulerzyx eventtype exechandler execlevel exp filesize filetime filetimednum fssize getaxisdistance "
    "getaxismovetime getmaxnumberofcyclicbool getmecunitname getmodalpayloadmode getmotortorque getnextcyclicbool "
    "getnextmechunit getnextsym getnumberofcyclicbool getserviceinfo getsignal getsignaldnum getsignalorigin "
    "getsysinfo gettaskname gettime gettspstatus getuasusername ginput ginputdnum goutput goutputdnum hextodec "
    "indinpos indspeed iounitstate isbrakecheckactive iscyclicbool isfile isleadthrough ismechunitactive ispers "
    "isstopmoveact isstopstateevent issyncmoveon issysid isvar max maxextlinearspeed maxextreorientspeed "
    "maxrobreorientspeed maxrobspeed min mirpos modexist modtime modtimednum motionplannerno nonmotionmode norient "
    "numtodnum numtostr offs opmode orientzyx orobt paridposvalid paridrobvalid pathlengthget pathlevel "
    "pathrecvalidbwd pathrecvalidfwd pfrestart poseinv posemult posevect pow powdnum ppmovedinmanmode present "
    "progmemfree rawbyteslen readbin readdir readmotor readnum readstr readstrbin readvar reltool remainingretries "
    "rmqgetslotname robname robos round rounddnum runmode sin sindnum socketgetstatus socketpeek sqrt sqrtdnum "
    "stcalcforce stcalctorque stiscalib stisclosed stisindgun stisopen strdigcalc strdigcmp strfind strformat strlen "
    "strmap strmatch strmemb strorder strpart strtobyte strtoval tan tandnum taskisactive taskisexecuting taskrunmec "
    "taskrunrob tasksinsync testandset testdi testsignread textget texttabfreetouse texttabget triggdatavalid trunc "
    "truncdnum tryint type uialphaentry uiclientexist uidnumentry uidnumtune uilistview uimessagebox uinumentry "
    "uinumtune validio valtostr vectmagn";

/// A function that writes arguments.
struct RapidWriter {
  std::string_view name;  ///< in lower case
  std::size_t first;      ///< it may write this argument, counted from 1, and those behind it
};

/// Functions that write arguments.
inline constexpr RapidWriter rapid_writers[] = {
    {"strtoval", 2},        {"getnextsym", 1},       {"getnextmechunit", 1}, {"getnextcyclicbool", 1},
    {"readdir", 2},         {"testandset", 1},       {"getsignalorigin", 2}, {"defaccframe", 4},
    {"calcrotaxframez", 4}, {"calcrotaxisframe", 3},
};

/// Options by which any function writes their values.
inline constexpr std::string_view rapid_writing_options = "errornumber breakflag";

}  // namespace vernier::detail
