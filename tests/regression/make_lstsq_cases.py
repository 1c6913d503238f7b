#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes lstsq_cases.hpp: hidden layers and the output weights that SciPy's lstsq gives for them.

    python3 tests/regression/make_lstsq_cases.py > tests/regression/lstsq_cases.hpp

Cut and condition are chosen so that the singular values beside the cut are far apart; where those that are kept still
span many decades, the output weights are not determined to 1e-9 and the test compares H beta.
"""
import numpy as np
import scipy.linalg
from scipy.special import expit

rng = np.random.default_rng(2006)


def layer(x, theta, activation):
    """H of inputs n x d at weights (d + 1) x nodes, biases in the last row."""
    w, b = theta[:-1], theta[-1]
    if activation == "radial_basis":
        return np.exp(-(b**2) * ((x[:, :, None] - w[None, :, :]) ** 2).sum(axis=1))
    z = x @ w + b
    return {"sigmoid": expit, "tanh": np.tanh, "sine": np.sin}[activation](z)


def weights(nodes, scale=3.0, inputs=2):
    return rng.uniform(-scale, scale, (inputs + 1, nodes))


def case(name, activation, n, theta, rcond, compare_beta, outputs=2):
    x = rng.uniform(-1, 1, (n, len(theta) - 1))
    t = rng.normal(size=(n, outputs))
    h = layer(x, theta, activation)
    beta, _, rank, s = scipy.linalg.lstsq(h, t, cond=rcond)
    ratios = s / s[0]
    kept, dropped = ratios[:rank], ratios[rank:]
    gap = kept[-1] / rcond if rcond > 0 else np.inf
    assert gap > 5 and all(r < rcond / 5 for r in dropped), (name, ratios)
    assert compare_beta == (kept[-1] > 1e-4), (name, ratios)

    def numbers(m):
        return "{" + ", ".join("%.17g" % v for v in m.flatten(order="F")) + "}"

    return "    {\"%s\", Activation::%s, %d, %d, %d, %d, %r, %s,\n" % (
        name, activation, n, x.shape[1], h.shape[1], outputs, rcond, "true" if compare_beta else "false"
    ) + "".join("     %s,\n" % numbers(m) for m in (x, theta, h, t)) + "     %s},\n" % numbers(beta)


repeated = weights(6)
repeated[:, 4] = repeated[:, 1]
repeated[:, 5] = repeated[:, 1]
repeated_wide = weights(9)
repeated_wide[:, 7] = repeated_wide[:, 0]
cases = [
    case("tall", "sigmoid", 14, weights(4), 1e-12, True),
    case("square", "sine", 5, weights(5), 1e-12, True),
    case("wide", "tanh", 5, weights(8), 1e-12, True),
    case("radial basis", "radial_basis", 12, weights(4, 1.5), 1e-12, True),
    case("one sample", "sigmoid", 1, weights(3), 1e-12, True),
    case("repeated nodes, tall", "sigmoid", 15, repeated, 1e-10, True),
    case("repeated nodes, as many as samples", "tanh", 6, repeated, 1e-10, True),
    case("repeated node, wide", "sine", 5, repeated_wide, 1e-10, True),
    case("repeated inputs", "tanh", 9, weights(6), 1e-12, True, 1),
    case("small weights, cut where the layer stops being linear", "sigmoid", 15, weights(6, 0.05), 5e-5, True),
    case("small weights, nothing cut", "sigmoid", 15, weights(6, 0.1), 1e-12, False),
]

print("""#pragma once

// Written by make_lstsq_cases.py with SciPy %s; matrices column by column.

#include <vector>

#include "vernier/regression/hidden_layer.hpp"

namespace vernier::lstsq {

struct Case {
  const char* name;
  Activation activation;
  Index samples, inputs, nodes, outputs;
  double rcond;
  bool compare_beta;  // otherwise H beta
  std::vector<double> x, theta, h, t, beta;
};

// clang-format off
inline const std::vector<Case> cases = {""" % scipy.__version__)
print("".join(cases), end="")
print("""};
// clang-format on

}  // namespace vernier::lstsq""")
