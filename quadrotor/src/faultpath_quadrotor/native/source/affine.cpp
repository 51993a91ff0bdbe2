// Dense layers over few columns; see `Affine` in `predictors/network.py`.
//
// A column a lane, its inputs added up one after the other: its bits depend on no other column, on
// no number of them and on no width of the vector.
#include "simd.hpp"

namespace {

constexpr int BLOCK = 4;  // outputs summed at once

// The error function; error below 1 ulp (Juffa's polynomials, without his exponential).
INLINE Vector error_function(Vector x) {
  const Vector size = at_most(absolute(x), splat(4.0f)), square = x * x;
  Vector far = fma(splat(-1.72853470e-5f), size, splat(3.83197126e-4f));
  const Vector odd = fma(splat(-3.88396438e-3f), size, splat(2.42546219e-2f));
  far = fma(far, size * size, odd);
  far = fma(far, size, splat(-1.06777877e-1f));
  far = fma(far, size, splat(-6.34846687e-1f));
  far = fma(far, size, splat(-1.28717512e-1f));
  far = fma(far, size, -size);
  far = 1.0f - power_of_two(far * LOG2_E);
  far = as_float(as_bits(far) | (as_bits(x) & INT32_MIN));
  Vector near = splat(-5.96761703e-4f);
  near = fma(near, square, splat(4.99119423e-3f));
  near = fma(near, square, splat(-2.67681349e-2f));
  near = fma(near, square, splat(1.12819925e-1f));
  near = fma(near, square, splat(-3.76125336e-1f));
  near = fma(near, square, splat(1.28379166e-1f));
  near = fma(near, x, x);
  return select(absolute(x) > 0.927734375f, far, near);
}

// x times the chance that a standard normal is below it.
INLINE Vector gaussian_unit(Vector x) {
  constexpr float ROOT_HALF = 0.70710678118654752f;
  return 0.5f * x * (1.0f + error_function(x * ROOT_HALF));
}

template <typename Activation>
void affine(const float* weights, const float* biases, const float* x, int64_t outputs,
            int64_t inputs, int64_t columns, float* y, Activation activation) {
  for (int64_t n = 0; n < columns; n += LANES)
    for (int64_t first = 0; first < outputs; first += BLOCK) {
      const int64_t count = outputs - first < BLOCK ? outputs - first : BLOCK;
      Vector sums[BLOCK];
      for (int64_t o = 0; o < count; ++o) sums[o] = splat(biases[first + o]);
      for (int64_t i = 0; i < inputs; ++i) {
        const Vector value = take(x + i * columns + n, columns - n);
        for (int64_t o = 0; o < count; ++o)
          sums[o] = fma(splat(weights[(first + o) * inputs + i]), value, sums[o]);
      }
      for (int64_t o = 0; o < count; ++o)
        give(activation(sums[o]), columns - n, y + (first + o) * columns + n);
    }
}

}  // namespace

// `y` [outputs, N] = `weights` [outputs, inputs] @ `x` [inputs, N] + `biases` [outputs], through the
// Gaussian error linear unit where `gelu` is not zero.
extern "C" __attribute__((visibility("default"))) void faultpath_affine(
    const float* weights, const float* biases, const float* x, int64_t outputs, int64_t inputs,
    int64_t columns, int64_t gelu, float* y) {
  if (gelu)
    affine(weights, biases, x, outputs, inputs, columns, y, gaussian_unit);
  else
    affine(weights, biases, x, outputs, inputs, columns, y, [](Vector sum) { return sum; });
}
