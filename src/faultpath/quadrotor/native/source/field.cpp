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

INLINE Vector gather(const float* table, Integers place) {
#if defined(__AVX512F__)
  return _mm512_i32gather_ps(reinterpret_cast<__m512i>(place), table, sizeof(float));
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_i32gather_ps(table, reinterpret_cast<__m256i>(place), sizeof(float));
#else
  Vector value;
  for (int i = 0; i < LANES; ++i) value[i] = table[place[i]];
  return value;
#endif
}

INLINE Vector between(Vector low, Vector high, Vector fraction) {
  return (high - low) * fraction + low;
}

INLINE Vector interpolate(const Field& field, const float* table, const Vector* fraction,
                          Integers place) {
  const auto edge = [&](int64_t shift) {  // between two lattice points along x
    return between(gather(table + shift, place), gather(table + shift + field.along_x, place),
                   fraction[0]);
  };
  const Vector near = between(edge(0), edge(field.along_y), fraction[1]);
  const Vector far = between(edge(1), edge(field.along_y + 1), fraction[1]);
  return between(near, far, fraction[2]);
}

}  // namespace

// `points` [3][scenes][count], `distances` [scenes][count].
extern "C" __attribute__((visibility("default"))) void faultpath_field(
    const Field* field, const float* points, int64_t scenes, int64_t count, float* distances) {
  for (int64_t s = 0; s < scenes; ++s) {
    const float* table = field->table + field->first[s];
    for (int64_t n = 0; n < count; n += LANES) {
      const int64_t at = s * count + n;
      const size_t bytes = (count - n < LANES ? count - n : LANES) * sizeof(float);
      Vector cell[3], fraction[3];
      for (int i = 0; i < 3; ++i) {
        Vector point = {};
        std::memcpy(&point, points + i * scenes * count + at, bytes);
        const Vector local = (point - field->origin[i * scenes + s]) * field->per_metre;
        // What is not a number reads cell 0: the fraction stays what it is.
        const Vector inside = bounded(local, splat(0.0f), splat(field->last[i * scenes + s]));
        cell[i] = __builtin_convertvector(__builtin_convertvector(inside, Integers), Vector);
        fraction[i] = local - cell[i];
      }
      // Places within one scene stay below 2^24, up to where float counts exactly.
      const Vector place = cell[0] * static_cast<float>(field->along_x) +
                           cell[1] * static_cast<float>(field->along_y) + cell[2];
      const Vector value =
          interpolate(*field, table, fraction, __builtin_convertvector(place, Integers));
      std::memcpy(distances + at, &value, bytes);
    }
  }
}
