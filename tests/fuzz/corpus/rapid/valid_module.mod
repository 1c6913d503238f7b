%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%

MODULE Part(SYSMODULE)
  ! CONST robtarget old:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]; הצü
  PERS tooldata Gun:=[TRUE,[[10,20,30],[0.5,0.5,0.5,0.5]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  TASK PERS wobjdata Table:=[FALSE,TRUE,"",[[100,0,0],[0,0,0,1]],[[0,5,0],[1,0,0,0]]];
  PERS wobjdata Turntable:=[FALSE,FALSE,"STN_1",[[100,0,0],[0,0,0,1]],[[0,5,0],[1,0,0,0]]];
  VAR extjoint none:=[9E9,9E9,9E9,9E9,9E9,9E9];
  CONST robtarget p10:=[[600.5,-.25,+7e2],[0.7071,0,0.7071,0],[0,-1,0,1],[9E+09,9E9,9E9,9E9,9E9,9E9]];
  LOCAL CONST robtarget row{2}:=[[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
    [[4,5,6],[0,1,0,0],[0,0,0,0],none]];
  CONST robtarget rail:=[[1,2,3],[1,0,0,0],[0,0,0,0],[500,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget home:=[[0,-10.5,20,0,30,-.5],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR robtarget here;
  CONST string s:="MoveL [[1,2,3]";
  PROC main()
    MoveAbsJ home\NoEOffs,v100,z50,Gun;
    MoveJ \Conc,p10,v100,fine,Gun\WObj:=Table;
    IF x>1 MoveL Offs(p10,0,0,50),v100,fine,Gun\WObj:=Table;
    MoveC row{1}, [[7,8,9], [0.5,0.5,-0.5,0.5], [1,2,3,0], none],v100,fine,Gun\WObj:=Table;
    MoveL here,v100,fine,Gun;
    MoveL elsewhere,v100,fine,Gun;
    here:=CRobT();
    p10.trans.x:=p10.trans.x+5;
    MoveL [[x,8,9],[1,0,0,0],[0,0,0,0],none],v100,fine,Gun;
  ENDPROC
ENDMODULE
