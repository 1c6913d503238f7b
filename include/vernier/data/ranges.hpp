// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sets of measurements in contiguous memory.

#include <concepts>
#include <cstddef>
#include <iterator>
#include <type_traits>

#include "vernier/core/language.hpp"

namespace vernier {

/// One or more `T` in contiguous memory: a vector, an array, a span.
template <class Range, class T>
concept RangeOf = requires(const Range& range) {
  { std::size(range) } -> std::convertible_to<std::size_t>;
  requires std::same_as<std::remove_cvref_t<decltype(*std::data(range))>, T>;
};

}  // namespace vernier
