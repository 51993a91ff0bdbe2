// Clearance at many points from the depth image's code; see `perception/clearance.py`.
#include "layers.hpp"
#include "rotation.hpp"

namespace {

// Without the constants that the query network in torch carries along: they are biases here.
constexpr int FEATURES = 8;
constexpr int HIDDEN = 47;
constexpr int CODE = 64;
constexpr int PADDED = (HIDDEN + OUTPUTS - 1) / OUTPUTS * OUTPUTS;

}  // namespace

extern "C" {

struct Bounds {
  float lowest, highest;  // of the answer
  float unseen;           // most clearance where no pixel looks
  float near;             // squared range within which that does not matter
  float left, up;         // half the image's width and height, per metre forward
};

}  // extern "C"

namespace {

// One scene's query network, as `layers.hpp` reads it.
struct Query {
  alignas(64) float first[(1 + FEATURES) * PADDED];
  float second[(1 + HIDDEN) * PADDED];
  float last[HIDDEN + 1];  // the bias at the end
};
constexpr int NUMBERS = sizeof(Query) / sizeof(float);

// The query network of a code `[64]`: `makers` [64, NUMBERS] @ code + `base`.
void make(const float* makers, const float* base, const float* code, int64_t pitch,
          Query& query) {
  constexpr int BLOCK = 96, PARTS = BLOCK / LANES;
  static_assert(NUMBERS % BLOCK == 0);
  float* numbers = query.first;
  for (int first = 0; first < NUMBERS; first += BLOCK) {
    Vector sums[PARTS];
    for (int p = 0; p < PARTS; ++p) sums[p] = load(base + first + p * LANES);
    for (int i = 0; i < CODE; ++i) {
      const Vector value = splat(code[i * pitch]);
      const float* weights = makers + i * NUMBERS + first;
#pragma GCC unroll 24
      for (int p = 0; p < PARTS; ++p) sums[p] = fma(load(weights + p * LANES), value, sums[p]);
    }
    for (int p = 0; p < PARTS; ++p) store(numbers + first + p * LANES, sums[p]);
  }
}

// The last layer has one output: two sums a vector hide the latency.
INLINE Row answer(const float* weights, const Row* hidden) {
  Row even = each(weights[HIDDEN]), odd = each(0.0f);
  for (int i = 0; i < HIDDEN; ++i)
    for (int v = 0; v < WIDE; ++v) {
      Vector& sum = i % 2 ? odd.part[v] : even.part[v];
      sum = fma(splat(weights[i]), hidden[i].part[v], sum);
    }
  for (int v = 0; v < WIDE; ++v) even.part[v] = even.part[v] + odd.part[v];
  return even;
}

INLINE void capture(const float* eye, const float* axes, const Row* world, Row* local) {
  for (int v = 0; v < WIDE; ++v) {
    Vector r[9], offset[3], turned[3];
    for (int i = 0; i < 9; ++i) r[i] = splat(axes[i]);
    for (int i = 0; i < 3; ++i) offset[i] = world[i].part[v] - eye[i];
    rotate_back(r, offset, turned);
    for (int i = 0; i < 3; ++i) local[i].part[v] = turned[i];
  }
}

INLINE void describe(const Row* local, Row* features) {
  for (int v = 0; v < WIDE; ++v) {
    const Vector x = local[0].part[v], y = local[1].part[v], z = local[2].part[v];
    const Vector distance = sqrt(fma(z, z, fma(y, y, x * x)));
    const Vector inverse = 1.0f / (at_least(x, splat(0.0f)) + 0.25f);
    const Vector edge = splat(1.5f);
    features[0].part[v] = fma(x, splat(0.5f), splat(-0.5f));
    features[1].part[v] = y * 0.5f;
    features[2].part[v] = z * 0.5f;
    features[3].part[v] = fma(distance, splat(0.5f), splat(-0.7f));
    features[4].part[v] = inverse - 0.7f;
    features[5].part[v] = bounded(y * inverse, -edge, edge);
    features[6].part[v] = bounded(z * inverse, -edge, edge);
    features[7].part[v] = 1.0f / (distance + 0.25f) - 0.7f;
  }
}

INLINE Vector limited(const Bounds& bounds, const Row* local, int v, Vector clearance) {
  const Vector x = local[0].part[v], y = local[1].part[v], z = local[2].part[v];
  const Integers seen = (x > 0.0f) & (absolute(y) < x * bounds.left) & (absolute(z) < x * bounds.up);
  const Integers near = fma(z, z, fma(y, y, x * x)) < bounds.near;
  const Vector value = bounded(clearance, splat(bounds.lowest), splat(bounds.highest));
  return select(seen | near, value, at_most(value, splat(bounds.unseen)));
}

}  // namespace

// `codes` [64, S] of the images, `makers` and `base` as in `make`; `eye` [S, 3] and `axes` [S, 9]: the
// capture frames; `points` [3, S, N] in the world frame. `clearance` [S, N].
extern "C" __attribute__((visibility("default"))) void faultpath_clearance(
    const Bounds* bounds, const float* makers, const float* base, const float* codes,
    const float* eye, const float* axes, const float* points, int64_t scenes, int64_t count,
    float* clearance) {
  Query query;
  const Layer layers[2] = {{query.first, FEATURES, PADDED}, {query.second, HIDDEN, PADDED}};
  for (int64_t s = 0; s < scenes; ++s) {
    make(makers, base, codes + s, scenes, query);
    for (int64_t n = 0; n < count; n += TILE) {
      Row world[3], local[3], features[FEATURES], hidden[2][PADDED];
      const int64_t left = count - n;
      for (int i = 0; i < 3; ++i) take(points + (i * scenes + s) * count + n, left, world[i]);
      capture(eye + 3 * s, axes + 9 * s, world, local);
      describe(local, features);
      dense(layers[0], features, hidden[0], rectified);
      dense(layers[1], hidden[0], hidden[1], rectified);
      Row clear = answer(query.last, hidden[1]);
      for (int v = 0; v < WIDE; ++v) clear.part[v] = limited(*bounds, local, v, clear.part[v]);
      give(clear, left, clearance + s * count + n);
    }
  }
}
