# SPDX-License-Identifier: BSD-3-Clause
"""Makes an industrial robot go where it is told: calibration and error compensation of serial arms.

Joint values are those of the controller, in radians or metres, a row a configuration; lengths are in metres.

    robot = vernier.Robot.load("abb_irb120")
    data = vernier.Measurements.read("measured.csv", robot)
    result = vernier.calibrate(robot, data, test=5)
    print(result.verdict)
    command = result.model.correct(q).command
"""
from ._vernier import (Correction, IkResult, Measurements, Model, Progress, Robot, __version__, calibrate, load, minimize,
                       plan, simulate)
from .errors import CalibrationFailure, DataError
from .functions import export_c, verify
from .results import Branches, CalibrationResult, CorrectedPath, Plan, Report, SearchResult, Verification

__all__ = ["Branches", "CalibrationFailure", "CalibrationResult", "CorrectedPath", "Correction", "DataError",
           "IkResult", "Measurements", "Model", "Plan", "Progress", "Report", "Robot", "SearchResult", "Verification",
           "__version__", "calibrate", "export_c", "load", "minimize", "plan", "simulate", "verify"]

for _type in (Correction, IkResult, Measurements, Model, Progress, Robot):
    _type.__module__ = __name__  # where users find them, and where pickle looks
