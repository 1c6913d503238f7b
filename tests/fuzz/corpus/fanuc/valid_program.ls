/PROG  PART
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "it's";
/APPL
/MN
   1:  !L P[9] is no move ;
   2:J P[1] 100% FINE    ;
   3:L P[2:"weld"] 500mm/sec CNT100    ;
   4:C P[3]
    :  P[1] 100mm/sec FINE    ;
   5:L PR[2] 100mm/sec FINE    ;
   6:L P[2] 100mm/sec FINE Offset,PR[1]    ;
   7:L P[5] 100mm/sec FINE INC    ;
   8:J P[R[1]] 50% FINE    ;
   9:  CALL P ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =   550.000  mm,	Y =     -.250  mm,	Z =   600.000  mm,
	W =  -179.998 deg,	P =      .083 deg,	R =    30.000 deg
};
P[2:"weld; here"]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'F D B, 0, 0, -1',
	X =   1.000  mm,	Y = 2.000  mm,	Z =   3.000  mm,
	W =  1.0 deg,	P =  2.0 deg,	R =  3.0 deg,
	E1=   .000  mm
};
P[3]{
   GP1:
	UF : 0, UT : 1,	
	J1=     0.000 deg,	J2=   -20.000 deg,	J3= 1.0 deg,	J4= 0 deg,	J5= -90 deg,	J6= 0 deg
};
P[4]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  ********  mm,	Y = 2 mm,	Z = 3 mm,
	W = 1 deg,	P = 2 deg,	R = 3 deg
};
P[5]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 0 mm,	Y = 0 mm,	Z = 3 mm,
	W = 0 deg,	P = 0 deg,	R = 0 deg
};
/END
