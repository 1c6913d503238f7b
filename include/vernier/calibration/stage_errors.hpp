// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Errors of poses after each stage of a calibration.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/calibration/remainder_options.hpp"
#include "vernier/error_model/stage.hpp"

namespace vernier {

/// A stage; of learned ones with its learner, since several may be assessed.
struct StageName {
  Stage stage = Stage::geometry;     ///< the stage
  std::optional<Learner> learner{};  ///< of `geometry_learned` and `learned`

  /// Geometry.
  StageName() = default;
  /// A stage, learned ones with their learner.
  StageName(Stage of, std::optional<Learner> by = {}) : stage(of), learner(by) {}
  /// Whether both are one stage by one learner.
  friend bool operator==(const StageName&, const StageName&) = default;

  /// Its key in files: `jointwise`, `jointwise_pso_elm`.
  VERNIER_API std::string key() const {
    return std::string(traits_of(stage).key) + (learner ? learner_key(*learner) : "");
  }
};

/// The stage of a learner on geometry alone, or on the error model.
VERNIER_API inline StageName learned_stage(bool on_geometry, Learner learner) {
  return {on_geometry ? Stage::geometry_learned : Stage::learned, learner};
}

/// Errors of poses after a stage.
struct StageErrors {
  StageName name;     ///< of the stage
  std::string title;  ///< for tables
  VectorX position;   ///< [m]
  VectorX rotation;   ///< [rad]; empty where orientations are not used

  /// @param of               the stage, whose title it has
  /// @param position_errors  n values [m]
  /// @param rotation_errors  n values [rad], or none
  VERNIER_API StageErrors(Stage of, VectorX position_errors, VectorX rotation_errors)
      : StageErrors(of, traits_of(of).title, std::move(position_errors), std::move(rotation_errors)) {}
  /// Errors of a stage with a title of its own.
  VERNIER_API StageErrors(StageName of, std::string its_title, VectorX position_errors, VectorX rotation_errors)
      : name(of),
        title(std::move(its_title)),
        position(std::move(position_errors)),
        rotation(std::move(rotation_errors)) {}

  /// Its key in files.
  VERNIER_API std::string key() const { return name.key(); }
};

/// A table of the position errors [mm] of stages, and of their mean orientation errors [mrad] where used, in three
/// significant digits.
VERNIER_API std::string stage_table(const std::vector<StageErrors>& stages);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/stage_errors.ipp"
#endif
