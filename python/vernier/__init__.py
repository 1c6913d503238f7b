# SPDX-License-Identifier: BSD-3-Clause
"""Makes an industrial robot go where it is told: calibration and error compensation of serial arms.

Joint values are those of the controller, in radians or metres, a row a configuration; lengths are in metres.

    robot = vernier.Robot.load("abb_irb120")
    data = vernier.Measurements.read("measured.csv", robot)
    result = vernier.calibrate(robot, data, test=5)
    print(result.verdict)
    command = result.model.correct(q).command
"""
from ._vernier import (Correction, IkResult, Measurements, Model, Predictor, Progress, Robot, __version__, calibrate,
                       load, minimize, plan, simulate)
from .errors import CalibrationFailure, DataError
from .functions import export_c, verify
from .learners import Elm, GaElm, GaussianProcess, KernelElm, PsoElm, RidgeElm, VarProElm
from .results import Branches, CalibrationResult, CorrectedPath, Plan, Reflector, Report, SearchResult, Verification

__all__ = ["Branches", "CalibrationFailure", "CalibrationResult", "CorrectedPath", "Correction", "DataError",
           "Elm", "GaElm", "GaussianProcess", "IkResult", "KernelElm", "Measurements", "Model", "Plan", "Predictor",
           "Progress", "PsoElm", "Reflector", "Report", "RidgeElm", "Robot", "SearchResult", "VarProElm", "Verification", "__version__",
           "calibrate", "export_c", "load", "minimize", "plan", "simulate", "verify"]

for _type in (Correction, IkResult, Measurements, Model, Predictor, Progress, Robot):
    _type.__module__ = __name__  # where users find them, and where pickle looks
