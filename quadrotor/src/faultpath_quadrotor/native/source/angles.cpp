// Sine and cosine of many angles; see `angles.py`.
#include "simd64.hpp"

extern "C" {

__attribute__((visibility("default"))) void faultpath_sine_cosine_single(
    const float* angles, int64_t count, float* sines, float* cosines) {
  for (int64_t n = 0; n < count; n += LANES) {
    Vector sine, cosine;
    sine_cosine(take(angles + n, count - n), sine, cosine);
    give(sine, count - n, sines + n);
    give(cosine, count - n, cosines + n);
  }
}

__attribute__((visibility("default"))) void faultpath_sine_cosine(
    const double* angles, int64_t count, double* sines, double* cosines) {
  for (int64_t n = 0; n < count; n += DOUBLES) {
    Doubles sine, cosine;
    sine_cosine(take(angles + n, count - n), sine, cosine);
    give(sine, count - n, sines + n);
    give(cosine, count - n, cosines + n);
  }
}

}  // extern "C"
