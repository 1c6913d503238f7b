# SPDX-License-Identifier: BSD-3-Clause
"""Learners against formulas of NumPy."""
import multiprocessing
import pickle

import numpy as np
import pytest

import vernier
from vernier.learners import Elm


def samples(inputs, outputs, n=120):
    rng = np.random.default_rng(inputs + 10 * outputs)
    x = rng.uniform(-2, 2, (n, inputs))
    mix = rng.normal(size=(inputs, outputs))
    return x, np.sin(x) @ mix + 0.01 * rng.normal(size=(n, outputs))


RECIPES = [vernier.PsoElm(hidden_nodes=15, particles=6, iterations=5), Elm(hidden_nodes=30),
           vernier.GaElm(hidden_nodes=15, individuals=6, generations=5), vernier.RidgeElm(hidden_nodes=40),
           vernier.VarProElm(hidden_nodes=6, iterations=20), vernier.KernelElm(), vernier.GaussianProcess(starts=1)]


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: type(recipe).__name__)
@pytest.mark.parametrize("inputs, outputs", [(1, 1), (2, 5), (11, 3)])
def test_any_number_of_columns(recipe, inputs, outputs):
    x, y = samples(inputs, outputs)
    predictor = recipe.fit(x, y, seed=3)
    assert (predictor.inputs, predictor.outputs) == (inputs, outputs)
    predicted = predictor.predict(x)
    assert predicted.shape == y.shape
    assert ((predicted - y) ** 2).mean() < 0.5 * y.var()
    assert np.array_equal(recipe.fit(x, y, seed=3, threads=1).predict(x), predicted)
    h = 1e-4
    slope = predictor.derivative(x[5])
    for k in range(inputs):
        step = h * np.eye(inputs)[k]
        difference = (predictor.predict(x[5:6] + step) - predictor.predict(x[5:6] - step))[0] / (2 * h)
        np.testing.assert_allclose(slope[:, k], difference, atol=1e-4 * max(1, np.abs(difference).max()))


def predictions(predictor, x):
    """In another process."""
    return predictor.predict(x), repr(predictor)


def test_pickles_keep_their_bits():
    x, y = samples(3, 2)
    predictors = [recipe.fit(x, y, seed=2) for recipe in RECIPES] + [vernier.RidgeElm().fit(x, y[:, 0])]
    here = [predictions(predictor, x) for predictor in predictors]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.starmap(predictions, [(predictor, x) for predictor in predictors])
    for (values, text), (others, other_text) in zip(here, there):
        assert np.array_equal(values, others) and text == other_text
    process = pickle.loads(pickle.dumps(predictors[6]))
    assert np.array_equal(process.standard_deviation(x), predictors[6].standard_deviation(x))
    assert np.array_equal(process.derivative(x[0]), predictors[6].derivative(x[0]))


def test_vectors():
    x, y = samples(3, 1)
    flat = vernier.RidgeElm().fit(x, y[:, 0])
    assert flat.predict(x).shape == (120,)
    assert np.array_equal(flat.predict(x), vernier.RidgeElm().fit(x, y).predict(x)[:, 0])


def test_gaussian_process_is_its_formula():
    """Rasmussen and Williams, algorithm 2.1, with the generalised least-squares mean, at given hyperparameters."""
    x, y = samples(2, 1, n=40)
    scale, ratio = 0.4, 0.01
    predictor = vernier.GaussianProcess(length_scales=(scale, scale), noise_ratio=ratio).fit(x, y[:, 0])
    low, high = x.min(axis=0), x.max(axis=0)
    at = np.random.default_rng(1).uniform(-1.5, 1.5, (10, 2))

    def features(points, unit):
        return unit(points) / scale

    errors = []
    for unit in (lambda p: (p - low) / (high - low), lambda p: 2 * (p - low) / (high - low) - 1):
        a, b = features(x, unit), features(at, unit)
        kernel = np.exp(-((a[:, None] - a[None]) ** 2).sum(-1) / 2) + ratio * np.eye(40)
        ones, inverse = np.ones(40), np.linalg.inv(kernel)
        mean = ones @ inverse @ y[:, 0] / (ones @ inverse @ ones)
        cross = np.exp(-((b[:, None] - a[None]) ** 2).sum(-1) / 2)
        errors.append(np.abs(predictor.predict(at) - (mean + cross @ inverse @ (y[:, 0] - mean))).max())
    assert min(errors) < 1e-9  # inputs are scaled to [0, 1] or to [-1, 1]
    assert (predictor.standard_deviation(at) > 0).all()


def test_refusals():
    x, y = samples(2, 1)
    with pytest.raises(ValueError, match="119 rows of targets"):
        vernier.RidgeElm().fit(x, y[:-1])
    with pytest.raises(ValueError, match="not finite"):
        vernier.RidgeElm().fit(np.where(x == x[3], np.nan, x), y)
    with pytest.raises(ValueError, match="samples of 3 inputs, it was fitted to 2"):
        vernier.RidgeElm().fit(x, y).predict(np.zeros((1, 3)))
    with pytest.raises(ValueError, match="no standard deviations"):
        vernier.RidgeElm().fit(x, y).standard_deviation(x)
    with pytest.raises(ValueError, match="activation: 'relu'"):
        vernier.RidgeElm(activation="relu").fit(x, y)
    for nodes, words in [("a", "hidden_nodes: 'a' cannot be used"), (2.5, "2.5 cannot"), (-1, "is -1, must be at least 1")]:
        for recipe in (vernier.RidgeElm, vernier.PsoElm, Elm):
            with pytest.raises(ValueError, match=words):
                recipe(hidden_nodes=nodes).fit(x, y)
    with pytest.raises(TypeError):
        vernier.RidgeElm(nodes=3)


def test_progress_ends_it():
    x, y = samples(3, 1)

    def stop(progress):
        raise StopIteration

    with pytest.raises(StopIteration):
        vernier.PsoElm(iterations=100000).fit(x, y, progress=stop)
