// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A non-owning reference to a callable, so that options stay plain concrete types.

#include "vernier/core/language.hpp"

#include <type_traits>
#include <utility>

namespace vernier {

namespace detail {

/// Address of an object or a function, its type forgotten.
template <class F>
void* erase(F& f) {
  if constexpr (std::is_function_v<F>) {
    return reinterpret_cast<void*>(&f);
  } else {
    return const_cast<void*>(static_cast<const void*>(__builtin_addressof(f)));
  }
}

/// What `erase` was given.
template <class F>
F& restore(void* object) {
  if constexpr (std::is_function_v<F>) {
    return *reinterpret_cast<F*>(object);
  } else {
    return *static_cast<F*>(object);
  }
}

}  // namespace detail

template <class Signature>
class FunctionRef;

/// Two pointers to a callable that outlives it. Empty by default; calling an empty one is undefined.
template <class R, class... Args>
class FunctionRef<R(Args...)> {
 public:
  FunctionRef() = default;

  /// Refers to `f`, which must outlive this.
  template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>)
  FunctionRef(F&& f)  // NOLINT(google-explicit-constructor): a call argument converts silently
      : object_(detail::erase(f)), call_([](void* object, Args... args) -> R {
          return detail::restore<std::remove_reference_t<F>>(object)(std::forward<Args>(args)...);
        }) {}

  /// Calls what it refers to.
  R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }
  /// Whether it refers to anything.
  explicit operator bool() const { return call_ != nullptr; }

 private:
  void* object_ = nullptr;
  R (*call_)(void*, Args...) = nullptr;
};

}  // namespace vernier
