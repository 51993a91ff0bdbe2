// The baked distance to scenes at many points: trilinear, a vector of points at a time.
//
// `scenes/field.py` is the reference, and this gives its bits: nothing is fused.
#include "simd.hpp"

extern "C" {

struct Field {
  const float* table;
  int64_t along_x, along_y;  // places per step; along z it is one
  const float* origin;       // [3][scenes]
  const float* last;         // [3][scenes], greatest cell number
  const int32_t* first;      // [scenes], place of the first lattice point
  float per_metre;
};

}  // extern "C"

namespace {

// The values at places and at the places after them: one read of two, as z lies fastest.
struct Pair {
  Vector low, high;
};

INLINE Pair gather(const float* table, Integers place) {
  Pair pair;
#if defined(__AVX512F__)
  const __m512i places = reinterpret_cast<__m512i>(place);
  const __m512 a = _mm512_castsi512_ps(
      _mm512_i32gather_epi64(_mm512_castsi512_si256(places), table, sizeof(float)));
  const __m512 b = _mm512_castsi512_ps(
      _mm512_i32gather_epi64(_mm512_extracti64x4_epi64(places, 1), table, sizeof(float)));
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  pair.low = _mm512_permutex2var_ps(a, even, b);
  pair.high = _mm512_permutex2var_ps(a, _mm512_add_epi32(even, _mm512_set1_epi32(1)), b);
#elif defined(__AVX2__) && defined(__FMA__)
  const __m256i places = reinterpret_cast<__m256i>(place);
  const auto* pairs = reinterpret_cast<const double*>(table);
  const __m256 a = _mm256_castpd_ps(
      _mm256_i32gather_pd(pairs, _mm256_castsi256_si128(places), sizeof(float)));
  const __m256 b = _mm256_castpd_ps(
      _mm256_i32gather_pd(pairs, _mm256_extracti128_si256(places, 1), sizeof(float)));
  const auto in_order = [](__m256 mixed) {
    return _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(mixed), 0xd8));
  };
  pair.low = in_order(_mm256_shuffle_ps(a, b, 0x88));
  pair.high = in_order(_mm256_shuffle_ps(a, b, 0xdd));
#else
  for (int i = 0; i < LANES; ++i) {
    pair.low[i] = table[place[i]];
    pair.high[i] = table[place[i] + 1];
  }
#endif
  return pair;
}

INLINE Vector between(Vector low, Vector high, Vector fraction) {
  return (high - low) * fraction + low;
}

INLINE Vector interpolate(const Field& field, const float* table, const Vector* fraction,
                          Integers place) {
  const auto edges = [&](int64_t shift) {  // between lattice points along x, at both ends in z
    const Pair near = gather(table + shift, place);
    const Pair far = gather(table + shift + field.along_x, place);
    return Pair{between(near.low, far.low, fraction[0]), between(near.high, far.high, fraction[0])};
  };
  const Pair left = edges(0), right = edges(field.along_y);
  return between(between(left.low, right.low, fraction[1]),
                 between(left.high, right.high, fraction[1]), fraction[2]);
}

// The distances of a vector of points of scene `s`.
INLINE Vector distance(const Field& field, const float* points, int64_t scenes, int64_t s,
                       int64_t stride, int64_t filled) {
  Vector cell[3], fraction[3];
  for (int i = 0; i < 3; ++i) {
    const Vector point = take(points + i * stride, filled);
    const Vector local = (point - field.origin[i * scenes + s]) * field.per_metre;
    // What is not a number reads a cell all the same: the fraction stays what it is.
    const Vector known = select(local == local, local, splat(0.0f));
    const Vector inside = bounded(known, splat(0.0f), splat(field.last[i * scenes + s]));
    cell[i] = __builtin_convertvector(__builtin_convertvector(inside, Integers), Vector);
    fraction[i] = local - cell[i];
  }
  // Places within one scene stay below 2^24, up to where float counts exactly.
  const Vector place = cell[0] * static_cast<float>(field.along_x) +
                       cell[1] * static_cast<float>(field.along_y) + cell[2];
  return interpolate(field, field.table + field.first[s], fraction,
                     __builtin_convertvector(place, Integers));
}

}  // namespace

// `points` [3][scenes][count], `distances` [scenes][count].
extern "C" __attribute__((visibility("default"))) void faultpath_field(
    const Field* field, const float* points, int64_t scenes, int64_t count, float* distances) {
  for (int64_t s = 0; s < scenes; ++s)
    for (int64_t n = 0; n < count; n += LANES) {
      const int64_t at = s * count + n;
      give(distance(*field, points + at, scenes, s, scenes * count, count - n), count - n,
           distances + at);
    }
}
