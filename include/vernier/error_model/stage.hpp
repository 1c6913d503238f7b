// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The stages of a calibration, and the blocks of unknowns on which it decides: one table each. A new effect is a row
/// of both. `evaluate`, the verdict, tables and JSON of reports follow them.

#include <array>
#include <cstddef>
#include <string_view>

#include "vernier/core/language.hpp"

namespace vernier {

/// Stages of a calibration, in order. Each has the effects of those before it, as far as the data support them.
enum class Stage {
  frames,            ///< links as designed, base and tool registered
  geometry,          ///< identified geometry
  geometry_learned,  ///< what a learner found on top of the geometry
  elastic,           ///< gravity compliance
  jointwise,         ///< functions of single joints
  approach,          ///< hysteresis by the direction of approach
  tilt,              ///< tilts of joint frames under gravity
  temperature,       ///< changes of the geometry with temperature
  prior,             ///< fitted again with an earlier calibration as the prior
  learned,           ///< what a learner found on top of the last error model, of poses without hysteresis and drift
  session,           ///< moved by the drift of the session, which no other session has
  as_fitted,         ///< a check: in the frames of an earlier calibration
  registered,        ///< a check: in frames registered from the same poses
  reregistered,      ///< a re-registration: in its new frames
};

/// What is known of a stage.
struct StageTraits {
  Stage stage;           ///< itself
  const char* key;       ///< in files; of learned stages the learner's key follows
  const char* title;     ///< in tables
  bool visits = false;   ///< whether a pose is predicted with its direction of approach
  bool thermal = false;  ///< whether it is predicted at its temperature; otherwise at the mean of the training poses
  bool drift = false;    ///< whether it is predicted with the drift of the session
};

/// All stages, by their number.
inline constexpr std::array<StageTraits, 14> stage_rows{{
    {Stage::frames, "frames", "frames"},
    {Stage::geometry, "geometry", "geometry"},
    {Stage::geometry_learned, "geometry_", "geometry"},
    {Stage::elastic, "elastic", "elastic"},
    {Stage::jointwise, "jointwise", "joint-wise"},
    {Stage::approach, "approach", "approach", true},
    {Stage::tilt, "tilt", "tilt", true},
    {Stage::temperature, "temperature", "temperature", true, true},
    {Stage::prior, "prior", "prior", true, true},
    {Stage::learned, "jointwise_", "joint-wise"},
    {Stage::session, "session", "session", true, true, true},
    {Stage::as_fitted, "as_fitted", "as fitted"},
    {Stage::registered, "registered", "registered"},
    {Stage::reregistered, "reregistered", "re-registered"},
}};

/// What is known of a stage.
constexpr const StageTraits& traits_of(Stage stage) { return stage_rows[static_cast<std::size_t>(stage)]; }

/// Blocks of unknowns on which a fit decides by left-out poses.
enum class Block {
  elastic,        ///< gravity compliance
  jointwise,      ///< functions of single joints
  gears,          ///< gear ratios and coupling, beside functions of single joints
  elastic_again,  ///< gravity compliance, beside functions of single joints
  tuned_priors,   ///< priors that a search found
  approach,       ///< hysteresis
  tilt,           ///< tilts of joint frames
  temperature,    ///< changes of the geometry with temperature
  prior,          ///< an earlier calibration
  lines,          ///< orders found in the residuals
  drift,          ///< of the bases
  joint_drift,    ///< of the joints' zeros, beside the bases
  straightness,   ///< departures of prismatic joints from a straight motion
  payload_bend,   ///< bends across the joints' axes under a payload
};

/// What is known of a block.
struct BlockTraits {
  Block block;        ///< itself
  const char* key;    ///< in files
  const char* title;  ///< in sentences, in lower case
};

/// All blocks, by their number.
inline constexpr std::array<BlockTraits, 14> block_rows{{
    {Block::elastic, "elastic", "gravity compliance"},
    {Block::jointwise, "jointwise", "functions of single joints"},
    {Block::gears, "gears", "gear ratios and coupling"},
    {Block::elastic_again, "elastic_with_jointwise", "gravity compliance beside functions of single joints"},
    {Block::tuned_priors, "tuned_priors", "optimised priors"},
    {Block::approach, "approach", "hysteresis by the direction of approach"},
    {Block::tilt, "tilt", "tilts of joint frames under gravity"},
    {Block::temperature, "temperature", "change of the geometry with temperature"},
    {Block::prior, "prior", "earlier calibration as the prior"},
    {Block::lines, "lines", "further orders of the joints' functions"},
    {Block::drift, "drift", "drift of the base"},
    {Block::joint_drift, "joint_drift", "drift of the joints' zeros"},
    {Block::straightness, "straightness", "straightness of prismatic joints"},
    {Block::payload_bend, "payload_bend", "bends across the joints' axes under a payload"},
}};

/// What is known of a block.
constexpr const BlockTraits& traits_of(Block block) { return block_rows[static_cast<std::size_t>(block)]; }

namespace detail {

/// Whether each row of a table has the number of its place.
template <class Table, class F>
constexpr bool in_order(const Table& table, const F& number) {
  for (std::size_t k = 0; k < table.size(); ++k)
    if (static_cast<std::size_t>(number(table[k])) != k) return false;
  return true;
}
static_assert(in_order(stage_rows, [](const StageTraits& row) { return row.stage; }));
static_assert(in_order(block_rows, [](const BlockTraits& row) { return row.block; }));

}  // namespace detail

}  // namespace vernier
