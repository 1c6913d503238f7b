#include "calibration_stages.hpp"
#include "dispatch.hpp"
#include "vernier/ceres/identify.hpp"

namespace support {

template <int N>
vernier::Identified<vernier::DhChain<N>> identify_arm(const vernier::DhChain<N>& nominal,
                                                      const vernier::Dataset<N>& data,
                                                      const vernier::IdentifyOptions& options) {
  return vernier::identify(nominal, data, options);
}

#define VERNIER_INSTANTIATE(N)                                       \
  template vernier::Identified<vernier::DhChain<N>> identify_arm<N>( \
      const vernier::DhChain<N>&, const vernier::Dataset<N>&, const vernier::IdentifyOptions&);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
