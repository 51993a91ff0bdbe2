// The cost of candidates, and their weighted mean; see `planner/costs.py` and `planner/mppi.py`.
#include <algorithm>

#include "simd.hpp"

extern "C" {

struct Weights {
  int64_t running;  // the mean distance along the horizon counts, not the one at its end
  float goal, risk, hit, margin, radius, speed, v_max, heading, rate_effort, thrust_effort;
};

}  // extern "C"

namespace {

INLINE Vector norm(Vector x, Vector y, Vector z) { return sqrt(fma(z, z, fma(y, y, x * x))); }

struct Shape {
  int64_t steps, scenes, candidates;
};

// What the cost reads of one scene, each at its first candidate.
struct Scene {
  const float* positions;
  const float* velocities;
  const float* ends;
  const float* commands;
  const float* clearance;
  float goal[3];
  float hover;
};

Vector cost(const Weights& w, const Scene& at, const Shape& shape) {
  const int64_t axis = shape.scenes * shape.steps * shape.candidates;
  const int64_t row = shape.scenes * shape.candidates;
  const Vector hover = splat(at.hover), zero = splat(0.0f), one = splat(1.0f);
  Vector distance = zero, risk = zero, hits = zero, excess = zero, turning = zero, pushing = zero;
  for (int64_t h = 0; h < shape.steps; ++h) {
    const int64_t step = h * shape.candidates;
    if (w.running || h == shape.steps - 1) {
      const float* p = at.positions + step;
      distance = distance + norm(load(p) - at.goal[0], load(p + axis) - at.goal[1],
                                 load(p + 2 * axis) - at.goal[2]);
    }
    const float* v = at.velocities + step;
    const Vector speed = norm(load(v), load(v + axis), load(v + 2 * axis));
    const Vector over = at_least(speed - w.v_max, zero);
    excess = fma(over, over, excess);

    const Vector free = load(at.clearance + step) - w.radius;
    const Vector near = bounded(1.0f - free / w.margin, zero, one);
    risk = fma(near, near, risk);
    hits = hits + select(free < zero, one, zero);

    const float* u = at.commands + 4 * h * row;
    const Vector departure = load(u) - hover;
    pushing = fma(departure, departure, pushing);
    for (int i = 1; i < 4; ++i) {
      const Vector rate = load(u + i * row);
      turning = fma(rate, rate, turning);
    }
  }
  const float mean = 1.0f / shape.steps;
  const float* v = at.velocities + (shape.steps - 1) * shape.candidates;
  const Vector forward_x = load(at.ends), forward_y = load(at.ends + 3 * row);
  const Vector travel_x = load(v), travel_y = load(v + axis);
  const Vector along = fma(forward_y, travel_y, forward_x * travel_x);
  const Vector scale = fma(forward_y, forward_y, forward_x * forward_x) *
                       fma(travel_y, travel_y, travel_x * travel_x);
  const Vector heading = 1.0f - along / sqrt(scale + 1e-4f);

  Vector total = distance * (w.running ? w.goal * mean : w.goal);
  total = fma(risk, splat(w.risk * mean), total);
  total = fma(hits, splat(w.hit * mean), total);
  total = fma(excess, splat(w.speed * mean), total);
  total = fma(heading, splat(w.heading), total);
  total = fma(turning, splat(w.rate_effort * mean), total);
  return fma(pushing, splat(w.thrust_effort * mean) / (hover * hover), total);
}

}  // namespace

// `positions`, `velocities` [3, S, H, K]; `rotation` [3, 3, S, K] at the end; `commands`
// [H, 4, S, K]; `clearance` [S, H, K]; `goal` [3, S]; `hover` [S]; `costs` [S, K].
extern "C" __attribute__((visibility("default"))) void faultpath_cost(
    const Weights* weights, const float* positions, const float* velocities, const float* rotation,
    const float* commands, const float* clearance, const float* goal, const float* hover,
    int64_t steps, int64_t scenes, int64_t candidates, float* costs) {
  const Shape shape{steps, scenes, candidates};
  for (int64_t s = 0; s < scenes; ++s)
    for (int64_t k = 0; k < candidates; k += LANES) {
      const int64_t along = s * steps * candidates + k, across = s * candidates + k;
      const Scene at{positions + along,
                     velocities + along,
                     rotation + across,
                     commands + across,
                     clearance + along,
                     {goal[s], goal[scenes + s], goal[2 * scenes + s]},
                     hover[s]};
      store(costs + across, cost(*weights, at, shape));
    }
}

// `weights` [S, K] from `costs` [S, K]: the softmax at a temperature that is `fraction` of the spread
// of the better half of the costs, at least `least`. `scratch` [K].
extern "C" __attribute__((visibility("default"))) void faultpath_weights(
    const float* costs, const float* scale, int64_t scenes, int64_t candidates, float* scratch,
    float* weights) {
  const float fraction = scale[0], least = scale[1];
  const int64_t half = candidates / 2;
  for (int64_t s = 0; s < scenes; ++s, costs += candidates, weights += candidates) {
    std::memcpy(scratch, costs, candidates * sizeof(float));
    std::nth_element(scratch, scratch + half, scratch + candidates);
    const float lowest = *std::min_element(scratch, scratch + half);
    double sum = 0.0, squares = 0.0;
    for (int64_t k = 0; k < half; ++k) sum += scratch[k];
    for (int64_t k = 0; k < half; ++k) {
      const double departure = scratch[k] - sum / half;
      squares += departure * departure;
    }
    const float spread = static_cast<float>(__builtin_sqrt(squares / (half - 1)));
    const float temperature = spread * fraction > least ? spread * fraction : least;
    double total = 0.0;
    for (int64_t k = 0; k < candidates; k += LANES) {
      const Vector x = (lowest - load(costs + k)) / temperature;
      // Weights too small to matter are zero: sums of such numbers would crawl.
      store(weights + k, select(x < -80.0f, splat(0.0f), power_of_two(x * LOG2_E)));
    }
    for (int64_t k = 0; k < candidates; ++k) total += weights[k];
    const float share = static_cast<float>(1.0 / total);
    for (int64_t k = 0; k < candidates; k += LANES) store(weights + k, load(weights + k) * share);
  }
}

// `plan` [H, 4, S] becomes the mean of `commands` [H, 4, S, K] under `weights` [S, K].
extern "C" __attribute__((visibility("default"))) void faultpath_mean(
    const float* commands, const float* weights, int64_t rows, int64_t scenes, int64_t candidates,
    float* plan) {
  constexpr int PART = 16;  // partial sums, the same for all widths
  for (int64_t r = 0; r < rows; ++r)
    for (int64_t s = 0; s < scenes; ++s) {
      const float* command = commands + (r * scenes + s) * candidates;
      const float* weight = weights + s * candidates;
      Vector sums[PART / LANES] = {};
      for (int64_t k = 0; k < candidates; k += PART)
        for (int i = 0; i < PART / LANES; ++i) {
          const int64_t at = k + i * LANES;
          sums[i] = fma(load(command + at), load(weight + at), sums[i]);
        }
      float parts[PART];
      std::memcpy(parts, sums, sizeof parts);
      float total = 0.0f;
      for (int i = 0; i < PART; ++i) total += parts[i];
      plan[r * scenes + s] = total;
    }
}
