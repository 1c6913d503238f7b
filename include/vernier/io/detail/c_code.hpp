#pragma once

/// @file
/// The functions of an exported arm in C. They are the same for every arm; what an arm lacks is left out.

#include <set>
#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Fills a text in. Lines between `@if feature` and `@end` are kept where the feature is there, those between
/// `@if !feature` and `@end` where it is not; both may be nested. `$$` becomes the name in capitals, `$` the name.
VERNIER_API std::string fill_in(std::string_view text, const std::string& name, const std::set<std::string>& features);

/// The declarations, each with its comment.
VERNIER_API std::string_view c_declarations();
/// The types of the tables.
VERNIER_API std::string_view c_types();
/// The functions. They follow the tables.
VERNIER_API std::string c_functions();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_code.ipp"
#endif
