// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What every `fit` takes besides the data: a seed, who computes, who watches.

#include <cstdint>
#include <type_traits>

#include "vernier/core/executor.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// How far a long computation has come.
struct Progress {
  Index generation = 0;   ///< generations (iterations) done
  Index evaluations = 0;  ///< objective evaluations done
  double best = 0;        ///< best objective value so far
};

/// Refers to a callable `void(const Progress&)` or `bool(const Progress&)` that outlives it; `false` requests a stop.
class ObserverRef {
 public:
  ObserverRef() = default;

  /// Refers to `f`, which must outlive this.
  template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, ObserverRef> && std::is_invocable_v<F&, const Progress&>)
  ObserverRef(F&& f)  // NOLINT(google-explicit-constructor)
      : object_(detail::erase(f)), call_([](void* object, const Progress& progress) -> bool {
          auto& callable = detail::restore<std::remove_reference_t<F>>(object);
          if constexpr (std::is_same_v<std::invoke_result_t<F&, const Progress&>, bool>) {
            return callable(progress);
          } else {
            callable(progress);
            return true;
          }
        }) {}

  /// Reports; false when the observer requests a stop.
  bool operator()(const Progress& progress) const { return call_ == nullptr || call_(object_, progress); }

 private:
  void* object_ = nullptr;
  bool (*call_)(void*, const Progress&) = nullptr;
};

/// Options of every `fit`.
struct FitOptions {
  std::uint64_t seed = 0;  ///< same seed, same bits, whatever the executor
  ExecutorRef executor{};  ///< who evaluates; must outlive the call
  ObserverRef observer{};  ///< who watches; must outlive the call
  /// Weights of the samples, positive, one a row: a sample of weight 2 counts as two. Null: all count the same. Must
  /// outlive the call.
  const VectorX* weights = nullptr;
};

}  // namespace vernier
