// SPDX-License-Identifier: BSD-3-Clause
#include "json_file.hpp"

#include "vernier/core/atomic_file.hpp"

namespace support {

void write_json(const std::filesystem::path& path, const Json& document) {
  vernier::write_file(path, document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace support
