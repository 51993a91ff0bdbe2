// Vehicles flown for many plant steps under one command: the inner loop of the world.
//
// A vector of vehicles stays in cache over all steps, so that memory is touched for winds, and for
// states at both ends only.
#include "plant.hpp"
#include "plant_contact.hpp"

extern "C" {

// Vehicles before the first step, rows of `lanes`.
struct Before {
  const double* position;
  const double* velocity;
  const double* rotation;
  const double* rate;
  const double* thrust;
};

}  // extern "C"

namespace {

INLINE void take_rows(const double* from, int rows, int64_t lanes, int64_t filled, Doubles* to) {
  for (int i = 0; i < rows; ++i) to[i] = take(from + i * lanes, filled);
}

void fly(const Law& law, const double* crafts, const Before& before, const double* commands,
         const double* winds, int64_t steps, int64_t lanes, int64_t first, const Trial* trial,
         double* ends) {
  const int64_t filled = lanes - first;
  Airframe craft;
  take_rows(crafts + first, AIRFRAME_ROWS, lanes, filled, reinterpret_cast<Doubles*>(&craft));
  Body body;
  take_rows(before.position + first, 3, lanes, filled, body.position);
  take_rows(before.velocity + first, 3, lanes, filled, body.velocity);
  take_rows(before.rotation + first, 9, lanes, filled, body.rotation);
  take_rows(before.rate + first, 3, lanes, filled, body.rate);
  take_rows(before.thrust + first, MOTORS, lanes, filled, body.thrust);
  Doubles command[4];
  take_rows(commands + first, 4, lanes, filled, command);
  const Wanted wanted = limited(law, command);

  for (int64_t n = 0; n < steps; ++n) {
    Doubles wind[3];
    take_rows(winds + 3 * n * lanes + first, 3, lanes, filled, wind);
    step(law, craft, wanted, wind, body);
    if (trial != nullptr && (n + 1) % trial->every == 0)
      look(*trial, body.position, n + 1, first, lanes, filled);
  }
  const Doubles* rows = reinterpret_cast<const Doubles*>(&body);
  for (int i = 0; i < BODY_ROWS; ++i) give(rows[i], filled, ends + i * lanes + first);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void faultpath_fly(
    const Law* law, const double* crafts, const Before* before, const double* command,
    const double* winds, int64_t steps, int64_t lanes, const Trial* trial, double* ends) {
  for (int64_t first = 0; first < lanes; first += DOUBLES)
    fly(*law, crafts, *before, command, winds, steps, lanes, first, trial, ends);
}
