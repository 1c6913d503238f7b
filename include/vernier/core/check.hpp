// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Checks of arguments: misuse throws, with the numbers in the message.

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "vernier/core/api.hpp"

namespace vernier {

namespace detail {

/// One part of a message: a number, a truth value or a text, which must outlive it.
struct MessagePart {
  /// What it is.
  enum class Kind : unsigned char { text, character, integer, natural, real, single } kind = Kind::text;
  /// Its value, of the type that `kind` names.
  union {
    std::string_view text{};
    char character;
    long long integer;
    unsigned long long natural;
    double real;
    float single;
  };

  template <class T>
  explicit MessagePart(const T& part) {
    if constexpr (std::is_same_v<T, bool>) {
      text = part ? "true" : "false";
    } else if constexpr (std::is_same_v<T, char>) {
      kind = Kind::character;
      character = part;
    } else if constexpr (std::is_same_v<T, float>) {
      kind = Kind::single;
      single = part;
    } else if constexpr (std::is_floating_point_v<T>) {
      kind = Kind::real;
      real = static_cast<double>(part);
    } else if constexpr (std::is_signed_v<T>) {
      kind = Kind::integer;
      integer = part;
    } else if constexpr (std::is_unsigned_v<T>) {
      kind = Kind::natural;
      natural = part;
    } else {
      text = part;
    }
  }
};

VERNIER_API std::string join(std::initializer_list<MessagePart> parts);
VERNIER_API [[noreturn]] void throw_invalid_argument(std::initializer_list<MessagePart> parts);

}  // namespace detail

/// The parts joined into one string; numbers in their shortest exact form.
template <class... Parts>
std::string message(const Parts&... parts) {
  return detail::join({detail::MessagePart(parts)...});
}

/// A number and what it counts: `counted(n, "pose", "poses")` is "1 pose", "2 poses".
template <class Integer>
std::string counted(Integer number, std::string_view one, std::string_view many) {
  return message(number, ' ', number == 1 ? one : many);
}

/// Throws `std::invalid_argument` with the joined parts unless `condition` holds.
template <class... Parts>
void demand(bool condition, const Parts&... parts) {
  if (!condition) [[unlikely]]
    detail::throw_invalid_argument({detail::MessagePart(parts)...});
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/check.ipp"
#endif
