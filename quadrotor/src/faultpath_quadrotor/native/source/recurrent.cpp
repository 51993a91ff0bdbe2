// A gated recurrent unit over a sequence; see `GatedCell` in `predictors/network.py`.
//
// Columns are few here, so the vector runs over the unit's outputs instead, and a column's bits do
// not depend on the others.
#include "simd.hpp"

namespace {

constexpr int LATENT = 32;
constexpr int GATES = 3 * LATENT;  // reset, update, candidate
constexpr int MOST_INPUTS = 32;
constexpr int PARTS = GATES / LANES;
constexpr int THIRD = LATENT / LANES;

// `[outputs][inputs]` to `[inputs][outputs]`, so that an input's weights lie together.
void turn(const float* weights, int64_t inputs, float (*turned)[GATES]) {
  for (int64_t o = 0; o < GATES; ++o)
    for (int64_t i = 0; i < inputs; ++i) turned[i][o] = weights[o * inputs + i];
}

INLINE void add(const float* weights, float value, Vector* sums) {
  const Vector x = splat(value);
#pragma GCC unroll 24
  for (int p = 0; p < PARTS; ++p) sums[p] = fma(load(weights + p * LANES), x, sums[p]);
}

}  // namespace

// Weights and biases as in the cell's two affine layers; `sequence` [T, inputs, N]; `latent`
// [32, N], from zero. At most 32 inputs.
extern "C" __attribute__((visibility("default"))) void faultpath_recur(
    const float* input_weights, const float* input_biases, const float* latent_weights,
    const float* latent_biases, const float* sequence, int64_t steps, int64_t inputs,
    int64_t columns, float* latent) {
  alignas(64) float given[MOST_INPUTS][GATES], kept[LATENT][GATES];
  turn(input_weights, inputs, given);
  turn(latent_weights, LATENT, kept);
  for (int64_t n = 0; n < columns; ++n) {
    alignas(64) float state[LATENT] = {};
    for (int64_t t = 0; t < steps; ++t) {
      Vector input[PARTS], memory[PARTS];
      for (int p = 0; p < PARTS; ++p) {
        input[p] = load(input_biases + p * LANES);
        memory[p] = load(latent_biases + p * LANES);
      }
      for (int64_t i = 0; i < inputs; ++i)
        add(given[i], sequence[(t * inputs + i) * columns + n], input);
      for (int i = 0; i < LATENT; ++i) add(kept[i], state[i], memory);
      for (int p = 0; p < THIRD; ++p) {
        const Vector reset = sigmoid(input[p] + memory[p]);
        const Vector update = sigmoid(input[THIRD + p] + memory[THIRD + p]);
        const Vector fresh =
            hyperbolic_tangent(fma(reset, memory[2 * THIRD + p], input[2 * THIRD + p]));
        const Vector before = load(state + p * LANES);
        store(state + p * LANES, fma(update, before - fresh, fresh));
      }
    }
    for (int i = 0; i < LATENT; ++i) latent[i * columns + n] = state[i];
  }
}
