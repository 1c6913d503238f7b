// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Conversion from the modified convention to the standard one, exact.

#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

namespace detail {

/// `vernier::to_standard` of rows whose number is known at run time.
VERNIER_API ArmGeometry to_standard(const ChainTable& modified);

}  // namespace detail

/// An arm of the modified convention in the standard one. A modified row rotates and translates about x before it does
/// about z, so each standard row takes theta and d from its own row and a, alpha and beta from the next; what precedes
/// the first joint becomes the base frame, and the last row has a = alpha = beta = 0. Joint values keep their meaning.
/// @cite Craig 2005; Denavit and Hartenberg 1955
template <int N>
Framed<DhChain<N>> to_standard(const DhChain<N, ModifiedDh>& chain) {
  return detail::to_standard(detail::ChainTable(chain.view())).framed(DhChain<N>::from_rows({}));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/convert.ipp"
#endif
