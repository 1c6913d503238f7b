// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Vectors of W doubles by the compilers' vector extensions, and a choice of W at run time. Functions that use them are
/// always inlined into an entry point with a target attribute, and take vectors by reference only, so that code
/// compiled plainly runs wide instructions and never mixes ABIs with other libraries.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "vernier/core/language.hpp"

/// Inlined even where the compiler would rather not.
#define VERNIER_INLINE inline __attribute__((always_inline))
/// Inlines a lambda, behind its parameters, even where the compiler would rather not.
#define VERNIER_INLINED __attribute__((always_inline))
/// Before a loop of a constant few steps: unrolls it whole, so that what it indexes stays in registers.
#define VERNIER_UNROLL _Pragma("GCC unroll 16")

/// A sum from which nothing is cancelled, so that -fassociative-math does not undo the rounding it is there for.
#if defined(__has_builtin)
#if __has_builtin(__builtin_assoc_barrier)
#define VERNIER_AS_WRITTEN(sum) __builtin_assoc_barrier(sum)
#elif __has_builtin(__arithmetic_fence) && defined(__x86_64__)
#define VERNIER_AS_WRITTEN(sum) __arithmetic_fence(sum)
#endif
#endif
#if !defined(VERNIER_AS_WRITTEN)
#define VERNIER_AS_WRITTEN(sum) (sum)
#endif

namespace vernier {

/// Instruction sets that the kernels are built for.
enum class InstructionSet {
  baseline,  ///< what the compiler assumes anyway: SSE2 on x86-64
  avx2,      ///< AVX2 with FMA
  avx512     ///< AVX-512 F and DQ
};

/// The widest instruction set of this machine.
inline InstructionSet widest_instruction_set() {
#if defined(__x86_64__)
  static const InstructionSet widest = [] {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return InstructionSet::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::avx2;
    return InstructionSet::baseline;
  }();
  return widest;
#else
  return InstructionSet::baseline;
#endif
}

namespace detail {

/// W doubles, and W integers of the same width.
template <int W>
struct Simd {
  using Double __attribute__((vector_size(W * 8))) = double;
  using Integer __attribute__((vector_size(W * 8))) = std::int64_t;
};

// Not inlined: a call costs nothing beside a kernel, and every user's compile time would grow.
template <class Kernel>
[[gnu::noinline]] void run_baseline(const Kernel& kernel) noexcept {
  kernel.template operator()<2>();
}
#if defined(__x86_64__)
template <class Kernel>
[[gnu::noinline, gnu::target("avx2")]] void run_avx2(const Kernel& kernel) noexcept {
  kernel.template operator()<4>();
}
#endif

/// Calls `kernel.template operator()<W>()`, an always inlined lambda, with the widest vectors that give the same bits
/// as any other: AVX2 without FMA, else the baseline's.
template <class Kernel>
void run_same_bits(const Kernel& kernel, InstructionSet set = widest_instruction_set()) noexcept {
#if defined(__x86_64__)
  if (set != InstructionSet::baseline) return run_avx2(kernel);
#else
  static_cast<void>(set);
#endif
  run_baseline(kernel);
}

#if defined(__x86_64__)
template <class Kernel>
[[gnu::noinline, gnu::target("avx2,fma")]] void run_avx2_fma(const Kernel& kernel) noexcept {
  kernel.template operator()<4>();
}
template <class Kernel>
[[gnu::noinline, gnu::target("avx512f,avx512dq,fma")]] void run_avx512(const Kernel& kernel) noexcept {
  kernel.template operator()<8>();
}
#endif

/// Runs a kernel with all that an instruction set has: results of another set differ in their last bits.
template <class Kernel>
void run_widest(const Kernel& kernel, InstructionSet set = widest_instruction_set()) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return run_avx512(kernel);
  if (set == InstructionSet::avx2) return run_avx2_fma(kernel);
#else
  static_cast<void>(set);
#endif
  run_baseline(kernel);
}

template <int W>
VERNIER_INLINE void load(typename Simd<W>::Double& v, const double* from) {
  typename Simd<W>::Double loaded;  // in a register: copied to memory in halves, it could not be forwarded whole
  std::memcpy(&loaded, from, sizeof loaded);
  v = loaded;
}

template <int W>
VERNIER_INLINE void store(double* to, const typename Simd<W>::Double& v) {
  std::memcpy(to, &v, sizeof v);
}

/// x becomes exp(x), to 4e-16 relative; beyond +-708 that of +-708. exp(x) = 2^k exp(r), |r| <= ln(2) / 2, Taylor to
/// r^13.
template <int W>
VERNIER_INLINE void exponential(typename Simd<W>::Double& x) {
  using Double = typename Simd<W>::Double;
  using Integer = typename Simd<W>::Integer;
  constexpr double magic = 0x1.8p52;  // adding it rounds to an integer, readable in the low bits
  constexpr double factors[14] = {
      1.0,        1.0,         1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,        1.0 / 720,
      1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600., 1.0 / 6227020800.};
  x = x > 708.0 ? Double{} + 708.0 : x;
  x = x < -708.0 ? Double{} - 708.0 : x;
  const Double shifted = VERNIER_AS_WRITTEN(x * 1.44269504088896338700 + magic);
  const Double k = VERNIER_AS_WRITTEN(shifted - magic);
  const Double r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  Double p = Double{} + factors[13];
  VERNIER_UNROLL
  for (int n = 12; n >= 0; --n) p = p * r + factors[n];
  Integer bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;  // the magic's own bits are shifted out
  Double power;
  std::memcpy(&power, &bits, sizeof power);
  x = p * power;
}

/// z becomes 1 / (1 + exp(-z)), to about 1e-15 relative; beyond +-708 it is 0 or 1 to the last bit.
template <int W>
VERNIER_INLINE void sigmoid(typename Simd<W>::Double& z) {
  typename Simd<W>::Double x = -z;
  exponential<W>(x);
  z = 1.0 / (1.0 + x);
}

/// Sines and cosines of `Count` vectors of angles [rad], to 3e-16 absolute; beyond 1e5 rad by the standard library.
/// The angle less the nearest multiple of pi/2, which is subtracted in three parts of 33 bits, so that their products
/// with a quadrant's number below 2^19 are exact; then minimax polynomials on [-pi/4, pi/4]. NaN where an angle is not
/// finite.
/// @cite Cody and Waite 1980
template <int W, int Count>
VERNIER_INLINE void sincos(const typename Simd<W>::Double (&angle)[Count], typename Simd<W>::Double (&sine)[Count],
                           typename Simd<W>::Double (&cosine)[Count]) {
  using Double = typename Simd<W>::Double;
  using Integer = typename Simd<W>::Integer;
  constexpr double magic = 0x1.8p52;  // adding it rounds to an integer, readable in the low bits
  constexpr double largest = 1e5;
  constexpr double s[6] = {-0.1666666666666663,   0.008333333333322113,    -0.0001984126982958472,
                           2.755731361966743e-06, -2.5050747486400758e-08, 1.589621370450665e-10};
  constexpr double c[6] = {0.0416666666666666,     -0.0013888888888874131, 2.480158728948695e-05,
                           -2.755731435377138e-07, 2.087572347658454e-09,  -1.1359658714965609e-11};
  Integer beyond{};
  VERNIER_UNROLL
  for (int i = 0; i < Count; ++i) {
    const Double x = angle[i];
    beyond |= (x > largest) | (x < -largest);
    const Double shifted = VERNIER_AS_WRITTEN(x * 6.36619772367581382433e-01 + magic);
    const Double k = VERNIER_AS_WRITTEN(shifted - magic);
    const Double r =
        ((x - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
    const Double t = r * r, t2 = t * t;  // in pairs of terms, so that less waits for less
    Double p = (s[0] + t * s[1]) + t2 * ((s[2] + t * s[3]) + t2 * (s[4] + t * s[5]));
    Double q = (c[0] + t * c[1]) + t2 * ((c[2] + t * c[3]) + t2 * (c[4] + t * c[5]));
    p = r + r * t * p;
    q = (1.0 - 0.5 * t) + t2 * q;
    Integer quadrant, a, b;
    std::memcpy(&quadrant, &shifted, sizeof quadrant);
    std::memcpy(&a, &p, sizeof a);
    std::memcpy(&b, &q, sizeof b);
    const Integer exchanged = (a ^ b) & -(quadrant & 1);  // odd quadrants: sine and cosine change places
    a ^= exchanged ^ ((quadrant & 2) << 62);
    b ^= exchanged ^ (((quadrant + 1) & 2) << 62);
    std::memcpy(&sine[i], &a, sizeof a);
    std::memcpy(&cosine[i], &b, sizeof b);
  }
  bool any = false;
  VERNIER_UNROLL
  for (int lane = 0; lane < W; ++lane) any |= beyond[lane] != 0;
  if (__builtin_expect(any, 0)) {
    for (int i = 0; i < Count; ++i) {
      for (int lane = 0; lane < W; ++lane) {
        const double x = angle[i][lane];
        if (std::abs(x) <= largest) continue;
        sine[i][lane] = std::sin(x);
        cosine[i][lane] = std::cos(x);
      }
    }
  }
}

/// Sines and cosines of N angles [rad], as `sincos`; the same bits on every machine.
template <int N>
void sines_and_cosines(const double* angles, double* sines, double* cosines) noexcept {
  constexpr int padded = (N + 3) / 4 * 4;
  double x[padded] = {}, s[padded], c[padded];
  std::copy(angles, angles + N, x);
  run_same_bits([&]<int W>() VERNIER_INLINED {
    typename Simd<W>::Double angle[padded / W], sine[padded / W], cosine[padded / W];
    VERNIER_UNROLL
    for (int k = 0; k < padded / W; ++k) load<W>(angle[k], x + k * W);
    sincos<W>(angle, sine, cosine);
    VERNIER_UNROLL
    for (int k = 0; k < padded / W; ++k) {
      store<W>(s + k * W, sine[k]);
      store<W>(c + k * W, cosine[k]);
    }
  });
  std::copy(s, s + N, sines);
  std::copy(c, c + N, cosines);
}

}  // namespace detail
}  // namespace vernier
