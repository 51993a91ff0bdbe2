// Weights of candidates by their costs, and the mean that they make; see `planners/mppi.py`.
//
// Sums go into 16 lanes, whatever the width of the vector, and these are added up as a tree.
#include <algorithm>

#include "simd.hpp"

namespace {

constexpr int WIDTH = 16;
constexpr int PARTS = WIDTH / LANES;

INLINE float total(const Vector* parts) {
  float lanes[WIDTH];
  for (int p = 0; p < PARTS; ++p) store(lanes + p * LANES, parts[p]);
  for (int width = WIDTH / 2; width > 0; width /= 2)
    for (int i = 0; i < width; ++i) lanes[i] = lanes[i] + lanes[i + width];
  return lanes[0];
}

// Whole numbers in the order of the costs; what is not a number comes last.
INLINE int32_t rank(float cost) {
  int32_t bits;
  std::memcpy(&bits, &cost, sizeof bits);
  return cost == cost ? bits ^ ((bits >> 31) & INT32_MAX) : INT32_MAX;
}

// The standard deviation of the better half of the costs. `ranks` is scratch.
double spread(const float* costs, int64_t candidates, int32_t* ranks) {
  const int64_t half = candidates / 2;
  for (int64_t k = 0; k < candidates; ++k) ranks[k] = rank(costs[k]);
  std::nth_element(ranks, ranks + half - 1, ranks + candidates);
  const int32_t last = ranks[half - 1];
  // As many of those that rank last as fill the half; all of them cost the same.
  int64_t open = half;
  for (int64_t k = 0; k < candidates; ++k) open -= rank(costs[k]) < last;
  const auto over_half = [&](auto term) {
    double sum = 0.0;
    int64_t left = open;
    for (int64_t k = 0; k < candidates; ++k) {
      const int32_t own = rank(costs[k]);
      if (own < last || (own == last && left-- > 0)) sum += term(static_cast<double>(costs[k]));
    }
    return sum;
  };
  const double mean = over_half([](double cost) { return cost; }) / half;
  const double square = over_half([&](double cost) { return (cost - mean) * (cost - mean); });
  return __builtin_sqrt(square / (half - 1));
}

void weigh(const float* costs, float temperature, int64_t candidates, float* weights) {
  float best = costs[0];
  for (int64_t k = 1; k < candidates; ++k) best = costs[k] < best ? costs[k] : best;
  Vector sums[PARTS] = {};
  for (int64_t k = 0; k < candidates; k += WIDTH)
    for (int p = 0; p < PARTS; ++p) {
      const int64_t at = k + p * LANES;
      const Vector behind = (best - load(costs + at)) / temperature;
      const Vector weight = power_of_two(behind * LOG2_E);
      store(weights + at, weight);
      sums[p] = sums[p] + weight;
    }
  const float sum = total(sums);
  for (int64_t k = 0; k < candidates; k += LANES) store(weights + k, load(weights + k) / sum);
}

}  // namespace

extern "C" {

// `costs` and `weights` [S, K]: the softmax at `fraction` of the spread, at least `least`. K is a
// multiple of 16; `ranks` [K] is scratch.
__attribute__((visibility("default"))) void faultpath_weigh(
    const float* costs, const float* scale, int64_t scenes, int64_t candidates, int32_t* ranks,
    float* weights) {
  const float fraction = scale[0], least = scale[1];
  for (int64_t s = 0; s < scenes; ++s) {
    const float* own = costs + s * candidates;
    const float wide = static_cast<float>(spread(own, candidates, ranks)) * fraction;
    weigh(own, wide < least ? least : wide, candidates, weights + s * candidates);
  }
}

// `means` [rows, S] of `commands` [rows, S, K] under `weights` [S, K]; K is a multiple of 16.
__attribute__((visibility("default"))) void faultpath_mean(
    const float* commands, const float* weights, int64_t rows, int64_t scenes, int64_t candidates,
    float* means) {
  for (int64_t r = 0; r < rows; ++r)
    for (int64_t s = 0; s < scenes; ++s) {
      const float* from = commands + (r * scenes + s) * candidates;
      const float* by = weights + s * candidates;
      Vector sums[PARTS] = {};
      for (int64_t k = 0; k < candidates; k += WIDTH)
        for (int p = 0; p < PARTS; ++p)
          sums[p] = fma(load(from + k + p * LANES), load(by + k + p * LANES), sums[p]);
      means[r * scenes + s] = total(sums);
    }
}

}  // extern "C"
