#include "calibration_stages.hpp"

namespace support {

template <int N>
vernier::FittedErrorModel<vernier::DhChain<N>> fit_errors(const vernier::Identified<vernier::DhChain<N>>& start,
                                                          std::span<const vernier::Dataset<N>> stations,
                                                          const vernier::ErrorModelOptions& options) {
  return vernier::fit_error_model(start, stations, options);
}

#define VERNIER_INSTANTIATE(N)                                                               \
  template vernier::FittedErrorModel<vernier::DhChain<N>> fit_errors<N>(                     \
      const vernier::Identified<vernier::DhChain<N>>&, std::span<const vernier::Dataset<N>>, \
      const vernier::ErrorModelOptions&);
VERNIER_INSTANTIATE(3)
VERNIER_INSTANTIATE(4)
VERNIER_INSTANTIATE(5)
VERNIER_INSTANTIATE(6)
VERNIER_INSTANTIATE(7)
VERNIER_INSTANTIATE(8)
VERNIER_INSTANTIATE(9)
#undef VERNIER_INSTANTIATE

}  // namespace support
