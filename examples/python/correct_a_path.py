#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Corrects a square of linear moves, and draws how far the tool leaves its lines:
python3 correct_a_path.py [FOLDER OF THE PACKAGE [PICTURE.png]]."""
import pathlib
import sys

if len(sys.argv) > 1:
    sys.path.insert(0, sys.argv[1])
import numpy as np
from matplotlib import pyplot

import vernier

project = pathlib.Path(__file__).resolve().parents[2]
robot = vernier.Robot.load("abb_irb120")
data = vernier.Measurements.read(project / "examples/data/measured.csv", robot)
model = vernier.calibrate(robot, data, learners=[]).model

corners = np.radians([[-30, 20, 10, 0, 60, -30], [30, 20, 10, 0, 60, 30], [30, 40, -20, 0, 70, 30],
                      [-30, 40, -20, 0, 70, -30], [-30, 20, 10, 0, 60, -30]])
path = model.correct_path(corners, linear=[False, True, True, True, True], tolerance=0.01e-3)
print(path)
print(f"largest departure from the lines: {1e3 * path.before:.3f} mm with the ends corrected alone, "
      f"{1e3 * path.after:.3f} mm with the inserted points")
assert path.after <= 0.01e-3 and all(status == "met" for status in path.status)

pyplot.plot(1e3 * path.deviation, drawstyle="steps")
pyplot.xlabel("point of the path")
pyplot.ylabel("departure from the line [mm]")
if len(sys.argv) > 2:
    pyplot.savefig(sys.argv[2], dpi=120)
