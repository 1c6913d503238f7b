#pragma once

/// @file
/// JSON files, read with errors that name file, line and column, written whole or not at all.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"

namespace support {

using Json = nlohmann::ordered_json;  ///< keeps the order in which members were added

/// Writes a document with two spaces a level. A number that is not finite becomes null.
/// @throws std::runtime_error naming the file and the reason
inline void write_json(const std::filesystem::path& path, const Json& document) {
  vernier::write_file(path, document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Reads a document.
/// @throws std::invalid_argument naming the file, and the line and column of what is no JSON
inline Json read_json(const std::filesystem::path& path) {
  const std::string text = vernier::read_file(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < error.byte && i < text.size(); ++i) {
      column = text[i] == '\n' ? 1 : column + 1;
      line += text[i] == '\n' ? 1 : 0;
    }
    throw std::invalid_argument(
        vernier::message(path.string(), ", line ", line, ", column ", column, ": this is not JSON"));
  } catch (const Json::exception&) {  // a number beyond any double
    throw std::invalid_argument(path.string() + ": a number in it is out of range");
  }
}

}  // namespace support
