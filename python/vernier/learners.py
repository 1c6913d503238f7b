# SPDX-License-Identifier: BSD-3-Clause
"""Learners of maps from samples: recipes whose `fit` returns a `Predictor`. Any number of columns."""
from dataclasses import asdict, dataclass
from typing import Any, Callable, Optional, Tuple

import numpy.typing as npt

from ._vernier import Predictor, Progress, _fit


class Learner:
    """A recipe. `fit(X, Y)` takes X of shape (n, inputs) and Y of (n, outputs) or (n,)."""

    def fit(self, X: npt.ArrayLike, Y: npt.ArrayLike, *, weights: Optional[npt.ArrayLike] = None, seed: int = 0,
            threads: Optional[int] = None, progress: Optional[Callable[[Progress], object]] = None) -> Predictor:
        """Fits samples; the same seed gives the same bits, on any number of threads."""
        options: Any = asdict(self)
        return _fit(type(self).__name__, options, X, Y, weights, seed, threads, progress)


@dataclass(frozen=True)
class Elm(Learner):
    """Extreme learning machine: hidden weights are drawn, output weights are those of least squares."""

    hidden_nodes: int = 65
    activation: str = "sigmoid"
    input_map: str = "raw"
    weight_limit: float = 1.0


@dataclass(frozen=True)
class PsoElm(Learner):
    """Extreme learning machine whose hidden weights a particle swarm searches."""

    hidden_nodes: int = 65
    particles: int = 50
    iterations: int = 300
    activation: str = "sigmoid"
    input_map: str = "raw"
    weight_limit: float = 1.0


@dataclass(frozen=True)
class GaElm(Learner):
    """Extreme learning machine whose hidden weights a genetic algorithm searches."""

    hidden_nodes: int = 65
    individuals: int = 80
    generations: int = 400
    activation: str = "sigmoid"
    input_map: str = "raw"
    weight_limit: float = 1.0


@dataclass(frozen=True)
class RidgeElm(Learner):
    """Extreme learning machine with a ridge, chosen by leave-one-out errors."""

    hidden_nodes: int = 65
    activation: str = "sigmoid"
    input_map: str = "sines_and_cosines"
    weight_limit: float = 1.0


@dataclass(frozen=True)
class VarProElm(Learner):
    """Extreme learning machine whose hidden layer is trained by variable projection."""

    hidden_nodes: int = 65
    iterations: int = 100
    starts: int = 1
    activation: str = "sigmoid"
    input_map: str = "sines_and_cosines"
    weight_limit: float = 1.0


@dataclass(frozen=True)
class KernelElm(Learner):
    """Kernel ridge regression with a Gaussian kernel; length scale and ridge by leave-one-out errors where not given."""

    input_map: str = "raw"
    length_scale: Optional[float] = None
    ridge: Optional[float] = None
    max_search_samples: int = 500


@dataclass(frozen=True)
class GaussianProcess(Learner):
    """Gaussian process regression; the most likely length scales and noise where not given."""

    input_map: str = "raw"
    length_scales: Tuple[float, ...] = ()
    noise_ratio: Optional[float] = None
    starts: int = 3
    iterations: int = 60
    max_hyper_samples: int = 300
