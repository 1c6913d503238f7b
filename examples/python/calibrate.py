#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Calibrates a simulated arm and corrects commands: python3 calibrate.py [FOLDER OF THE PACKAGE]."""
import sys

if len(sys.argv) > 1:
    sys.path.insert(0, sys.argv[1])
import numpy as np

import vernier

robot = vernier.Robot.load("ur10")
plan = vernier.plan(robot, 80, candidates=600, seed=1)
data = vernier.simulate(robot, plan.path, seed=1)
result = vernier.calibrate(robot, data, test=0.2, seed=1)
print(result)
print(result.verdict)

fresh = np.random.default_rng(2).uniform(-1, 1, (100, robot.joints))
found = result.model.correct(fresh)
as_designed = np.linalg.norm((result.model.fk(fresh) - result.model.nominal_fk(fresh))[:, :3, 3], axis=1)
corrected = np.linalg.norm((result.model.fk(found.command) - result.model.nominal_fk(fresh))[:, :3, 3], axis=1)
met = np.asarray(found.converged)  # near a singular pose no joint values meet the target
print(f"as the model predicts: {1e3 * as_designed.mean():.2f} mm before, {1e3 * corrected[met].mean():.5f} mm after correction "
      f"of {met.sum()} commands; {np.sum(~met)} are as near as the arm comes")
assert met.mean() > 0.8 and corrected[met].max() < 1e-5 < as_designed.mean()
