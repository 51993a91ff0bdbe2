// Rotations as nine vectors, row by row; see `so3.py` for the formulas.
#pragma once

#include "simd64.hpp"

namespace {

template <typename V>
INLINE void compose(const V* a, const V* b, V* product) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      product[3 * i + j] =
          fma(a[3 * i + 2], b[6 + j], fma(a[3 * i + 1], b[3 + j], a[3 * i] * b[j]));
}

template <typename V>
INLINE void rotate(const V* r, const V* x, V* turned) {
  for (int i = 0; i < 3; ++i)
    turned[i] = fma(r[3 * i + 2], x[2], fma(r[3 * i + 1], x[1], r[3 * i] * x[0]));
}

template <typename V>
INLINE void rotate_back(const V* r, const V* x, V* turned) {
  for (int i = 0; i < 3; ++i) turned[i] = fma(r[6 + i], x[2], fma(r[3 + i], x[1], r[i] * x[0]));
}

// The rotation by |phi| about phi, through half angles.
template <typename V>
INLINE void rotation_of(const V* phi, V* r) {
  using Scalar = decltype(phi[0][0] + 0);
  const V square = fma(phi[2], phi[2], fma(phi[1], phi[1], phi[0] * phi[0]));
  const V angle = sqrt(square + Scalar(1e-24));
  V s, c;
  sine_cosine(angle * Scalar(0.5), s, c);
  const V ratio = s / angle;
  const V x = phi[0] * ratio, y = phi[1] * ratio, z = phi[2] * ratio;
  const V xx = x + x, yy = y + y, zz = z + z;
  const V cosine = fma(c, c, -(s * s));
  r[0] = fma(xx, x, cosine);
  r[1] = fma(xx, y, -(zz * c));
  r[2] = fma(xx, z, yy * c);
  r[3] = fma(yy, x, zz * c);
  r[4] = fma(yy, y, cosine);
  r[5] = fma(yy, z, -(xx * c));
  r[6] = fma(zz, x, -(yy * c));
  r[7] = fma(zz, y, xx * c);
  r[8] = fma(zz, z, cosine);
}

}  // namespace
