// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "vernier/urdf/detail/origin_patch.hpp"
#include "vernier/urdf/export_urdf.hpp"

namespace vernier {

VERNIER_IMPL std::string export_urdf(const UrdfChain& chain, const ArmGeometry& geometry, const ExportNote& note) {
  const std::vector<Isometry3> origins = joint_origins(chain, geometry);
  std::vector<std::pair<std::string, Isometry3>> changed;
  for (std::size_t i = 0; i < origins.size(); ++i)
    if ((origins[i].matrix() - chain.origins[i].matrix()).cwiseAbs().maxCoeff() > 1e-14)
      changed.emplace_back(chain.joints[i], origins[i]);
  return detail::with_origins(chain.text, changed, note.lines());
}

}  // namespace vernier
