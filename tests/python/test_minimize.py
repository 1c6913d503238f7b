# SPDX-License-Identifier: BSD-3-Clause
"""Searches of Python's objectives."""
import threading

import numpy as np
import pytest
from scipy.optimize import rosen

import vernier

METHODS = ["pso", "spso2011", "ga", "real_ga", "de", "cma_es", "random"]


def sphere(x):
    return ((x - 0.3) ** 2).sum(axis=1)


@pytest.mark.parametrize("method", METHODS)
def test_methods_find_the_minimum(method):
    found = vernier.minimize(sphere, [-1, -2], [1, 2], method=method, seed=1, generations=80)
    tolerance = {"ga": 0.02, "random": 0.1}.get(method, 0.01)
    assert np.abs(found.best - 0.3).max() < tolerance
    assert found.value == sphere(found.best[None])[0]
    again = vernier.minimize(sphere, [-1, -2], [1, 2], method=method, seed=1, generations=80)
    assert np.array_equal(again.best, found.best) and again.evaluations == found.evaluations
    assert repr(found).startswith("<vernier.SearchResult:")


def test_whole_populations_on_the_calling_thread():
    shapes, here = set(), threading.get_ident()

    def f(x):
        assert threading.get_ident() == here and (x >= -1).all() and (x <= 2).all()
        shapes.add(x.shape)
        return rosen(x.T)

    found = vernier.minimize(f, [-1] * 3, [2] * 3, method="cma_es", population=20, generations=300, seed=2)
    assert shapes == {(20, 3)} and found.evaluations % 20 == 0
    np.testing.assert_allclose(found.best, 1, atol=1e-3)


def test_stopping():
    calls = []
    found = vernier.minimize(sphere, [-1], [1], target=1e-4, progress=calls.append)
    assert found.status == "target_reached" and found.value <= 1e-4
    assert [p.generation for p in calls] == list(range(len(calls))) and calls[-1].best == found.value
    assert vernier.minimize(sphere, [-1], [1], max_evaluations=500).evaluations <= 500


def test_exceptions_pass():
    def fails(x):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        vernier.minimize(fails, [-1], [1])
    with pytest.raises(ValueError, match="it returned 1 for 50 points"):
        vernier.minimize(lambda x: [1.0], [-1], [1])
    with pytest.raises(ValueError, match="no method is called 'newton'"):
        vernier.minimize(sphere, [-1], [1], method="newton")
    with pytest.raises(ValueError):
        vernier.minimize(sphere, [1], [-1])
    nan = vernier.minimize(lambda x: np.full(len(x), np.nan), [-1], [1], generations=2)
    assert np.isinf(nan.value)
