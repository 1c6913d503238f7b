// SPDX-License-Identifier: BSD-3-Clause
// URDF files: the chain that is read has the origins of its joints.
#include "reader_fuzz.hpp"
#include "vernier/urdf/urdf_chain.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    const vernier::UrdfChain chain = vernier::read_urdf(path);
    const auto origins = vernier::joint_origins(chain, chain.robot.geometry());
    for (std::size_t i = 0; i < origins.size(); ++i)
      if (!origins[i].isApprox(chain.origins[i], 1e-6)) vernier::fuzz::finding("another origin", chain.text);
  });
}
