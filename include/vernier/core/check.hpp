#pragma once

/// @file
/// Checks at the public doors: misuse throws, with the numbers in the message.

#include <charconv>
#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace vernier {

namespace detail {

/// Text of one part of a message; numbers in their shortest exact form.
template <class T>
std::string text(const T& part) {
  if constexpr (std::is_same_v<T, bool>) {
    return part ? "true" : "false";
  } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, char>) {
    char buffer[64];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, part).ptr;
    return {buffer, end};
  } else if constexpr (std::is_same_v<T, char>) {
    return std::string(1, part);
  } else {
    return std::string(std::string_view(part));
  }
}

}  // namespace detail

/// The parts joined into one string; numbers in their shortest exact form.
template <class... Parts>
std::string message(const Parts&... parts) {
  std::string out;
  ((out += detail::text(parts)), ...);
  return out;
}

/// Throws `std::invalid_argument` with the joined parts unless `condition` holds.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) [[unlikely]]
    throw std::invalid_argument(message(parts...));
}

}  // namespace vernier
