#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares learners on the position errors of a simulated arm, and draws their errors at poses that none has seen:
python3 compare_learners.py [FOLDER OF THE PACKAGE [PICTURE.png]]."""
import sys

if len(sys.argv) > 1:
    sys.path.insert(0, sys.argv[1])
import numpy as np
from matplotlib import pyplot

import vernier

robot = vernier.Robot.load("abb_irb120")
joints = np.random.default_rng(1).uniform(-1, 1, (300, robot.joints))
data = vernier.simulate(robot, joints, seed=1)
model = vernier.calibrate(robot, data, learners=[]).model
error = data.positions - model.nominal_fk(joints)[:, :3, 3]  # in the identified frames
train, test = np.arange(300) % 3 > 0, np.arange(300) % 3 == 0

recipes = {"mean alone": None,
           "PSO-ELM": vernier.PsoElm(hidden_nodes=30, particles=20, iterations=30),
           "GA-ELM": vernier.GaElm(hidden_nodes=30, individuals=20, generations=30),
           "ridge ELM": vernier.RidgeElm(hidden_nodes=60),
           "kernel ELM": vernier.KernelElm(input_map="sines_and_cosines"),
           "Gaussian process": vernier.GaussianProcess(input_map="sines_and_cosines")}
left = {}
for name, recipe in recipes.items():
    predicted = error[train].mean(axis=0) if recipe is None else recipe.fit(joints[train], error[train]).predict(joints[test])
    left[name] = 1e3 * np.linalg.norm(error[test] - predicted, axis=1)
    print(f"{name:17} {left[name].mean():.3f} mm mean, {left[name].max():.3f} mm maximum")
assert left["Gaussian process"].mean() < left["mean alone"].mean()

pyplot.boxplot(list(left.values()), labels=list(left))
pyplot.ylabel("position error at unseen poses [mm]")
pyplot.yscale("log")
if len(sys.argv) > 2:
    pyplot.savefig(sys.argv[2], dpi=120)
