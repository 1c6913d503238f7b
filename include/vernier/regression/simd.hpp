#pragma once

/// @file
/// Vectors of W doubles by the compilers' vector extensions, and a choice of W at run time. Functions that use them are
/// always inlined into an entry point with a target attribute, and take vectors by reference only, so that code
/// compiled plainly runs wide instructions and never mixes ABIs with other libraries.

#include <cstdint>
#include <cstring>

/// Inlined even where the compiler would rather not.
#define VERNIER_INLINE inline __attribute__((always_inline))
/// Before a loop of a constant few steps: unrolls it whole, so that what it indexes stays in registers.
#define VERNIER_UNROLL _Pragma("GCC unroll 16")

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

template <int W>
VERNIER_INLINE void load(typename Simd<W>::Double& v, const double* from) {
  std::memcpy(&v, from, sizeof v);
}

template <int W>
VERNIER_INLINE void store(double* to, const typename Simd<W>::Double& v) {
  std::memcpy(to, &v, sizeof v);
}

/// z becomes 1 / (1 + exp(-z)), to about 1e-15 relative: exp(-z) = 2^k exp(r), |r| <= ln(2) / 2, Taylor to r^13.
template <int W>
VERNIER_INLINE void sigmoid(typename Simd<W>::Double& z) {
  using Double = typename Simd<W>::Double;
  using Integer = typename Simd<W>::Integer;
  constexpr double magic = 0x1.8p52;  // adding it rounds to an integer, readable in the low bits
  constexpr double factors[14] = {
      1.0,        1.0,         1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,        1.0 / 720,
      1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600., 1.0 / 6227020800.};
  Double x = -z;
  x = x > 708.0 ? Double{} + 708.0 : x;  // beyond: exp overflows, the sigmoid is 0 or 1 to the last bit
  x = x < -708.0 ? Double{} - 708.0 : x;
  const Double shifted = x * 1.44269504088896338700 + magic;
  const Double k = shifted - magic;
  const Double r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  Double p = Double{} + factors[13];
  VERNIER_UNROLL
  for (int n = 12; n >= 0; --n) p = p * r + factors[n];
  Integer bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;  // the magic's own bits are shifted out
  Double power;
  std::memcpy(&power, &bits, sizeof power);
  z = 1.0 / (1.0 + p * power);
}

}  // namespace detail
}  // namespace vernier
