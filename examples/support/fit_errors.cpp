#include "calibration_stages.hpp"
#include "dispatch.hpp"

namespace support {

template <int N>
vernier::FittedErrorModel<vernier::DhChain<N>> fit_errors(const vernier::Identified<vernier::DhChain<N>>& start,
                                                          std::span<const vernier::Dataset<N>> stations,
                                                          std::span<const vernier::Distances<N>> distances,
                                                          const vernier::ErrorModelOptions& options,
                                                          vernier::PriorSearch search) {
  return vernier::fit_error_model(start, stations, distances, options, search);
}

#define VERNIER_INSTANTIATE(N)                                                               \
  template vernier::FittedErrorModel<vernier::DhChain<N>> fit_errors<N>(                     \
      const vernier::Identified<vernier::DhChain<N>>&, std::span<const vernier::Dataset<N>>, \
      std::span<const vernier::Distances<N>>, const vernier::ErrorModelOptions&, vernier::PriorSearch);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
