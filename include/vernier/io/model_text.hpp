// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibrated arms from the text of a model file, e.g. from a database or another process.

#include <string>

#include "vernier/io/model_file.hpp"

namespace vernier {

/// Reads the text of a model file, as `read_model` reads the file.
/// @param text the text
/// @param name of the text, in messages
/// @throws DataError with that name and the key
VERNIER_API SavedModel parse_model(const std::string& text, const std::string& name);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/model_text.ipp"
#endif
