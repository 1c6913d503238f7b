// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Tags of an XML text by their bytes, beside a parser that does not tell where they are.

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// A start or end tag, by its bytes.
struct XmlTag {
  std::size_t begin, end;  ///< of `<` and behind `>`
  std::string_view name;
  bool closing, empty;  ///< `</name>`, `<name/>`
};

/// The next tag of a text; none where there is no more.
VERNIER_API std::optional<XmlTag> next_tag(std::string_view text, std::size_t from);

/// Where the value of an attribute of a tag is; none where it has no such attribute.
VERNIER_API std::optional<std::pair<std::size_t, std::size_t>> attribute_value(std::string_view text, const XmlTag& tag,
                                                                               std::string_view name);

/// Requires that every start tag has its end tag: the parser accepts some that have not.
/// @param text the text
/// @param file its name in messages
/// @throws DataError naming the line
VERNIER_API void require_nested_tags(std::string_view text, const std::string& file);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/detail/xml_tags.ipp"
#endif
