// What this machine can do at most, to hold the kernels' figures against: fused multiply-adds and separate multiplications and
// additions from registers, and the triad a = b + s c of McCalpin's STREAM on arrays in each level of the memory. Our kernels
// never fuse (results must not depend on the machine) and are AVX2 at most, so `multiplyAdd` without `fused` is their ceiling.

#include "core/vector.h"

#include <benchmark/benchmark.h>
#include <cstdint>

namespace springtower {
namespace {

constexpr int kChains = 12;  // enough independent ones to hide the latency of two units
constexpr int kRounds = 1000;

#if defined(__x86_64__) && !defined(__clang__)

using Pack = double __attribute__((vector_size(32)));

// Each chain is x = x * factor + term, over and over.
__attribute__((target("avx2,fma"), optimize("fp-contract=fast"))) double chains(double factor, double term) {
  Pack x[kChains];
  for (int i = 0; i < kChains; ++i) x[i] = Pack{1.0, 2.0, 3.0, 4.0} + static_cast<double>(i);
  for (int round = 0; round < kRounds; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) x[i] = x[i] * factor + term;
  }
  Pack sum = x[0];
  for (int i = 1; i < kChains; ++i) sum += x[i];
  return sum[0] + sum[1] + sum[2] + sum[3];
}

__attribute__((target("avx2"))) double separateChains(double factor, double term) {
  Pack x[kChains];
  for (int i = 0; i < kChains; ++i) x[i] = Pack{1.0, 2.0, 3.0, 4.0} + static_cast<double>(i);
  for (int round = 0; round < kRounds; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) x[i] = x[i] * factor + term;
  }
  Pack sum = x[0];
  for (int i = 1; i < kChains; ++i) sum += x[i];
  return sum[0] + sum[1] + sum[2] + sum[3];
}

void multiplyAdd(benchmark::State& run, double (*kernel)(double, double)) {
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) {
    run.SkipWithError("this processor has no AVX2 and FMA");
    return;
  }
  double factor = 0.999;
  for (auto iteration : run) {
    benchmark::DoNotOptimize(factor);
    benchmark::DoNotOptimize(kernel(factor, 1e-3));
  }
  run.counters["flops"] =
      benchmark::Counter(static_cast<double>(run.iterations()) * kRounds * kChains * 8.0, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(multiplyAdd, fused, chains);
BENCHMARK_CAPTURE(multiplyAdd, separate, separateChains);

#endif

// Bytes of all three arrays together.
void triad(benchmark::State& run) {
  const auto length = static_cast<std::size_t>(run.range(0)) / (3 * sizeof(double));
  AlignedVector<double> a(length, 0.0);
  const AlignedVector<double> b(length, 1.0);
  const AlignedVector<double> c(length, 2.0);
  double scale = 3.0;
  for (auto iteration : run) {
    benchmark::DoNotOptimize(scale);
    double* to = a.data();
    const double* first = b.data();
    const double* second = c.data();
    for (std::size_t i = 0; i < length; ++i) to[i] = first[i] + scale * second[i];
    benchmark::ClobberMemory();
  }
  run.SetBytesProcessed(run.iterations() * static_cast<std::int64_t>(3 * length * sizeof(double)));
}

BENCHMARK(triad)->Arg(24 << 10)->Arg(384 << 10)->Arg(8 << 20)->Arg(192 << 20);

}  // namespace
}  // namespace springtower
