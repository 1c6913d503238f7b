// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"

#include <charconv>

namespace vernier::detail {

VERNIER_IMPL std::string join(std::initializer_list<MessagePart> parts) {
  using Kind = MessagePart::Kind;
  std::string out;
  for (const MessagePart& part : parts) {
    char buffer[64];
    const auto digits = [&](auto number) {
      out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr);
    };
    switch (part.kind) {
      case Kind::text: out += part.text; break;
      case Kind::character: out += part.character; break;
      case Kind::integer: digits(part.integer); break;
      case Kind::natural: digits(part.natural); break;
      case Kind::real: digits(part.real); break;
      case Kind::single: digits(part.single); break;
    }
  }
  return out;
}

VERNIER_IMPL [[noreturn]] void throw_invalid_argument(std::initializer_list<MessagePart> parts) {
  throw std::invalid_argument(join(parts));
}

}  // namespace vernier::detail
