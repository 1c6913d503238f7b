# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python package share. The folder of the project is VERNIER_SOURCE, its programs VERNIER_PROGRAMS."""
import os
import pathlib
import subprocess

import numpy as np
import pytest

import vernier

SOURCE = pathlib.Path(os.environ.get("VERNIER_SOURCE", pathlib.Path(__file__).resolve().parents[2]))


@pytest.fixture(scope="session")
def source():
    return SOURCE


@pytest.fixture(scope="session")
def programs():
    """Runs a program that was built beside the module."""
    folder = os.environ.get("VERNIER_PROGRAMS")
    if not folder or not (pathlib.Path(folder) / "calibrate").exists():
        pytest.skip("the programs were not built")

    def run(name, *arguments):
        return subprocess.run([str(pathlib.Path(folder) / name), *map(str, arguments)], check=True,
                              stdout=subprocess.PIPE, text=True).stdout
    return run


@pytest.fixture(scope="session")
def robot():
    return vernier.Robot.load("abb_irb120")


@pytest.fixture(scope="session")
def joints(robot):
    """Joint values within the limits."""
    lower, upper = robot.limits.T
    return np.random.default_rng(7).uniform(lower, upper, (200, robot.joints))


@pytest.fixture(scope="session")
def measured(source, robot):
    return vernier.Measurements.read(source / "examples/data/measured.csv", robot)


@pytest.fixture(scope="session")
def result(robot, measured):
    return vernier.calibrate(robot, measured, test=5, date="2026-01-01")


@pytest.fixture(scope="session")
def model(result):
    return result.model
