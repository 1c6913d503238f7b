// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/version.hpp"
#include "vernier/urdf/export_note.hpp"

namespace vernier {

VERNIER_IMPL std::vector<std::string> ExportNote::lines() const {
  const auto plain = [](std::string text) {
    for (char& c : text)
      if (c < ' ' || c > '~') c = '?';
    return text;
  };
  const auto error = [](const ErrorStatistics& of) {
    const auto mm = [](double metres) { return std::round(metres * 1e6) / 1e3; };
    return message("mean ", mm(of.mean), " mm, 95 % ", mm(of.p95), " mm, max ", mm(of.max), " mm");
  };
  return {message("geometry of ", plain(robot), ", calibrated by Vernier ", VERNIER_VERSION_MAJOR, ".",
                  VERNIER_VERSION_MINOR, ".", VERNIER_VERSION_PATCH, ", ", plain(date)),
          message("fitted to ", fitted_poses, ' ', what, " of ", plain(data), "; position errors of ",
                  held_out ? message(error_full.n, " held-out ") : "these ", what, ':'),
          message("this file: ", error(error_exported)),
          message("full model (", plain(full_model), "): ", error(error_full)),
          "Do not send commands that were corrected by that model to whatever uses this file: they would be corrected "
          "twice."};
}

}  // namespace vernier
