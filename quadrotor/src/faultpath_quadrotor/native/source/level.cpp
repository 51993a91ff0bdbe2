// What a library of kernels says of itself and of the processor.
#include <cstdint>

// Digest of the sources that it was built from.
extern "C" __attribute__((visibility("default"))) const char* faultpath_sources() {
  return FAULTPATH_SOURCES;
}

// Which instruction sets this processor has: 0 the baseline, 1 AVX2 with FMA, 2 AVX-512.
extern "C" __attribute__((visibility("default"))) int32_t faultpath_level() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f")) return 2;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return 1;
#endif
  return 0;
}
