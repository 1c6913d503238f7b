#pragma once

/// @file
/// Where definitions live that depend on no robot: in `.ipp` files, which the headers include by default, and which the
/// library `vernier::compiled` has compiled once.
///
/// `VERNIER_API` stands before the declaration of such a function, `VERNIER_IMPL` before its definition:
///
///     VERNIER_API Isometry3 register_points(const PointRows& from, const PointRows& to);  // in frames.hpp
///     VERNIER_IMPL Isometry3 register_points(const PointRows& from, const PointRows& to) { ... }  // in frames.ipp
///
/// Header-only, both make it a function template with a default argument: callers notice nothing, and a compiler pays for
/// a definition only where it is called. With `VERNIER_COMPILED`, which `vernier::compiled` sets, it is a function of the
/// library whose linker symbol carries the alignment of Eigen's types. So a translation unit compiled with another
/// alignment (`-march=native`) does not link: `undefined reference to ...[abi:eigen_align_32_32]`. The symbols of the two
/// modes differ, so translation units of both may be linked into one program.

#include <Eigen/Core>

#if defined(VERNIER_COMPILED)
#define VERNIER_HEADER_ONLY 0
#define VERNIER_DETAIL_TEXT(dynamic, fixed) "eigen_align_" #dynamic "_" #fixed
#define VERNIER_DETAIL_ALIGNMENT(dynamic, fixed) VERNIER_DETAIL_TEXT(dynamic, fixed)
#define VERNIER_API \
  [[gnu::abi_tag(VERNIER_DETAIL_ALIGNMENT(EIGEN_MAX_ALIGN_BYTES, EIGEN_MAX_STATIC_ALIGN_BYTES))]]
#define VERNIER_IMPL
#else
#define VERNIER_HEADER_ONLY 1
#define VERNIER_API template <class VernierHeaderOnly = void>
#define VERNIER_IMPL template <class VernierHeaderOnly>
#endif
