// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Every regressor and every metaheuristic of the library; it needs Eigen alone. `vernier.hpp` has those of the paper
/// and of calibrations. The library's own headers never include this one.

#include "vernier/regression/back_propagation.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ensemble.hpp"
#include "vernier/regression/gaussian_process.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/op_elm.hpp"
#include "vernier/regression/os_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/trigonometric_regression.hpp"
#include "vernier/regression/var_pro_elm.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/log.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/restarted.hpp"
#include "vernier/search/spso2011.hpp"
#include "vernier/search/tuned.hpp"
