// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What calibration from measured poses needs: all of Vernier that depends on Eigen alone, except for seven parts that
/// few programs use, which would add a third to its compile time. Include those by name:
/// - the general inverse kinematics: `kinematics/general_six_axis.hpp`
/// - samples whose numbers of columns are known at run time: `regression/any_predictor.hpp`, `search/any_tuned.hpp`
/// - tables of a tracker: `data/pair_points.hpp`
/// - plans of measurements: `planning/plan_measurements.hpp`
/// - ISO 9283: `evaluation/iso9283.hpp`, `iso9283_poses.hpp`, `iso9283_path.hpp`
/// - calibration by contacts: `identification/identify_by_contacts.hpp`, `simulation/touches.hpp`
/// - robot programs: `robot_programs/correct_program.hpp`
///
/// The library's own headers never include this one.

#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/core/version.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/arm_angle_form.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/recursive_calibration.hpp"
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
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
