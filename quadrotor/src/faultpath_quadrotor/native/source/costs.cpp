// The cost of candidates; see `planner/costs.py`.
#include <initializer_list>

#include "simd.hpp"

extern "C" {

struct Weights {
  float running;  // share of the mean distance along the horizon; the rest is that at its end
  float goal, risk, hit, margin, radius, speed, v_max, heading, rate_effort, thrust_effort;
};

}  // extern "C"

namespace {

INLINE Vector norm(Vector x, Vector y, Vector z) { return sqrt(fma(z, z, fma(y, y, x * x))); }

// Where the parts of one scene start, and how far apart their rows lie.
struct Scene {
  const float* positions;
  const float* velocities;
  const float* rotation;
  const float* commands;
  const float* clearance;
  float goal[3];
  float hover;
  int64_t axis;  // between x, y and z of positions and velocities
  int64_t row;   // between rows of commands and of the rotation
};

INLINE Vector distance(const Scene& at, int64_t place) {
  const float* p = at.positions + place;
  return norm(load(p) - at.goal[0], load(p + at.axis) - at.goal[1],
              load(p + 2 * at.axis) - at.goal[2]);
}

// What one step adds: risk, speed and effort, each already weighted and divided by the steps.
INLINE Vector along_the_way(const Weights& w, const Scene& at, int64_t place, const float* u) {
  const Vector zero = splat(0.0f), one = splat(1.0f);
  const Vector free = load(at.clearance + place) - w.radius;
  const Vector near = bounded(1.0f - free / w.margin, zero, one);
  Vector cost = fma(near * near, splat(w.risk), select(free < zero, splat(w.hit), zero));

  const float* v = at.velocities + place;
  const Vector speed = norm(load(v), load(v + at.axis), load(v + 2 * at.axis));
  const Vector over = at_least(speed - w.v_max, zero);
  cost = fma(over * over, splat(w.speed), cost);

  const Vector departure = load(u) / at.hover - one;
  cost = fma(departure * departure, splat(w.thrust_effort), cost);
  Vector turning = zero;
  for (int i = 1; i < 4; ++i) turning = fma(load(u + i * at.row), load(u + i * at.row), turning);
  return fma(turning, splat(w.rate_effort), cost);
}

// One minus the cosine between the body's x axis and the direction of travel, from above.
INLINE Vector heading(const Scene& at, int64_t end, int64_t k) {
  const Vector forward_x = load(at.rotation + k), forward_y = load(at.rotation + 3 * at.row + k);
  const Vector travel_x = load(at.velocities + end), travel_y = load(at.velocities + end + at.axis);
  const Vector along = fma(forward_y, travel_y, forward_x * travel_x);
  const Vector scale = fma(forward_y, forward_y, forward_x * forward_x) *
                       fma(travel_y, travel_y, travel_x * travel_x);
  return 1.0f - along / sqrt(scale + 1e-4f);
}

// Steps outside and candidates inside: rows are read from end to end, as they lie in memory.
void score(const Weights& w, const Scene& at, int64_t steps, int64_t candidates, float* costs) {
  Weights mean = w;
  for (float* weight : {&mean.risk, &mean.hit, &mean.speed, &mean.rate_effort,
                        &mean.thrust_effort})
    *weight /= steps;
  const float way = w.running * (w.goal / steps), end = (1.0f - w.running) * w.goal + way;
  for (int64_t h = 0; h < steps; ++h) {
    const bool last = h == steps - 1;
    for (int64_t k = 0; k < candidates; k += LANES) {
      const int64_t place = h * candidates + k;
      Vector cost = h == 0 ? splat(0.0f) : load(costs + k);
      cost = cost + along_the_way(mean, at, place, at.commands + 4 * h * at.row + k);
      const float goal = last ? end : way;
      if (goal != 0.0f) cost = fma(distance(at, place), splat(goal), cost);
      if (last) cost = fma(heading(at, place, k), splat(w.heading), cost);
      store(costs + k, cost);
    }
  }
}

}  // namespace

// `positions`, `velocities` [3, S, H, K]; `rotation` [3, 3, S, K] at the end; `commands`
// [H, 4, S, K]; `clearance` [S, H, K]; `goal` [3, S]; `hover` [S]; `costs` [S, K].
extern "C" __attribute__((visibility("default"))) void faultpath_cost(
    const Weights* weights, const float* positions, const float* velocities, const float* rotation,
    const float* commands, const float* clearance, const float* goal, const float* hover,
    int64_t steps, int64_t scenes, int64_t candidates, float* costs) {
  for (int64_t s = 0; s < scenes; ++s) {
    const int64_t along = s * steps * candidates, across = s * candidates;
    const Scene at{positions + along,
                   velocities + along,
                   rotation + across,
                   commands + across,
                   clearance + along,
                   {goal[s], goal[scenes + s], goal[2 * scenes + s]},
                   hover[s],
                   scenes * steps * candidates,
                   scenes * candidates};
    score(*weights, at, steps, candidates, costs + across);
  }
}
