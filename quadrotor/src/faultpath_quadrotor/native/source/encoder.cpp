// The encoder of depth images: three convolutions and two dense layers; see `ClearanceModel`.
//
// The vector runs over output channels, which all layers have in whole vectors, so that nothing is
// gathered. Images are padded with zeros where they lie; each layer writes into the middle of the
// next one's input.
#include "simd.hpp"

extern "C" {

// Convolutions `[ky][kx][in][out]`, dense layers `[out / 32][in][32]`.
struct Encoder {
  const float *first, *second, *third, *dense, *last;
  const float *first_bias, *second_bias, *third_bias, *dense_bias, *last_bias;
  float range, nearest, scale;  // inputs: depth / range and scale / max(depth, nearest)
};

}  // extern "C"

namespace {

constexpr int BLOCK = 32;  // outputs of a dense layer summed at once
constexpr int GROUP = 4;   // images that share a read of the dense weights
constexpr int DENSE = 128;
constexpr int CODE = 64;

// An image of `C` channels, last in memory, with `PAD` zeros around it.
template <int H, int W, int C, int PAD>
struct Image {
  static constexpr int HEIGHT = H, WIDTH = W, CHANNELS = C, MARGIN = PAD;
  alignas(64) float at[H + 2 * PAD][W + 2 * PAD][C];
};

// out = max(0, weights * in + bias), every second pixel of a square kernel.
template <int KERNEL, typename In, typename Out>
void convolve(const In& in, const float* weights, const float* bias, Out& out) {
  constexpr int PIXELS = 4, C = Out::CHANNELS;
  constexpr int PARTS = C / LANES <= 3 ? C / LANES : 2;
  static_assert(Out::WIDTH % PIXELS == 0 && C % (PARTS * LANES) == 0);
  for (int c = 0; c < C; c += PARTS * LANES)
    for (int y = 0; y < Out::HEIGHT; ++y)
      for (int x = 0; x < Out::WIDTH; x += PIXELS) {
        Vector sums[PIXELS][PARTS];
        for (int p = 0; p < PIXELS; ++p)
          for (int v = 0; v < PARTS; ++v) sums[p][v] = load(bias + c + v * LANES);
        for (int ky = 0; ky < KERNEL; ++ky)
          for (int kx = 0; kx < KERNEL; ++kx)
            for (int i = 0; i < In::CHANNELS; ++i) {
              const float* w = weights + ((ky * KERNEL + kx) * In::CHANNELS + i) * C + c;
              Vector weight[PARTS];
#pragma GCC unroll 3
              for (int v = 0; v < PARTS; ++v) weight[v] = load(w + v * LANES);
#pragma GCC unroll 4
              for (int p = 0; p < PIXELS; ++p) {
                const Vector value = splat(in.at[2 * y + ky][2 * (x + p) + kx][i]);
#pragma GCC unroll 3
                for (int v = 0; v < PARTS; ++v) sums[p][v] = fma(weight[v], value, sums[p][v]);
              }
            }
        for (int p = 0; p < PIXELS; ++p)
          for (int v = 0; v < PARTS; ++v)
            store(&out.at[y + Out::MARGIN][x + p + Out::MARGIN][c + v * LANES],
                  rectified(sums[p][v]));
      }
}

// Outputs `[GROUP][outputs]` of inputs `[GROUP][inputs]`.
void multiply(const float* weights, const float* bias, const float* in, int inputs, int outputs,
              float* out) {
  constexpr int PARTS = BLOCK / LANES;
  for (int o = 0; o < outputs; o += BLOCK) {
    Vector sums[GROUP][PARTS];
    for (int g = 0; g < GROUP; ++g)
      for (int v = 0; v < PARTS; ++v) sums[g][v] = load(bias + o + v * LANES);
    for (int i = 0; i < inputs; ++i, weights += BLOCK)
#pragma GCC unroll 4
      for (int g = 0; g < GROUP; ++g) {
        const Vector value = splat(in[g * inputs + i]);
#pragma GCC unroll 8
        for (int v = 0; v < PARTS; ++v)
          sums[g][v] = fma(load(weights + v * LANES), value, sums[g][v]);
      }
    for (int g = 0; g < GROUP; ++g)
      for (int v = 0; v < PARTS; ++v) store(out + g * outputs + o + v * LANES, sums[g][v]);
  }
}

using Depth = Image<36, 64, 2, 2>;
using Features = Image<5, 8, 48, 0>;
constexpr int FLAT = 5 * 8 * 48;

void see(const Encoder& model, const float* depth, Features& features) {
  Depth image = {};
  Image<18, 32, 16, 1> half = {};
  Image<9, 16, 32, 1> quarter = {};
  for (int y = 0; y < Depth::HEIGHT; ++y)
    for (int x = 0; x < Depth::WIDTH; ++x) {
      const float d = depth[y * Depth::WIDTH + x];
      float* pixel = image.at[y + Depth::MARGIN][x + Depth::MARGIN];
      pixel[0] = d / model.range;
      pixel[1] = model.scale / (d < model.nearest ? model.nearest : d);
    }
  convolve<5>(image, model.first, model.first_bias, half);
  convolve<3>(half, model.second, model.second_bias, quarter);
  convolve<3>(quarter, model.third, model.third_bias, features);
}

}  // namespace

// `depth` [S, 36, 64], m; `codes` [64, S].
extern "C" __attribute__((visibility("default"))) void faultpath_encode(
    const Encoder* model, const float* depth, int64_t scenes, float* codes) {
  constexpr int PIXELS = Depth::HEIGHT * Depth::WIDTH;
  for (int64_t first = 0; first < scenes; first += GROUP) {
    const int64_t count = scenes - first < GROUP ? scenes - first : GROUP;
    Features features[GROUP] = {};
    alignas(64) float hidden[GROUP * DENSE], code[GROUP * CODE];
    for (int64_t g = 0; g < count; ++g) see(*model, depth + (first + g) * PIXELS, features[g]);
    multiply(model->dense, model->dense_bias, &features[0].at[0][0][0], FLAT, DENSE, hidden);
    for (float& value : hidden) value = value < 0.0f ? 0.0f : value;
    multiply(model->last, model->last_bias, hidden, DENSE, CODE, code);
    for (int64_t g = 0; g < count; ++g)
      for (int i = 0; i < CODE; ++i) codes[i * scenes + first + g] = code[g * CODE + i];
  }
}
