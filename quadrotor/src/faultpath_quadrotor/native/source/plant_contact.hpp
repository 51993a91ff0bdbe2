// The distance to a scene's prisms, and what it does to a trial; a scene a lane.
//
// `scenes/geometry.py` and `plant/contact.py` are the reference. Operations are the same in the
// same order, none fused.
#pragma once

#include "simd64.hpp"

extern "C" {

// Where each lane's trial stands, and among what it flies.
struct Trial {
  const double* solids;  // [count][Solid][lanes]
  int64_t count;
  const double* goal;  // [3][lanes]
  double radius;       // of the vehicle
  int64_t every;       // steps between looks
  int64_t made;        // steps before this call
  double per_second;   // steps
  uint8_t* running;    // [lanes], as all that follow
  uint8_t* crashed;
  double* time_s;
  double* goal_distance;
  double* min_clearance;
};

}  // extern "C"

namespace {

// The rows of a prism in memory.
enum Solid { COS, SIN, OFFSET, HALF = OFFSET + 3, ROUNDING = HALF + 3, SIGN, SOLID_ROWS };

INLINE Doubles rectangle_distance(Doubles beyond_x, Doubles beyond_y) {
  const Doubles none = splat(0.0);
  const Doubles x = greatest(beyond_x, none), y = greatest(beyond_y, none);
  return sqrt(x * x + y * y) + least(greatest(beyond_x, beyond_y), none);
}

INLINE Doubles distance(const double* solids, int64_t count, int64_t lanes, int64_t filled,
                        const Doubles* at) {
  Doubles nearest = splat(__builtin_inf());
  for (int64_t k = 0; k < count; ++k, solids += SOLID_ROWS * lanes) {
    const auto row = [&](int i) { return take(solids + i * lanes, filled); };
    const Doubles c = row(COS), s = row(SIN);
    const Doubles local[3] = {c * at[0] + s * at[1], c * at[1] - s * at[0], at[2]};
    Doubles beyond[3];
    for (int i = 0; i < 3; ++i) beyond[i] = absolute(local[i] - row(OFFSET + i)) - row(HALF + i);
    const Doubles plan = rectangle_distance(beyond[0], beyond[1]) - row(ROUNDING);
    const Doubles signed_distance = rectangle_distance(plan, beyond[2]) * row(SIGN);
    nearest = select(signed_distance > nearest, nearest, signed_distance);
  }
  return nearest;
}

INLINE bool any(const uint8_t* flags, int64_t count) {
  uint8_t found = 0;
  for (int64_t i = 0; i < count; ++i) found |= flags[i];
  return found != 0;
}

// A trial that is no longer running stays as it ended.
INLINE void look(const Trial& trial, const Doubles* position, int64_t step, int64_t first,
                 int64_t lanes, int64_t filled) {
  const int64_t held = filled < DOUBLES ? filled : DOUBLES;
  if (!any(trial.running + first, held)) return;
  const Doubles clearance =
      distance(trial.solids + first, trial.count, lanes, filled, position) - trial.radius;
  Doubles square = {};
  for (int i = 0; i < 3; ++i) {
    const Doubles away = position[i] - take(trial.goal + i * lanes + first, filled);
    square = square + away * away;
  }
  const Doubles remaining = sqrt(square);
  const double now = static_cast<double>(trial.made + step) / trial.per_second;
  for (int64_t i = 0; i < held; ++i) {
    const int64_t lane = first + i;
    if (!trial.running[lane]) continue;
    trial.time_s[lane] = now;
    trial.goal_distance[lane] = remaining[i];
    if (!(clearance[i] >= trial.min_clearance[lane])) trial.min_clearance[lane] = clearance[i];
    if (clearance[i] <= 0) {
      trial.running[lane] = 0;
      trial.crashed[lane] = 1;
    }
  }
}

}  // namespace
