#pragma once

/// @file
/// Sets of measurements in contiguous memory.

#include <concepts>
#include <ranges>
#include <type_traits>

#include "vernier/core/language.hpp"

namespace vernier {

/// One or more `T` in contiguous memory: a vector, an array, a span.
template <class Range, class T>
concept RangeOf = std::ranges::contiguous_range<const Range> && std::ranges::sized_range<const Range> &&
    std::same_as<std::remove_cvref_t<std::ranges::range_value_t<const Range>>, T>;

}  // namespace vernier
