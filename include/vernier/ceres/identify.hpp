#pragma once

/// @file
/// Identification of an arm's geometry and frames by nonlinear least squares in Ceres.

#include "vernier/ceres/identification.hpp"

namespace vernier {

/// Identify the geometry of an arm and its base and tool frames from measured poses (Levenberg-Marquardt).
///
/// Parameters that cannot be told apart from others by these measurements keep their values and are named; those that
/// are hardly determined get a prior of physical size, so that nothing runs off; a problem with too little data says
/// so.
/// @param nominal the arm as designed
/// @param data    n >= 1 samples; joints in rad (or m), positions in m. Orientations count where there are any. Not
/// kept.
/// @param options which parameters may move, sigmas, loss, priors
/// @return        model, status, rms before and after [m], rank, condition, covariance (empty when rank-deficient)
/// @throws std::invalid_argument on no data or an unusable option, never for poor data
/// @complexity    O(n * free^2) per iteration; allocates
/// @cite Hayati and Mirmirani 1985; Everett, Driels and Mooring 1987; Schroer 1997
template <int N, class Convention>
Identified<DhChain<N, Convention>> identify(const DhChain<N, Convention>& nominal, const Dataset<N>& data,
                                            const IdentifyOptions& options = {}) {
  require(data.size() >= 1, "identify: no samples");
  return detail::Identification<N, Convention, Dataset<N>>(nominal, data, options).run();
}

/// The same from distances to one fixed point. The base frame then has its origin at that point; its orientation, which
/// distances do not tell, is that of the start. `position_sigma` is that of a distance, errors are those of distances.
/// @param nominal the arm as designed
/// @param data    n >= 1 samples, the tool point roughly known: see `tool_start`
/// @param options as above
template <int N, class Convention>
Identified<DhChain<N, Convention>> identify(const DhChain<N, Convention>& nominal, const Distances<N>& data,
                                            const IdentifyOptions& options = {}) {
  require(data.size() >= 1, "identify: no samples");
  return detail::Identification<N, Convention, Distances<N>>(nominal, data, options).run();
}

}  // namespace vernier
