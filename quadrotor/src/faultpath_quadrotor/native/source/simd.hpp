// One vector type over candidates, and the few functions of it that the kernels need.
//
// The width follows from the instruction set that a file is compiled for. Every operation is either
// correctly rounded or written out here in the same order for all widths, and contraction is off, so
// that sets with a fused multiply-add give the same bits. The baseline of x86 has none: its results
// differ from theirs by rounding.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#define INLINE inline __attribute__((always_inline))

namespace {

// How an instruction of the set is called: x86 has one name a width, in single and in double precision.
#if defined(__AVX512F__)
constexpr int LANES = 16;
#define SINGLE(name) _mm512_##name##_ps
#define DOUBLE(name) _mm512_##name##_pd
#elif defined(__AVX2__) && defined(__FMA__)
constexpr int LANES = 8;
#define SINGLE(name) _mm256_##name##_ps
#define DOUBLE(name) _mm256_##name##_pd
#else
constexpr int LANES = 4;
#define SINGLE(name) _mm_##name##_ps
#define DOUBLE(name) _mm_##name##_pd
#endif

typedef float Vector __attribute__((vector_size(4 * LANES)));
typedef int32_t Integers __attribute__((vector_size(4 * LANES)));

INLINE Vector splat(float value) {
#if defined(__x86_64__)
  return SINGLE(set1)(value);
#else
  return Vector{value, value, value, value};
#endif
}

INLINE Vector load(const float* from) {
  Vector value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

INLINE void store(float* to, Vector value) { std::memcpy(to, &value, sizeof value); }

// The first `count` lanes from memory; the others are zero.
INLINE Vector take(const float* from, int64_t count) {
  if (count >= LANES) return load(from);
  Vector value = {};
  std::memcpy(&value, from, count * sizeof(float));
  return value;
}

INLINE void give(Vector value, int64_t count, float* to) {
  if (count >= LANES)
    store(to, value);
  else
    std::memcpy(to, &value, count * sizeof(float));
}

INLINE Vector fma(Vector a, Vector b, Vector c) {
#if defined(__AVX512F__) || (defined(__AVX2__) && defined(__FMA__))
  return SINGLE(fmadd)(a, b, c);
#elif defined(__aarch64__)
  return vfmaq_f32(c, a, b);
#else
  return a * b + c;
#endif
}

INLINE Vector sqrt(Vector x) {
#if defined(__x86_64__)
  return SINGLE(sqrt)(x);
#elif defined(__aarch64__)
  return vsqrtq_f32(x);
#else
  for (int i = 0; i < LANES; ++i) x[i] = __builtin_sqrtf(x[i]);
  return x;
#endif
}

INLINE Vector select(Integers mask, Vector yes, Vector no) { return mask ? yes : no; }

// What is not a number stays that, as in torch: of two operands the processor returns the second.
INLINE Vector at_most(Vector x, Vector bound) {
#if defined(__x86_64__)
  return SINGLE(min)(bound, x);
#else
  return bound < x ? bound : x;
#endif
}

INLINE Vector at_least(Vector x, Vector bound) {
#if defined(__x86_64__)
  return SINGLE(max)(bound, x);
#else
  return bound > x ? bound : x;
#endif
}

INLINE Vector bounded(Vector x, Vector low, Vector high) { return at_most(at_least(x, low), high); }

INLINE Vector as_float(Integers bits) {
  Vector value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

INLINE Integers as_bits(Vector value) {
  Integers bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

INLINE Vector absolute(Vector x) { return as_float(as_bits(x) & 0x7fffffff); }

constexpr float ROUNDER = 12582912.0f;  // 1.5 * 2^23: adding it rounds to a whole number

constexpr float LOG2_E = 1.44269504088896341f;

// x as a whole number and the rest, in [-1/2, 1/2].
INLINE void divide(Vector x, Vector& whole, Vector& rest) {
#if defined(__AVX512F__)
  whole = _mm512_roundscale_ps(x, 0);
#else
  whole = (x + ROUNDER) - ROUNDER;
#endif
  rest = x - whole;
}

// x * 2^whole, for a normal result.
INLINE Vector scaled(Vector x, Vector whole) {
#if defined(__AVX512F__)
  return _mm512_scalef_ps(x, whole);
#else
  return as_float(as_bits(x) + (__builtin_convertvector(whole, Integers) << 23));
#endif
}

// 2^x, for x up to 126 in size; relative error about 2e-7 (minimax). Beyond, it stays, for all widths
// alike: AVX-512 could go on to zero and infinity.
INLINE Vector power_of_two(Vector x) {
  x = bounded(x, splat(-126.0f), splat(126.0f));
  Vector whole, f;
  divide(x, whole, f);
  Vector p = splat(1.327647129073739e-3f);
  p = fma(p, f, splat(9.675541892647743e-3f));
  p = fma(p, f, splat(5.550713092088699e-2f));
  p = fma(p, f, splat(2.4022120237350464e-1f));
  p = fma(p, f, splat(6.931469440460205e-1f));
  p = fma(p, f, splat(1.0000001192092896f));
  return scaled(p, whole);
}

// The logistic function of -x ln 2: who can scale its argument beforehand saves a product.
INLINE Vector logistic(Vector x) { return 1.0f / (1.0f + power_of_two(x)); }

INLINE Vector sigmoid(Vector x) { return logistic(x * -LOG2_E); }

INLINE Vector hyperbolic_tangent(Vector x) {
  return fma(splat(2.0f), logistic(x * (-2.0f * LOG2_E)), splat(-1.0f));
}

INLINE Vector rectified(Vector x) { return at_least(x, splat(0.0f)); }

// Sine and cosine together, for |x| up to some thousands; absolute error about 1e-7 (Cephes).
INLINE void sine_cosine(Vector x, Vector& sine, Vector& cosine) {
  const Vector shifted = fma(x, splat(0.63661977236758134f), splat(ROUNDER));
  const Integers quadrant = as_bits(shifted);
  const Vector whole = shifted - ROUNDER;
  Vector r = fma(whole, splat(-1.5703125f), x);
  r = fma(whole, splat(-4.837512969970703125e-4f), r);
  r = fma(whole, splat(-7.549789948768648e-8f), r);
  const Vector square = r * r;
  Vector s = fma(square, splat(-1.9515295891e-4f), splat(8.3321608736e-3f));
  s = fma(s, square, splat(-1.6666654611e-1f));
  s = fma(s * square, r, r);
  Vector c = fma(square, splat(2.443315711809948e-5f), splat(-1.388731625493765e-3f));
  c = fma(c, square, splat(4.166664568298827e-2f));
  c = fma(c * square, square, fma(square, splat(-0.5f), splat(1.0f)));
  const Integers odd = (quadrant & 1) == 1;
  sine = select(odd, c, s);
  cosine = select(odd, s, c);
  sine = as_float(as_bits(sine) ^ ((quadrant & 2) << 30));
  cosine = as_float(as_bits(cosine) ^ (((quadrant + 1) & 2) << 30));
}

}  // namespace
