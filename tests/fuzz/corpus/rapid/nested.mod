MODULE m
VAR num a:=[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[
ENDMODULE
