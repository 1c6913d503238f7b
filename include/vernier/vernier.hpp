// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What calibration from measured poses and the methods of the paper need, of all that depends on Eigen alone. The rest
/// would make it half as long again to compile. Include by name:
/// - every other learner and search: `learners.hpp`
/// - corrected paths: `compensation/correct_path.hpp`
/// - calibrations that are checked or updated: `calibration/verify_calibration.hpp`,
///   `registration/recursive_calibration.hpp`
/// - all branches of an arm: `kinematics/all_branches.hpp`, `arm_angle_form.hpp`, `general_six_axis.hpp`
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
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/core/version.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/log.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
