// Dense layers over a tile of candidates: rows of features, each row a few vectors wide.
//
// A tile's rows stay in the first-level cache. Weights are packed so that a block of OUTPUTS of
// them lies together for each input; the block's sums stay in registers over all inputs.
#pragma once

#include "simd.hpp"

// Weights of one layer: `[outputs / block][1 + inputs][block]`, biases first, outputs padded.
struct Layer {
  const float* weights;
  int64_t inputs;
  int64_t outputs;  // padded to whole blocks
};

namespace {

#if defined(__AVX512F__)
constexpr int WIDE = 4;  // vectors a row
#else
constexpr int WIDE = 2;
#endif
constexpr int OUTPUTS = 4;  // outputs summed at once: WIDE * OUTPUTS registers hold them
constexpr int TILE = WIDE * LANES;  // candidates worked on together

struct Row {
  Vector part[WIDE];
};

INLINE Row each(float value) {
  Row row;
  for (int v = 0; v < WIDE; ++v) row.part[v] = splat(value);
  return row;
}

// Rows in memory; the last tile may be short of `count` candidates.
INLINE void take(const float* from, int64_t count, Row& row) {
  if (count >= TILE) {
    std::memcpy(&row, from, sizeof row);
  } else {
    row = each(0.0f);
    std::memcpy(&row, from, count * sizeof(float));
  }
}

INLINE void give(const Row& row, int64_t count, float* to) {
  std::memcpy(to, &row, (count < TILE ? count : TILE) * sizeof(float));
}

// Unrolled in full, so that the sums stay in registers.
template <int BLOCK>
INLINE void accumulate(const float* weights, const Row* x, int64_t inputs, Row* sums) {
  Vector held[BLOCK][WIDE];
#pragma GCC unroll 4
  for (int o = 0; o < BLOCK; ++o)
#pragma GCC unroll 4
    for (int v = 0; v < WIDE; ++v) held[o][v] = sums[o].part[v];
#pragma GCC unroll 2
  for (int64_t i = 0; i < inputs; ++i, weights += BLOCK)
#pragma GCC unroll 4
    for (int o = 0; o < BLOCK; ++o) {
      const Vector weight = splat(weights[o]);
#pragma GCC unroll 4
      for (int v = 0; v < WIDE; ++v) held[o][v] = fma(weight, x[i].part[v], held[o][v]);
    }
#pragma GCC unroll 4
  for (int o = 0; o < BLOCK; ++o)
#pragma GCC unroll 4
    for (int v = 0; v < WIDE; ++v) sums[o].part[v] = held[o][v];
}

template <int BLOCK>
INLINE void start(const float* biases, Row* sums) {
  for (int o = 0; o < BLOCK; ++o)
    for (int v = 0; v < WIDE; ++v) sums[o].part[v] = splat(biases[o]);
}

// y = activation(weights @ x + biases)
template <typename Activation>
INLINE void dense(const Layer& layer, const Row* x, Row* y, Activation activation) {
  const float* weights = layer.weights;
  const int64_t stride = (1 + layer.inputs) * OUTPUTS;
  for (int64_t first = 0; first < layer.outputs; first += OUTPUTS, weights += stride) {
    Row sums[OUTPUTS];
    start<OUTPUTS>(weights, sums);
    accumulate<OUTPUTS>(weights + OUTPUTS, x, layer.inputs, sums);
    for (int o = 0; o < OUTPUTS; ++o)
      for (int v = 0; v < WIDE; ++v) y[first + o].part[v] = activation(sums[o].part[v]);
  }
}

}  // namespace
