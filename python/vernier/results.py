# SPDX-License-Identifier: BSD-3-Clause
"""What the functions of this package return."""
import html
import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Union

import numpy as np
import numpy.typing as npt

from ._vernier import Model

Array = npt.NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]


class Report:
    """The assessment of a calibration, as text, as JSON and as an HTML page that needs nothing else."""

    def __init__(self, page: str, summary: str, details: str, results: str) -> None:
        self.html = page
        self.summary = summary
        self.details = details
        self._results = results

    def save(self, path: Path) -> None:
        """Writes the HTML page, whole or not at all."""
        partial = f"{os.fspath(path)}.{os.getpid()}.part"
        with open(partial, "w", encoding="utf-8", newline="") as file:
            file.write(self.html)
        os.replace(partial, path)

    def as_dict(self) -> Dict[str, Any]:
        """All results, as the program calibrate writes them by --json."""
        results: Dict[str, Any] = json.loads(self._results)
        return results

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.html)}" style="width:100%;height:40em;border:0"></iframe>'

    def __repr__(self) -> str:
        return f"<vernier.Report: {self.summary.count(chr(10))} lines, an HTML page of {len(self.html) // 1000} kB>"


@dataclass(frozen=True, eq=False, repr=False)
class Reflector:
    """A reflector on the flange."""

    position: Array
    """In the frame of the flange [m]."""
    std: Array
    """Standard deviations of its position [m]; 0 where they were not estimated."""
    poses: int
    """Number of poses learned from."""
    model: Model
    """The calibrated arm whose tool is this reflector."""

    def __repr__(self) -> str:
        x, y, z = 1e3 * self.position
        return f"<vernier.Reflector: at {x:.3f}, {y:.3f}, {z:.3f} mm, from {self.poses} poses>"


@dataclass(frozen=True, eq=False, repr=False)
class CalibrationResult:
    """A calibration, assessed on held-out poses."""

    model: Model
    report: Report
    verdict: str
    """The verdict, a sentence a line."""
    chosen: str
    """Key of the stage that is deployed."""
    stages: Dict[str, Array]
    """Position errors of the held-out poses after each stage [m]."""
    rotation_stages: Dict[str, Array]
    """Their orientation errors [rad]; empty where orientations are not used."""
    train_poses: int
    test_poses: int
    reflectors: Dict[str, Reflector]
    """Each reflector, by the name of what measured it; empty where there is one alone, whose arm is `model`."""

    def _repr_html_(self) -> str:
        return self.report._repr_html_()

    def __repr__(self) -> str:
        mean = float(np.mean(self.stages[self.chosen])) * 1e3
        return (f"<vernier.CalibrationResult: {self.train_poses} poses learned from, {self.test_poses} held out, "
                f"{self.chosen}: {mean:.3g} mm mean>")


@dataclass(frozen=True, eq=False, repr=False)
class Branches:
    """All joint values that bring the tool to a pose."""

    joints: Array
    """One branch a row [rad, m]."""
    within_limits: List[bool]
    branch: List[int]
    """Number of each branch: shoulder, elbow and wrist."""
    reach: str
    """What became of the target, in a sentence."""

    def __len__(self) -> int:
        return len(self.joints)

    def __repr__(self) -> str:
        return f"<vernier.Branches: {self.reach}>"


@dataclass(frozen=True, eq=False, repr=False)
class CorrectedPath:
    """Corrected commands of a path, in their order."""

    commands: Array
    """Joint values, a row a point [rad, m]; NaN where there is no command."""
    target: List[int]
    """The target that each point reaches, or towards which it was inserted."""
    inserted: List[bool]
    status: List[str]
    """met, jump, off_path, beyond_limits, not_found, proven_out or invalid_target."""
    predicted_error: Array
    deviation: Array
    """Of the tool from the line of a linear move [m]."""
    before: float
    """Largest deviation from the lines, were the ends alone corrected [m]."""
    after: float

    def __len__(self) -> int:
        return len(self.commands)

    def __repr__(self) -> str:
        met = sum(status == "met" for status in self.status)
        return f"<vernier.CorrectedPath: {len(self)} points, {sum(self.inserted)} of them inserted, {met} met>"


@dataclass(frozen=True, eq=False, repr=False)
class Verification:
    """The outcome of a check of a calibration."""

    valid: bool
    consistent: bool
    verdict: str
    advice: List[str]
    summary: str
    errors: Array
    """Position errors after registration [m]."""
    p_value: float
    joints: Dict[int, Dict[str, Any]]
    """Changes of zero [rad, m] and of transmission, by joint, from 0."""

    def __repr__(self) -> str:
        return f"<vernier.Verification: {self.verdict}>"


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """Poses to measure."""

    joints: Array
    """Chosen poses in the order of choice: the first ones alone are the plan of fewer [rad, m]."""
    chosen: List[int]
    """Their numbers among the candidates."""
    visits: List[int]
    """Rows of `joints` in the order of measuring; the first three register the sensor, repeats show drift."""
    relative_error: Array
    """Predicted error after 0, 1, .. poses, relative to that after the last."""
    information: Array
    """Information after 0, 1, .. poses [nat]."""
    unknowns: int
    enough: int
    """From so many poses on, ten more reduce the predicted error by less than 2 %."""

    @property
    def path(self) -> Array:
        """Joint values in the order of measuring."""
        return self.joints[self.visits]

    def __len__(self) -> int:
        return len(self.joints)

    def __repr__(self) -> str:
        return f"<vernier.Plan: {len(self)} poses in {len(self.visits)} visits, for {self.unknowns} unknowns>"


@dataclass(frozen=True, eq=False, repr=False)
class SearchResult:
    """The end of a search."""

    best: Array
    value: float
    evaluations: int
    generations: int
    status: str
    """schedule_ended, budget_spent, target_reached or stalled."""

    def __repr__(self) -> str:
        return f"<vernier.SearchResult: {self.value:.6g} after {self.evaluations} evaluations, {self.status}>"
