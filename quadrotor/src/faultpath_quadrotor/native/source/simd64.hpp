// The vector type of `simd.hpp` in double precision, half as many lanes wide.
//
// The same rules: operations are correctly rounded or written out, in one order for all widths.
#pragma once

#include "simd.hpp"

namespace {

constexpr int DOUBLES = LANES / 2;

typedef double Doubles __attribute__((vector_size(8 * DOUBLES)));
typedef int64_t Longs __attribute__((vector_size(8 * DOUBLES)));

INLINE Doubles splat(double value) {
#if defined(__x86_64__)
  return DOUBLE(set1)(value);
#else
  return Doubles{value, value};
#endif
}

INLINE Doubles fma(Doubles a, Doubles b, Doubles c) {
#if defined(__AVX512F__) || (defined(__AVX2__) && defined(__FMA__))
  return DOUBLE(fmadd)(a, b, c);
#elif defined(__aarch64__)
  return vfmaq_f64(c, a, b);
#else
  return a * b + c;
#endif
}

INLINE Doubles sqrt(Doubles x) {
#if defined(__x86_64__)
  return DOUBLE(sqrt)(x);
#elif defined(__aarch64__)
  return vsqrtq_f64(x);
#else
  for (int i = 0; i < DOUBLES; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

INLINE Doubles select(Longs mask, Doubles yes, Doubles no) { return mask ? yes : no; }

// A first number that is not a number stays that.
INLINE Doubles least(Doubles x, Doubles bound) { return select(x > bound, bound, x); }
INLINE Doubles greatest(Doubles x, Doubles bound) { return select(x < bound, bound, x); }

INLINE Doubles from_bits(Longs bits) {
  Doubles value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

INLINE Longs to_bits(Doubles value) {
  Longs bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

INLINE Doubles absolute(Doubles x) { return from_bits(to_bits(x) & INT64_MAX); }

// The first `count` lanes from memory; the others are zero.
INLINE Doubles take(const double* from, int64_t count) {
  Doubles value = {};
  if (count >= DOUBLES)
    std::memcpy(&value, from, sizeof value);
  else
    std::memcpy(&value, from, count * sizeof(double));
  return value;
}

INLINE void give(Doubles value, int64_t count, double* to) {
  if (count >= DOUBLES)
    std::memcpy(to, &value, sizeof value);
  else
    std::memcpy(to, &value, count * sizeof(double));
}

// Sine and cosine together, for |x| up to some thousands; absolute error about 1e-16 (Cephes).
INLINE void sine_cosine(Doubles x, Doubles& sine, Doubles& cosine) {
  constexpr double WHOLE = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to a whole number
  const Doubles shifted = fma(x, splat(0.63661977236758134308), splat(WHOLE));
  const Longs quadrant = to_bits(shifted);
  const Doubles whole = shifted - WHOLE;
  Doubles r = fma(whole, splat(-2 * 7.85398125648498535156e-1), x);
  r = fma(whole, splat(-2 * 3.77489470793079817668e-8), r);
  r = fma(whole, splat(-2 * 2.69515142907905952645e-15), r);
  const Doubles square = r * r;
  Doubles s = fma(square, splat(1.58962301576546568060e-10), splat(-2.50507477628578072866e-8));
  s = fma(s, square, splat(2.75573136213857245213e-6));
  s = fma(s, square, splat(-1.98412698295895385996e-4));
  s = fma(s, square, splat(8.33333333332211858878e-3));
  s = fma(s, square, splat(-1.66666666666666307295e-1));
  s = fma(s * square, r, r);
  Doubles c = fma(square, splat(-1.13585365213876817300e-11), splat(2.08757008419747316778e-9));
  c = fma(c, square, splat(-2.75573141792967388112e-7));
  c = fma(c, square, splat(2.48015872888517045348e-5));
  c = fma(c, square, splat(-1.38888888888730564116e-3));
  c = fma(c, square, splat(4.16666666666665929218e-2));
  c = fma(c * square, square, fma(square, splat(-0.5), splat(1.0)));
  const Longs odd = (quadrant & 1) == 1;
  sine = select(odd, c, s);
  cosine = select(odd, s, c);
  sine = from_bits(to_bits(sine) ^ ((quadrant & 2) << 62));
  cosine = from_bits(to_bits(cosine) ^ (((quadrant + 1) & 2) << 62));
}

}  // namespace
