// Noise of the candidates; see `planner/sampler.py`.
#include "philox.hpp"

namespace {

// Natural logarithm of x > 0; relative error about 1e-7 (Cephes).
INLINE Vector logarithm(Vector x) {
  const Integers bits = as_bits(x);
  Integers exponent = ((bits >> 23) & 0xff) - 126;
  Vector m = as_float((bits & 0x007fffff) | 0x3f000000);  // in [1/2, 1)
  const Integers low = m < 0.707106781186547524f;
  exponent += low;  // a true mask is -1
  m = select(low, m + m, m) - 1.0f;
  const Vector square = m * m;
  Vector p = splat(7.0376836292e-2f);
  p = fma(p, m, splat(-1.1514610310e-1f));
  p = fma(p, m, splat(1.1676998740e-1f));
  p = fma(p, m, splat(-1.2420140846e-1f));
  p = fma(p, m, splat(1.4249322787e-1f));
  p = fma(p, m, splat(-1.6668057665e-1f));
  p = fma(p, m, splat(2.0000714765e-1f));
  p = fma(p, m, splat(-2.4999993993e-1f));
  p = fma(p, m, splat(3.3333331174e-1f));
  const Vector e = __builtin_convertvector(exponent, Vector);
  Vector y = fma(p * m, square, e * -2.12194440e-4f);
  y = fma(square, splat(-0.5f), y);
  return fma(e, splat(0.693359375f), m + y);
}

INLINE Integers load_bits(const int32_t* from) {
  Integers value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

// Two normals from two words of 32 bits (Box and Muller 1958).
INLINE void normals(Integers first, Integers second, Vector& a, Vector& b) {
  constexpr float SCALE = 2.3283064365386963e-10f;  // 2^-32
  const Vector u = __builtin_convertvector(first, Vector) * SCALE;
  const Vector v = __builtin_convertvector(second, Vector) * SCALE;
  const Vector logged = logarithm((u + 0.5f) + 0.5f * SCALE) * -2.0f;
  const Vector radius = sqrt(at_least(logged, splat(0.0f)));
  Vector sine, cosine;
  sine_cosine(v * 6.283185307179586f, sine, cosine);
  a = cosine * radius;
  b = sine * radius;
}

// Bits of one scene become white noise `[rows][candidates]`, in place: a pair's two normals take the
// places of its two words.
void whiten(int32_t* bits, int64_t rows, int64_t candidates) {
  const int64_t half = rows / 2 * candidates;
  float* noise = reinterpret_cast<float*>(bits);
  for (int64_t i = 0; i < half; i += LANES) {
    Vector a, b;
    normals(load_bits(bits + i), load_bits(bits + half + i), a, b);
    store(noise + i, a);
    store(noise + half + i, b);
  }
}

}  // namespace

// `noise` [H, 4, S, K] of scenes with `keys` [S, 2] at a step: first-order autoregressive over the
// horizon, candidate 0 at zero. `bits` [H * 4 * K] is scratch: one scene's, so that all but the last
// pass stays in cache. K is a multiple of the widest vector.
extern "C" __attribute__((visibility("default"))) void faultpath_noise(
    const uint64_t* keys, int64_t step, int64_t horizon, int64_t scenes, int64_t candidates,
    const float* correlation, int32_t* bits, float* noise) {
  const Vector kept = splat(correlation[0]), fresh = splat(correlation[1]);
  const int64_t pitch = scenes * candidates, rows = 4 * horizon;
  for (int64_t s = 0; s < scenes; ++s) {
    float* own = noise + s * candidates;
    draw(keys + 2 * s, step, rows * candidates / 2, reinterpret_cast<uint64_t*>(bits));
    whiten(bits, rows, candidates);
    const float* white = reinterpret_cast<const float*>(bits);
    for (int64_t r = 0; r < rows; ++r, white += candidates) {
      float* row = own + r * pitch;
      for (int64_t k = 0; k < candidates; k += LANES) {
        const Vector drawn = load(white + k);
        store(row + k, r < 4 ? drawn : fma(load(row + k - 4 * pitch), kept, drawn * fresh));
      }
      row[0] = 0.0f;
    }
  }
}
