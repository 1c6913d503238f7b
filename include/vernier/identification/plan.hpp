#pragma once

/// @file
/// Which parameters of a chain in frames an identification may move, and how large their errors are expected to be.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vernier/identification/options.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier::detail {

/// The parameters of `Framed<DhChain>` by index: 6 of the base, 5 N of the chain, 6 of the tool.
template <int N, class Convention>
struct IdentificationPlan {
  using Arm = Framed<DhChain<N, Convention>>;
  static constexpr Index chain_begin = 6, chain_end = 6 + 5 * N;

  std::vector<std::string> names = Arm::parameter_names();
  std::vector<ParameterKind> kinds = Arm::parameter_kinds();
  VectorX sizes;              ///< expected size of the error of each parameter [m, rad]
  std::vector<Index> wanted;  ///< what may move, frames first, so that the ends of the chain give way to them
  std::vector<Index> frames;  ///< the frame parameters among them

  IdentificationPlan(const DhChain<N, Convention>& nominal, const IdentifyOptions& options)
      : sizes(static_cast<Index>(names.size())) {
    options.validate(names);
    std::vector<bool> free(names.size());
    for (Index k = 0; k < sizes.size(); ++k) {
      const bool length = kinds[static_cast<std::size_t>(k)] == ParameterKind::length;
      const auto parameter = static_cast<DhParameter>((k - chain_begin) % 5);
      if (in_chain(k)) {
        sizes(k) = length                            ? options.length_size
                   : parameter == DhParameter::theta ? options.joint_zero_size
                                                     : options.angle_size;
        free[static_cast<std::size_t>(k)] = options.geometry && parameter != DhParameter::beta;
      } else {
        sizes(k) = 10e-3;
        free[static_cast<std::size_t>(k)] = k < chain_begin ? options.base_free() : options.tool_free();
      }
    }
    if (options.hayati && options.geometry)
      for (const int row : parallel_rows(nominal)) {
        free[static_cast<std::size_t>(chain_begin + 5 * row + static_cast<int>(DhParameter::beta))] = true;
        free[static_cast<std::size_t>(chain_begin + 5 * row + static_cast<int>(DhParameter::d))] = false;
      }
    for (const auto& name : options.fixed)
      free[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())] = false;
    for (const auto& [begin, end] :
         {std::pair{Index{0}, chain_begin}, {chain_end, sizes.size()}, {chain_begin, chain_end}})
      for (Index k = begin; k < end; ++k) {
        if (!free[static_cast<std::size_t>(k)]) continue;
        wanted.push_back(k);
        if (!in_chain(k)) frames.push_back(k);
      }
  }

  static bool in_chain(Index k) { return k >= chain_begin && k < chain_end; }
};

}  // namespace vernier::detail
