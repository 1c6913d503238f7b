/* A calibrated arm in C. Write arm.h first, then compile:
 *   export_c --model model.json --name arm --out arm.h
 *   cc -std=c99 -O2 demo.c -o demo -lm                                                                              */
#include "arm.h"

#include <stdio.h>

int main(void) {
  double program[ARM_JOINTS], T[12], command[ARM_JOINTS], error;
  const double *previous = 0; /* nobody knows where the arm comes from */
  int point, i, status;
  printf("%s, calibrated %s, model %.12s\n", ARM_MODEL_NAME, ARM_MODEL_DATE, ARM_MODEL_HASH);
  for (point = 0; point < 3; ++point) {
    for (i = 0; i < ARM_JOINTS; ++i) program[i] = 0.2 + 0.1 * point + 0.1 * i;
    arm_nominal_pose(program, T); /* where the program means the arm to be */
    status = arm_correct(T, program, previous, command, &error);
    previous = command; /* hysteresis: the arm comes from there */
    for (i = 0; i < ARM_JOINTS; ++i) printf("%10.6f", command[i]);
    printf("  %s, %.4f mm left\n",
           status == ARM_MET ? "met" : status == ARM_STALLED ? "stalled" : "limits", error * 1e3);
  }
  return 0;
}
