#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace springtower {

/// While it lives, numbers of this thread that are too small for a normal representation (below 1.2e-38 in float) count as zero:
/// flush to zero and denormals are zero of the MXCSR register. Processors take some hundred cycles for each where they are not.
/// Tasks of other threads need their own. The same results on every x86-64; elsewhere it does nothing.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero);
  }
  ~FlushDenormals() {
    _mm_setcsr(before_);
  }
#else
  FlushDenormals() = default;
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned kFlushToZero = 0x8000;
  static constexpr unsigned kDenormalsAreZero = 0x0040;
  unsigned before_;
#endif
};

}  // namespace springtower
