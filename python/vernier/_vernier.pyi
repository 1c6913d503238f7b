# SPDX-License-Identifier: BSD-3-Clause
import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from .results import Branches, CalibrationResult, CorrectedPath, Plan, SearchResult, Verification

_Array = npt.NDArray[np.float64]
_Path = Union[str, "os.PathLike[str]"]
_Progress = Optional[Callable[["Progress"], object]]

__version__: str

class Progress:
    @property
    def generation(self) -> int: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def best(self) -> float: ...

class IkResult:
    @property
    def joints(self) -> _Array: ...
    @property
    def converged(self) -> Union[bool, npt.NDArray[np.bool_]]: ...
    @property
    def status(self) -> Union[str, List[str]]: ...
    @property
    def position_error(self) -> _Array: ...
    @property
    def rotation_error(self) -> _Array: ...

class Robot:
    @staticmethod
    def load(name_or_file: _Path, *, base_link: str = ..., tip_link: str = ...) -> Robot: ...
    @staticmethod
    def from_rows(
        name: str,
        rows: npt.ArrayLike,
        *,
        limits: Optional[npt.ArrayLike] = ...,
        modified: bool = ...,
        joint_types: Sequence[str] = ...,
        base: Optional[npt.ArrayLike] = ...,
        tool: Optional[npt.ArrayLike] = ...,
    ) -> Robot: ...
    @staticmethod
    def catalogue() -> List[str]: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def joint_types(self) -> List[str]: ...
    @property
    def limits(self) -> _Array: ...
    @property
    def remarks(self) -> List[str]: ...
    def fk(self, q: npt.ArrayLike) -> _Array: ...
    def positions(self, q: npt.ArrayLike) -> _Array: ...
    def jacobian(self, q: npt.ArrayLike) -> _Array: ...
    def ik(
        self,
        T: npt.ArrayLike,
        q0: npt.ArrayLike,
        *,
        position_only: Optional[bool] = ...,
        tolerance: float = ...,
        restarts: int = ...,
    ) -> IkResult: ...
    def branches(
        self, T: npt.ArrayLike, *, close_to: Optional[npt.ArrayLike] = ..., held: Optional[int] = ...
    ) -> Branches: ...
    def __getstate__(self) -> Tuple[Any, ...]: ...
    def __setstate__(self, state: Tuple[Any, ...]) -> None: ...

class Measurements:
    def __init__(
        self,
        joints: npt.ArrayLike,
        positions: npt.ArrayLike,
        *,
        orientations: Optional[npt.ArrayLike] = ...,
        covariances: Optional[npt.ArrayLike] = ...,
        times: Optional[npt.ArrayLike] = ...,
        previous: Optional[npt.ArrayLike] = ...,
        temperatures: Optional[npt.ArrayLike] = ...,
        payloads: Optional[npt.ArrayLike] = ...,
        points: Optional[Sequence[Union[str, int]]] = ...,
        name: str = ...,
    ) -> None: ...
    @staticmethod
    def from_distances(joints: npt.ArrayLike, lengths: npt.ArrayLike, *, name: str = ...) -> Measurements: ...
    @staticmethod
    def read(
        path: _Path, robot: Robot, *, separator: str = ..., decimal: str = ..., columns: Mapping[str, str] = ...
    ) -> Measurements: ...
    @staticmethod
    def read_distances(
        path: _Path, robot: Robot, *, separator: str = ..., decimal: str = ..., columns: Mapping[str, str] = ...
    ) -> Measurements: ...
    @staticmethod
    def read_contacts(
        path: _Path, robot: Robot, *, separator: str = ..., decimal: str = ..., columns: Mapping[str, str] = ...
    ) -> Measurements: ...
    @property
    def joints(self) -> _Array: ...
    @property
    def positions(self) -> _Array: ...
    @property
    def orientations(self) -> Optional[_Array]: ...
    @property
    def points(self) -> Optional[List[str]]: ...
    @property
    def stations(self) -> List[Measurements]: ...
    def rows(self, rows: npt.ArrayLike) -> Measurements: ...
    def write(self, path: _Path, robot: Robot) -> None: ...
    def __add__(self, other: Measurements) -> Measurements: ...
    def __len__(self) -> int: ...
    def __getstate__(self) -> Tuple[Any, ...]: ...
    def __setstate__(self, state: Tuple[Any, ...]) -> None: ...

class Correction:
    @property
    def command(self) -> _Array: ...
    @property
    def predicted_error(self) -> _Array: ...
    @property
    def gate(self) -> _Array: ...
    @property
    def converged(self) -> Union[bool, npt.NDArray[np.bool_]]: ...
    @property
    def status(self) -> Union[str, List[str]]: ...

class Model:
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def has_covariance(self) -> bool: ...
    @property
    def provenance(self) -> Dict[str, Any]: ...
    def fk(self, q: npt.ArrayLike, previous: Optional[npt.ArrayLike] = ...) -> _Array: ...
    def nominal_fk(self, q: npt.ArrayLike) -> _Array: ...
    def jacobian(self, q: npt.ArrayLike, previous: Optional[npt.ArrayLike] = ...) -> _Array: ...
    def correct(
        self,
        q: npt.ArrayLike,
        previous: Optional[npt.ArrayLike] = ...,
        *,
        seed: Optional[npt.ArrayLike] = ...,
    ) -> Correction: ...
    def correct_path(
        self,
        joints: Optional[npt.ArrayLike] = ...,
        *,
        poses: Optional[npt.ArrayLike] = ...,
        linear: Optional[npt.ArrayLike] = ...,
        start: Optional[npt.ArrayLike] = ...,
        tolerance: float = ...,
        max_joint_step: float = ...,
        approach: bool = ...,
        progress: _Progress = ...,
    ) -> CorrectedPath: ...
    def covariance(self, q: npt.ArrayLike, previous: Optional[npt.ArrayLike] = ...) -> _Array: ...
    def verify(
        self,
        measured: Measurements,
        *,
        base: bool = ...,
        tool: bool = ...,
        level: float = ...,
        accept: Optional[float] = ...,
        use_orientations: bool = ...,
    ) -> Verification: ...
    def export_c(self, name: str = ...) -> str: ...
    def text(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def __getstate__(self) -> Tuple[Any, ...]: ...
    def __setstate__(self, state: Tuple[Any, ...]) -> None: ...

class Predictor:
    @property
    def inputs(self) -> int: ...
    @property
    def outputs(self) -> int: ...
    @property
    def nodes(self) -> int: ...
    def predict(self, X: npt.ArrayLike) -> _Array: ...
    def standard_deviation(self, X: npt.ArrayLike) -> _Array: ...
    def derivative(self, x: npt.ArrayLike) -> _Array: ...
    def __getstate__(self) -> Tuple[Any, ...]: ...
    def __setstate__(self, state: Tuple[Any, ...]) -> None: ...

def load(path: _Path) -> Model: ...
def calibrate(
    robot: Robot,
    data: Measurements,
    *,
    test: Union[int, float, Measurements] = ...,
    seed: int = ...,
    threads: Optional[int] = ...,
    accept: Optional[float] = ...,
    date: str = ...,
    prior: Optional[Model] = ...,
    loss: str = ...,
    position_sigma: float = ...,
    orientation_sigma: float = ...,
    distance_sigma: float = ...,
    contact_sigma: float = ...,
    joint_sigma: float = ...,
    use_orientations: bool = ...,
    keep_outliers: bool = ...,
    refuse_implausible: bool = ...,
    learners: Sequence[str] = ...,
    progress: _Progress = ...,
) -> CalibrationResult: ...
def plan(
    robot: Robot,
    count: int = ...,
    *,
    candidates: int = ...,
    poses: Optional[npt.ArrayLike] = ...,
    box: Optional[npt.ArrayLike] = ...,
    tracker: Optional[npt.ArrayLike] = ...,
    acceptance: float = ...,
    link_radius: float = ...,
    oriented: bool = ...,
    measured: Optional[Measurements] = ...,
    seed: int = ...,
    progress: _Progress = ...,
) -> Plan: ...
def simulate(
    robot: Robot,
    joints: npt.ArrayLike,
    *,
    seed: int = ...,
    position_noise: float = ...,
    orientation_noise: float = ...,
    backlash: float = ...,
    gears: float = ...,
    orientations: bool = ...,
    points: int = ...,
    progress: _Progress = ...,
) -> Measurements: ...
def minimize(
    f: Callable[[_Array], npt.ArrayLike],
    lower: npt.ArrayLike,
    upper: npt.ArrayLike,
    *,
    method: str = ...,
    seed: int = ...,
    population: int = ...,
    generations: int = ...,
    max_evaluations: Optional[int] = ...,
    target: Optional[float] = ...,
    patience: Optional[int] = ...,
    progress: _Progress = ...,
) -> SearchResult: ...
def _fit(
    learner: str,
    options: Dict[str, Any],
    X: npt.ArrayLike,
    Y: npt.ArrayLike,
    weights: Optional[npt.ArrayLike],
    seed: int,
    threads: Optional[int],
    progress: _Progress,
) -> Predictor: ...
def _array_reads() -> Tuple[int, int]: ...
