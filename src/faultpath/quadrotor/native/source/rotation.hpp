// Rotations as nine vectors, row by row; see `so3.py` for the formulas.
#pragma once

#include "layers.hpp"

namespace {

struct Rotation {
  Row at[9];
};

INLINE void compose(const Vector* a, const Vector* b, Vector* product) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      product[3 * i + j] =
          fma(a[3 * i + 2], b[6 + j], fma(a[3 * i + 1], b[3 + j], a[3 * i] * b[j]));
}

INLINE void rotate(const Vector* r, const Vector* x, Vector* turned) {
  for (int i = 0; i < 3; ++i)
    turned[i] = fma(r[3 * i + 2], x[2], fma(r[3 * i + 1], x[1], r[3 * i] * x[0]));
}

INLINE void rotate_back(const Vector* r, const Vector* x, Vector* turned) {
  for (int i = 0; i < 3; ++i)
    turned[i] = fma(r[6 + i], x[2], fma(r[3 + i], x[1], r[i] * x[0]));
}

// The rotation by |phi| about phi, through half angles.
INLINE void rotation_of(const Vector* phi, Vector* r) {
  const Vector square = fma(phi[2], phi[2], fma(phi[1], phi[1], phi[0] * phi[0]));
  const Vector angle = sqrt(square + 1e-24f);
  Vector s, c;
  sine_cosine(angle * 0.5f, s, c);
  const Vector ratio = s / angle;
  const Vector x = phi[0] * ratio, y = phi[1] * ratio, z = phi[2] * ratio;
  const Vector xx = x + x, yy = y + y, zz = z + z;
  const Vector cosine = c * c - s * s;
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
