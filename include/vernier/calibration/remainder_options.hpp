// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What is learned on top of a model: learners, options, and how they did in cross-validation.

#include <string>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A learner of the position error that a model leaves. Each has the mean alone among its candidates.
enum class Learner {
  pso_elm,     ///< ridge ELM whose hidden weights a particle swarm optimises by leave-one-out error
  ridge_elm,   ///< ridge ELM with drawn hidden weights
  kernel_elm,  ///< kernel ELM; a prediction costs an exponential a training pose
};

/// Its name in keys.
inline const char* learner_key(Learner learner) {
  return learner == Learner::pso_elm ? "pso_elm" : learner == Learner::ridge_elm ? "ridge_elm" : "kernel_elm";
}
/// Its name in text.
inline const char* learner_title(Learner learner) {
  return learner == Learner::pso_elm ? "PSO-ELM" : learner == Learner::ridge_elm ? "ridge ELM" : "kernel ELM";
}
/// How the position error that a model leaves is learned.
struct RemainderOptions {
  bool on_geometry = false;    ///< also on geometry alone: the classical alternative to an error model
  bool on_error_model = true;  ///< on the error model
  /// The learners that are tried, each in five folds of consecutive poses, in the order of preference: of those within
  /// a standard error of the best the first is taken, and deployed if cross-validation supports it. The first of all is
  /// learned from all poses in any case.
  std::vector<Learner> learners{Learner::pso_elm, Learner::ridge_elm, Learner::kernel_elm};
  Index max_kernel_poses = 5000;  ///< kernels are tried with up to so many: their time grows with the cube
  int hidden_nodes = 30;          ///< number of hidden nodes of the ELM
  int particles = 20;             ///< of the swarm
  int iterations = 20;            ///< of the swarm; more bring nothing that held-out poses would show
};

/// A learner in cross-validation.
struct RemainderTrial {
  bool on_geometry;        ///< on geometry alone, not on the error model
  Learner learner;         ///< the learner
  double without = 0;      ///< mean leave-one-pose-out error of the model alone [m]
  double with = 0;         ///< the same with the change by what is learned on other folds [m]
  bool supported = false;  ///< whether it is deployed
};

}  // namespace vernier
