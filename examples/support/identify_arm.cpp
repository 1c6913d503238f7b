#include "calibration_stages.hpp"
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
VERNIER_INSTANTIATE(3)
VERNIER_INSTANTIATE(4)
VERNIER_INSTANTIATE(5)
VERNIER_INSTANTIATE(6)
VERNIER_INSTANTIATE(7)
VERNIER_INSTANTIATE(8)
VERNIER_INSTANTIATE(9)
#undef VERNIER_INSTANTIATE

}  // namespace support
