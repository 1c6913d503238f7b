#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""SciPy as a peer: an ELM's fitness and an identification as one writes them in Python, one thread.

usage: scipy_peers.py FOLDER    where elm_benchmark.txt and identification_benchmark.txt of `./dev bench` are

Problems of the same size and kind as in those programs, drawn here: numbers differ, the work does not. Each ratio is
SciPy's median time divided by Vernier's as those files give it, with SciPy's quartiles; above 1 Vernier is faster.
"""

import os

for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ[library + "_NUM_THREADS"] = "1"

import re
import sys
import time

import numpy as np
import scipy.linalg
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


def vernier_seconds(folder, program, topic):
    """Vernier's median of a topic, as a program printed it."""
    path = os.path.join(folder, program + ".txt")
    try:
        with open(path) as text:
            lines = text.readlines()
    except OSError as error:
        sys.exit(f"scipy_peers.py: {path}: {error.strerror}; ./dev bench writes it")
    for line in lines:
        found = re.match(re.escape(topic) + r"/vernier\s+([\d.]+(?:e[+-]?\d+)?) (\w+)", line)
        if found:
            return float(found[1]) * UNITS[found[2]]
    sys.exit(f"scipy_peers.py: {program}.txt has no line {topic}/vernier")


def seconds(call, repetitions=9):
    """Quartiles of the processor time of one call."""
    call()
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return np.percentile(times, [25, 50, 75])


def report(topic, peer, times, ours):
    low, median, high = times / ours
    print(f"ratio  {topic:<26} {peer:<32} {median:6.2f}  [{low:.2f} .. {high:.2f}]   {times[1] * 1e3:.2f} ms")


def elm(rng):
    """Fitness of one particle: 5,000 samples, 6 inputs, 65 nodes, 3 outputs."""
    inputs, targets = rng.uniform(-1, 1, (5000, 6)), rng.uniform(-1, 1, (5000, 3))
    weights, biases = rng.uniform(-1, 1, (6, 65)), rng.uniform(-1, 1, 65)

    def hidden():
        return 1 / (1 + np.exp(-(inputs @ weights + biases)))

    def by_gram():
        h = hidden()
        gram = h.T @ h
        gram[np.diag_indices(65)] += 1e-10 * np.trace(gram) / 65
        beta = scipy.linalg.cho_solve(scipy.linalg.cho_factor(gram), h.T @ targets)
        return np.square(h @ beta - targets).mean()

    def by_svd():
        h = hidden()
        return np.square(h @ scipy.linalg.lstsq(h, targets)[0] - targets).mean()

    if abs(by_gram() / by_svd() - 1) > 1e-6:
        sys.exit("scipy_peers.py: the two fitnesses differ")
    return by_gram, by_svd


NOMINAL = np.array([  # a, alpha, d, theta, beta of an ABB IRB 120
    [0, -np.pi / 2, 0.290, 0, 0], [0.270, 0, 0, -np.pi / 2, 0], [0.070, -np.pi / 2, 0, 0, 0],
    [0, np.pi / 2, 0.302, 0, 0], [0, -np.pi / 2, 0, 0, 0], [0, 0, 0.072, np.pi, 0]])


def positions(parameters, joints):
    """Tool positions of all poses: base (6), five parameters a joint, tool (6); the point carried backwards."""
    base, table, tool = parameters[:6], parameters[6:36].reshape(6, 5), parameters[36:]
    x, y, z = (np.full(len(joints), v) for v in tool[:3])
    for (a, alpha, d, theta, beta), q in zip(table[::-1], joints.T[::-1]):
        x, z = np.cos(beta) * x + np.sin(beta) * z, np.cos(beta) * z - np.sin(beta) * x
        y, z = np.cos(alpha) * y - np.sin(alpha) * z, np.sin(alpha) * y + np.cos(alpha) * z
        x, z, c, s = x + a, z + d, np.cos(theta + q), np.sin(theta + q)
        x, y = c * x - s * y, s * x + c * y
    return np.column_stack([x, y, z]) @ Rotation.from_rotvec(base[3:]).as_matrix().T + base[:3]


def identification(rng):
    """27 parameters from 200 positions with 0.03 mm noise, from the nominal arm in nearly known frames."""
    joints = rng.uniform(-1, 1, (200, 6)) + [0, 0, 0, 0, 0.8, 0]
    start = np.concatenate([[0.4, -0.3, 0.1, 0.1, -0.2, 1.0], NOMINAL.ravel(), [0.03, 0.02, 0.1, 0, 0, 0]])
    sizes = np.concatenate([[1e-3] * 3 + [1e-3] * 3, np.tile([1e-3] * 5, 6), [1e-3] * 6])
    actual = start + sizes * rng.normal(size=42)
    measured = positions(actual, joints) + 0.03e-3 * rng.normal(size=(200, 3))

    def residuals(steps, free):
        moved = start.copy()
        moved[free] += sizes[free] * steps
        return ((positions(moved, joints) - measured) / 0.03e-3).ravel()

    # as many columns as these positions tell apart, by a pivoted QR of the Jacobian
    everything = np.arange(42)
    steps = np.eye(42) * 1e-3
    jacobian = np.column_stack([(residuals(s, everything) - residuals(-s, everything)) / 2e-3 for s in steps])
    triangle, order = scipy.linalg.qr(jacobian, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    free = np.sort(order[: np.count_nonzero(diagonal > 1e-7 * diagonal[0])])

    def solve():
        return least_squares(residuals, np.zeros(len(free)), args=(free,), method="lm", ftol=1e-12, xtol=1e-13, gtol=1e-15)

    found = solve()
    rms = np.sqrt(np.square(found.fun).mean())
    if not 0.8 < rms < 1.1:
        sys.exit(f"scipy_peers.py: the identification ends at {rms:.3f} of the noise")
    return solve, len(free)


def main():
    if sys.argv[1:] in (["-h"], ["--help"]):
        print(__doc__)
        return
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    folder, rng = sys.argv[1], np.random.default_rng(1)
    fitness = vernier_seconds(folder, "elm_benchmark", "fitness")
    identify = vernier_seconds(folder, "identification_benchmark", "identify")
    by_gram, by_svd = elm(rng)
    solve, free = identification(rng)
    report("fitness", "NumPy, Gram + Cholesky", seconds(by_gram), fitness)
    report("fitness", "NumPy, scipy.linalg.lstsq", seconds(by_svd), fitness)
    report("identify", "scipy.optimize.least_squares", seconds(solve, 5), identify)
    print(f"\n{free} free parameters; SciPy {scipy.__version__}, NumPy {np.__version__}")


main()
