#pragma once

/// @file
/// The language that every header needs, checked before the first line that an older one cannot read.

/// @cond
#if __cplusplus <= 201703L
#error "Vernier needs C++20: compile with -std=c++20"
#include <C++20>  // Does not exist: this ends the compilation, else thousands of lines would follow the sentence.
#endif
/// @endcond
