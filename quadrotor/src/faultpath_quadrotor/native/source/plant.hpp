// One step of the quadrotor plant for a vector of vehicles; `plant/torch_plant.py` is its reference.
#pragma once

#include "rotation.hpp"

namespace {

constexpr int MOTORS = 4;

// What a vehicle carries from step to step, in the order of the rows in memory.
struct Body {
  Doubles position[3], velocity[3], rotation[9], rate[3], thrust[MOTORS];
};
constexpr int BODY_ROWS = sizeof(Body) / sizeof(Doubles);

// What the vehicle is, in the order of the rows in memory.
struct Airframe {
  Doubles kick;        // velocity in half a step per newton and unit of the attitudes' sum
  Doubles torque[3];   // angular acceleration about each axis per newton of a motor
  Doubles mixing[3];   // newtons of a motor per wanted angular acceleration
  Doubles left_end;    // of the gap to a motor's command, at the end of a step
  Doubles left_mean;   // and on average over it
  Doubles coupling[3]; // gyroscopic
  Doubles relaxed[3];  // a quarter of the air-relative velocity that drag takes in a step
};
constexpr int AIRFRAME_ROWS = sizeof(Airframe) / sizeof(Doubles);

}  // namespace

extern "C" {

// What all vehicles share.
struct Law {
  double dt;
  double gravity_kick;  // velocity along z that gravity adds in half a step
  double gain[3];
  double rate_limit[3];
  double collective_limit;
  double motor_limit;
};

}  // extern "C"

namespace {

// A command within the vehicle's limits, as the rate loop wants it.
struct Wanted {
  Doubles level;      // of each motor, N
  Doubles target[3];  // gain times the rate
};

INLINE Doubles clipped(Doubles x, Doubles low, Doubles high) {
  return least(greatest(x, low), high);
}

INLINE Wanted limited(const Law& law, const Doubles* command) {
  Wanted wanted;
  wanted.level = 0.25 * clipped(command[0], splat(0.0), splat(law.collective_limit));
  for (int i = 0; i < 3; ++i)
    wanted.target[i] = law.gain[i] * clipped(command[1 + i], splat(-law.rate_limit[i]),
                                             splat(law.rate_limit[i]));
  return wanted;
}

INLINE void gyroscopic(const Doubles* coupling, const Doubles* rate, Doubles* acceleration) {
  acceleration[0] = rate[1] * rate[2] * coupling[0];
  acceleration[1] = rate[2] * rate[0] * coupling[1];
  acceleration[2] = rate[0] * rate[1] * coupling[2];
}

// The rate loop: what each motor is told. Yaw gives way before the others do.
INLINE void motor_commands(const Law& law, const Airframe& craft, const Wanted& wanted,
                           const Doubles* rate, const Doubles* free, Doubles* motors) {
  Doubles stroke[3];
  for (int i = 0; i < 3; ++i)
    stroke[i] = craft.mixing[i] *
                (fma(splat(-law.gain[i]), rate[i], wanted.target[i]) - free[i]);
  const Doubles left = wanted.level + stroke[0], right = wanted.level - stroke[0];
  motors[0] = left - stroke[1];
  motors[1] = left + stroke[1];
  motors[2] = right + stroke[1];
  motors[3] = right - stroke[1];
  const Doubles limit = splat(law.motor_limit);
  Doubles room = limit;
  for (int i = 0; i < MOTORS; ++i) {
    motors[i] = clipped(motors[i], splat(0.0), limit);
    room = least(least(motors[i], limit - motors[i]), room);
  }
  const Doubles yaw = clipped(stroke[2], -room, room);
  for (int i = 0; i < MOTORS; ++i) motors[i] = i % 2 == 0 ? motors[i] + yaw : motors[i] - yaw;
}

// Moves the motors on; returns their thrust along z and the torque accelerations, mean of the step.
INLINE Doubles respond(const Airframe& craft, const Doubles* told, Doubles* thrust,
                       Doubles* torque) {
  Doubles mean[MOTORS];
  for (int i = 0; i < MOTORS; ++i) {
    const Doubles gap = thrust[i] - told[i];
    mean[i] = fma(craft.left_mean, gap, told[i]);
    thrust[i] = fma(craft.left_end, gap, told[i]);
  }
  const Doubles left = mean[0] + mean[1], right = mean[2] + mean[3];
  torque[0] = craft.torque[0] * (left - right);
  torque[1] = craft.torque[1] * ((mean[1] + mean[2]) - (mean[0] + mean[3]));
  torque[2] = craft.torque[2] * ((mean[0] + mean[2]) - (mean[1] + mean[3]));
  return craft.kick * (left + right);
}

INLINE void step(const Law& law, const Airframe& craft, const Wanted& wanted, const Doubles* wind,
                 Body& body) {
  Doubles free[3], told[MOTORS], torque[3], middle[3], turn[3];
  gyroscopic(craft.coupling, body.rate, free);
  motor_commands(law, craft, wanted, body.rate, free, told);
  const Doubles lift = respond(craft, told, body.thrust, torque);

  for (int i = 0; i < 3; ++i)
    middle[i] = fma(torque[i] + free[i], splat(0.5 * law.dt), body.rate[i]);
  gyroscopic(craft.coupling, middle, free);
  for (int i = 0; i < 3; ++i) {
    body.rate[i] = fma(torque[i] + free[i], splat(law.dt), body.rate[i]);
    turn[i] = middle[i] * law.dt;
  }
  Doubles by[9], after[9], both[9];
  rotation_of(turn, by);
  compose(body.rotation, by, after);
  for (int i = 0; i < 9; ++i) {
    both[i] = body.rotation[i] + after[i];
    body.rotation[i] = after[i];
  }

  Doubles kick[3], air[3], along[3], drag[3];
  for (int i = 0; i < 3; ++i) {
    kick[i] = both[3 * i + 2] * lift;
    if (i == 2) kick[i] = kick[i] + law.gravity_kick;
    air[i] = wind[i] - (body.velocity[i] + kick[i]);
  }
  rotate_back(both, air, along);
  for (int i = 0; i < 3; ++i) along[i] = along[i] * craft.relaxed[i];
  rotate(both, along, drag);
  for (int i = 0; i < 3; ++i) {
    const Doubles before = body.velocity[i];
    body.velocity[i] = before + kick[i] + drag[i] + kick[i];
    body.position[i] =
        fma(before + body.velocity[i], splat(0.5 * law.dt), body.position[i]);
  }
}

}  // namespace
