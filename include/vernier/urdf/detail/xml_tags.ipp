// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/urdf/detail/xml_tags.hpp"

namespace vernier::detail {

VERNIER_IMPL std::optional<XmlTag> next_tag(std::string_view text, std::size_t from) {
  constexpr std::pair<std::string_view, std::string_view> passed[] = {
      {"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}, {"<!", ">"}};
  for (std::size_t at = text.find('<', from); at != std::string_view::npos; at = text.find('<', at)) {
    const std::string_view here = text.substr(at);
    const auto* other = std::find_if(std::begin(passed), std::end(passed),
                                     [&](const auto& marks) { return here.starts_with(marks.first); });
    if (other != std::end(passed)) {
      const std::size_t end = text.find(other->second, at + other->first.size());
      if (end == std::string_view::npos) return std::nullopt;
      at = end + other->second.size();
      continue;
    }
    std::size_t end = at + 1;
    for (char quote = 0; end < text.size(); ++end) {
      const char c = text[end];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        break;
      }
    }
    if (end >= text.size()) return std::nullopt;
    const bool closing = here.starts_with("</");
    std::string_view name = text.substr(at + (closing ? 2 : 1), end - at - (closing ? 2 : 1));
    name = name.substr(0, name.find_first_of(" \t\r\n/"));
    return XmlTag{at, end + 1, name, closing, text[end - 1] == '/'};
  }
  return std::nullopt;
}

VERNIER_IMPL std::optional<std::pair<std::size_t, std::size_t>> attribute_value(std::string_view text,
                                                                                const XmlTag& tag,
                                                                                std::string_view name) {
  for (std::size_t at = tag.begin + 1 + tag.name.size(); at < tag.end;) {
    at = text.find_first_not_of(" \t\r\n", at);
    const std::size_t name_end = text.find_first_of(" \t\r\n=>", at);
    if (name_end >= tag.end || text[name_end] == '>') break;
    const std::size_t open = text.find_first_of("\"'", name_end);
    if (open >= tag.end) break;
    const std::size_t close = text.find(text[open], open + 1);
    if (text.substr(at, name_end - at) == name) return std::pair{open + 1, close};
    at = close + 1;
  }
  return std::nullopt;
}

VERNIER_IMPL void require_nested_tags(std::string_view text, const std::string& file) {
  std::vector<std::string_view> open;
  for (std::optional<XmlTag> tag = next_tag(text, 0); tag; tag = next_tag(text, tag->end)) {
    bool right = !tag->name.empty();
    if (!tag->closing) {
      if (!tag->empty) open.push_back(tag->name);
    } else if (right = right && !tag->empty && !open.empty() && open.back() == tag->name; right) {
      open.pop_back();
      const std::string_view behind =
          text.substr(tag->begin + 2 + tag->name.size(), tag->end - 1 - (tag->begin + 2 + tag->name.size()));
      right = behind.find_first_not_of(" \t\r\n") == std::string_view::npos;
    }
    if (!right) {
      const auto begin = text.begin();
      const auto line = 1 + std::count(begin, begin + static_cast<std::ptrdiff_t>(tag->begin), '\n');
      throw DataError(message(file, ", line ", line, ": not valid XML (start and end tags do not match)"));
    }
  }
  if (!open.empty()) throw DataError(file + ": not valid XML (an end tag is missing)");
}

}  // namespace vernier::detail
