#pragma once

// Four doubles that move together, by the compiler's vector extension: it becomes two SSE2 or one AVX2 register, with the same
// rounding either way, so results do not depend on the machine.

namespace springtower {

using Lanes = double __attribute__((vector_size(32)));
using LaneMask = long long __attribute__((vector_size(32)));

/// Kernels carry this: built once for any x86-64 and once for AVX2, chosen when the program starts. Sanitizers run before that
/// choice can be made, so their builds have one version; so has clang's, which reads the code for clang-tidy.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__x86_64__) || defined(__clang__)
#define SPRINGTOWER_KERNEL
#else
#define SPRINGTOWER_KERNEL __attribute__((target_clones("avx2", "default"), flatten))
#endif
#define SPRINGTOWER_INLINE inline __attribute__((always_inline))

SPRINGTOWER_INLINE void load(const double* from, Lanes& to) {
  __builtin_memcpy(&to, from, sizeof to);
}
SPRINGTOWER_INLINE void store(const Lanes& from, double* to) {
  __builtin_memcpy(to, &from, sizeof from);
}
SPRINGTOWER_INLINE void squareRoot(const Lanes& from, Lanes& to) {
  for (int i = 0; i < 4; ++i) to[i] = __builtin_sqrt(from[i]);
}
/// Picks four lanes out of two packs: 0..3 from `first`, 4..7 from `second`.
template <int A, int B, int C, int D>
SPRINGTOWER_INLINE void shuffle(const Lanes& first, const Lanes& second, Lanes& to) {
  to = __builtin_shufflevector(first, second, A, B, C, D);
}
/// Sum of the four lanes, in a fixed order.
SPRINGTOWER_INLINE double sum(const Lanes& lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

}  // namespace springtower
