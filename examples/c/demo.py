# SPDX-License-Identifier: BSD-3-Clause
"""A calibrated arm in Python, through the C header. Write it and compile it as a library first:
     export_c --model model.json --name arm --out arm.h
     cc -O2 -shared -fPIC -DARM_API= -x c arm.h -o arm.so -lm
     python3 demo.py ./arm.so 6
"""
import ctypes
import sys

import numpy as np

lib, joints = ctypes.CDLL(sys.argv[1]), int(sys.argv[2])
array = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
lib.arm_pose.argtypes = [array, ctypes.c_void_p, array]
lib.arm_nominal_pose.argtypes = [array, array]
lib.arm_correct.argtypes = [array, array, ctypes.c_void_p, array, ctypes.c_void_p]

previous = None  # nobody knows where the arm comes from
for point in range(3):
    program = 0.2 + 0.1 * point + 0.1 * np.arange(joints)
    target, reached, command = np.empty((3, 4)), np.empty((3, 4)), np.empty(joints)
    lib.arm_nominal_pose(program, target)  # where the program means the arm to be: base_T_tool, three rows
    address = None if previous is None else previous.ctypes.data_as(ctypes.c_void_p)
    status = lib.arm_correct(target, program, address, command, None)
    lib.arm_pose(command, address, reached)  # and where it will be
    left = 1e3 * np.linalg.norm((reached - target)[:, 3])
    print(np.round(command, 6), ("met", "stalled", "limits")[status], f"{left:.4f} mm left")
    previous = command  # hysteresis: the arm comes from there
