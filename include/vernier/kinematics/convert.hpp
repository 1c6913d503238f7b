#pragma once

/// @file
/// From the modified convention to the standard one, exactly.

#include <array>

#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

/// The same arm in the standard convention. A modified row turns and shifts about x before it does about z, so each
/// standard row takes theta and d from its own row and a, alpha and beta from the next; what precedes the first joint
/// becomes the base frame, and the last row has a = alpha = beta = 0. Joint values mean the same.
/// @cite Craig 2005; Denavit and Hartenberg 1955
template <int N>
Framed<DhChain<N>> to_standard(const DhChain<N, ModifiedDh>& chain) {
  std::array<DhRow, N> rows{};
  for (int i = 0; i < N; ++i) {
    DhRow& row = rows[static_cast<std::size_t>(i)];
    row.d = chain.row(i).d;
    row.theta = chain.row(i).theta;
    row.joint = chain.row(i).joint;
    if (i + 1 == N) continue;
    const DhRow& next = chain.row(i + 1);
    row.a = next.a;
    row.alpha = next.alpha;
    row.beta = next.beta;
  }
  const DhRow& first = chain.row(0);
  detail::MovingFrame<double, 3> base;
  base.set_identity();
  base.rotate_x(std::cos(first.alpha), std::sin(first.alpha));
  base.move(base.x, first.a);
  if (first.beta != 0) base.rotate_y(std::cos(first.beta), std::sin(first.beta));
  return Framed<DhChain<N>>(DhChain<N>::from_rows(rows), base.isometry());
}

}  // namespace vernier
