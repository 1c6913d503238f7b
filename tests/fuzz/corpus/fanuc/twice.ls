/PROG A
/MN
/POS
P[1]{ GP1: };
P[1]{ GP1: };
/END
