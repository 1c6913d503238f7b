// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where definitions live that depend on no robot: in `.ipp` files, which the headers include by default, and which the
/// library `vernier::compiled` has compiled once.
///
/// `VERNIER_API` stands before the declaration of such a function, `VERNIER_IMPL` before its definition:
///
///     VERNIER_API Isometry3 register_points(const PointRows& from, const PointRows& to);  // in .hpp
///     VERNIER_IMPL Isometry3 register_points(const PointRows& from, const PointRows& to) { ... }  // in .ipp
/// `VERNIER_LOCAL` stands before a function that one `.ipp` file defines for itself, and nobody else calls.
/// `VERNIER_TEMPLATE_API` stands before a function template of which the library has instances.
/// `VERNIER_LATER(x)` is the value x, and `VERNIER_LATER_TYPE(T)` the type T, as the compiler learns them where the
/// function is called. What is computed with them is then not instantiated where the definition is only read, which
/// takes most of a header's time.
///
/// Header-only, the first two make a function template with a default argument: callers notice nothing, and a compiler
/// pays for a definition only where it is called. With `VERNIER_COMPILED`, which `vernier::compiled` sets, it is a
/// function of the library whose linker symbol carries the alignment of Eigen's types. So a translation unit compiled
/// with another alignment (`-march=native`) does not link: `undefined reference to ...[abi:eigen_align_32_32]`. The
/// symbols of the two modes differ, so translation units of both may be linked into one program.

#include "vernier/core/language.hpp"

#include <Eigen/Core>

/// @cond

static_assert(!Eigen::MatrixXd::IsRowMajor,
              "Vernier stores matrices by columns: compile without EIGEN_DEFAULT_TO_ROW_MAJOR");
static_assert(sizeof(Eigen::Index) >= 8,
              "Vernier counts in 64 bits: compile for a machine of 64 bits, without EIGEN_DEFAULT_DENSE_INDEX_TYPE");

#if defined(VERNIER_COMPILED)
#define VERNIER_HEADER_ONLY 0
#define VERNIER_DETAIL_TEXT(dynamic, fixed) "eigen_align_" #dynamic "_" #fixed
#define VERNIER_DETAIL_ALIGNMENT(dynamic, fixed) VERNIER_DETAIL_TEXT(dynamic, fixed)
#define VERNIER_API [[gnu::abi_tag(VERNIER_DETAIL_ALIGNMENT(EIGEN_MAX_ALIGN_BYTES, EIGEN_MAX_STATIC_ALIGN_BYTES))]]
#define VERNIER_IMPL
#define VERNIER_TEMPLATE_API VERNIER_API
#define VERNIER_LATER(value) (value)
#define VERNIER_LATER_TYPE(...) __VA_ARGS__
#else
#define VERNIER_HEADER_ONLY 1
#define VERNIER_API template <class VernierHeaderOnly = void>
#define VERNIER_IMPL template <class VernierHeaderOnly>
#define VERNIER_TEMPLATE_API
#define VERNIER_LATER(value) ::vernier::detail::later<VernierHeaderOnly>(value)
#define VERNIER_LATER_TYPE(...) typename ::vernier::detail::Later<VernierHeaderOnly, __VA_ARGS__>::Type
#endif
#define VERNIER_LOCAL VERNIER_API

namespace vernier::detail {

// The type itself, and the value itself, of a type that depends on the first argument.
template <class, class T>
struct Later {
  using Type = T;
};
template <class, class T>
constexpr T&& later(T&& value) noexcept {
  return static_cast<T&&>(value);
}

}  // namespace vernier::detail

/// @endcond

/// Calls `macro(argument, N)` for the numbers of joints of which the library has instances: 1 to `max_arm_joints`.
#define VERNIER_FOR_JOINTS(macro, argument)                                                                         \
  macro(argument, 1) macro(argument, 2) macro(argument, 3) macro(argument, 4) macro(argument, 5) macro(argument, 6) \
      macro(argument, 7) macro(argument, 8) macro(argument, 9)
