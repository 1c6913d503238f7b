#pragma once

/// @file
/// All of Vernier that needs Eigen alone. The library's own headers never include it.

#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/core/version.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/identification/fit_error_model.hpp"
#include "vernier/identification/online_update.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/var_pro_elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
