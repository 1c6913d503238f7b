// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Searches by name, compiled once for all objectives.

#include <functional>
#include <string>

#include "vernier/search/minimize.hpp"

namespace support {

/// An objective of whole populations, its type forgotten.
using AnyObjective = std::function<void(const Eigen::Ref<const vernier::MatrixX>&, Eigen::Ref<vernier::VectorX>)>;

/// Spends a number of evaluations with the search of that name, each with 50 individuals where it has a population of
/// a chosen size.
vernier::SearchResult run_search(const std::string& name, const AnyObjective& objective, const vernier::Box& box,
                                 vernier::Index evaluations, std::uint64_t seed, vernier::ObserverRef observer);

}  // namespace support
