// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The C text that all exported arms have in common. It stands in the files of the folder `c`, which are C as they are
/// but for their first and last lines: those make a file a string literal, so that it can be included here.

#include <set>
#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// What is called from outside, each function with its comment.
inline constexpr std::string_view c_declarations =
#include "vernier/io/detail/c/declarations.c"
    ;

/// The types of the tables.
inline constexpr std::string_view c_types =
#include "vernier/io/detail/c/types.c"
    ;

/// The functions, which follow the tables; each file uses those before it.
inline constexpr std::string_view c_functions[] = {
#include "vernier/io/detail/c/vectors.c"
    ,
#include "vernier/io/detail/c/chain.c"
    ,
#include "vernier/io/detail/c/joint_errors.c"
    ,
#include "vernier/io/detail/c/gates.c"
    ,
#include "vernier/io/detail/c/learned.c"
    ,
#include "vernier/io/detail/c/arm.c"
    ,
#include "vernier/io/detail/c/correction.c"
};

/// A name as it begins those of macros.
VERNIER_API std::string c_capitals(std::string name);

/// A text of which identifiers begin with a name where they began with `arm_`, in capitals where they began with
/// `ARM_`.
VERNIER_API std::string with_name(std::string_view text, const std::string& name);

/// One of the texts above for an arm with a name and some features. Lines between `#if HAS_FEATURE`, `#if
/// !HAS_FEATURE`,
/// `#else` and `#endif` are kept as a preprocessor would keep them, and what begins a file as a string literal becomes
/// an empty line before the text. Of a text that is left out altogether nothing remains.
VERNIER_API std::string fill_in(std::string_view text, const std::string& name, const std::set<std::string>& features);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_code.ipp"
#endif
