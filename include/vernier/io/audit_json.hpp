// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Audits of measured poses as JSON.

#include <nlohmann/json_fwd.hpp>

#include "vernier/calibration/data_audit.hpp"

namespace vernier {

/// An audit: `findings`, each with its `kind` as of `fault_name`, `joint` from 1 (null where no single joint is
/// concerned), `rows` from 0 (empty for all), `size` in the unit of `DataFinding::size` and `message`; and
/// `registered`, position errors of the nominal arm in registered frames: `rows`, `median_mm`, `rms_mm`, `p95_mm`,
/// `max_mm`. Callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json to_json(const DataAudit& audit);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/audit_json.ipp"
#endif
