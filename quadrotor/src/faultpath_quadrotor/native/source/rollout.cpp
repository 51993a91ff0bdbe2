// Candidate commands rolled through a predictor: the horizon loop of the planner.
//
// The same arithmetic as `predictors/` in torch, which is its reference. A tile of candidates stays
// in cache over all steps, so that memory is touched for commands and results only.
#include "layers.hpp"
#include "rotation.hpp"

namespace {

constexpr int LATENT = 32;
constexpr int EMBEDDING = 16;
constexpr int MOTION = 15;        // velocity, rotation, body rate
constexpr int COMMAND = 4;
constexpr int MOST_FEATURES = 21;
constexpr int MOST_HIDDEN = 128;
constexpr int MOST_OUTPUTS = 16;

enum Kind : int64_t { KINEMATIC, ANCHORED, UNANCHORED };

}  // namespace

extern "C" {

struct Predictor {
  int64_t kind;
  int64_t windy;        // the integrator has its wind term
  int64_t dragging;     // and drag
  Layer embed, gates, candidate, remembered, first, second, last;
  float dt, keep, mean, gravity;
  float linear_bound, angular_bound;
  float drag[3];
  float spread[12];
};

// What a predictor is told, each `[rows, S]`; null where it does not read it.
struct Inputs {
  const float *position, *velocity, *rotation, *rate;
  const float *mass_at_dynamics, *thrust_scale_at_dynamics;
  const float *mass_at_wind_map, *wind;
  const float* mass_at_normalise_thrust;
  const float *mass_at_features, *thrust_scale_at_features;
  const float* code;
};

}  // extern "C"

namespace {

// What is the same for all candidates of a scene.
struct Start {
  float position[3], velocity[3], rotation[9], rate[3];
  float thrust_gain;
  float wind[3];  // over the mass
  float inverse_mass;
  float inverse_weight;
  float shown[2];
  float code[LATENT];
};

INLINE void pick(const float* from, int64_t rows, int64_t s, int64_t scenes, float* to) {
  if (from == nullptr) return;
  for (int64_t i = 0; i < rows; ++i) to[i] = from[i * scenes + s];
}

Start gather(const Inputs& in, int64_t s, int64_t scenes, float gravity) {
  Start start = {};
  pick(in.position, 3, s, scenes, start.position);
  pick(in.velocity, 3, s, scenes, start.velocity);
  pick(in.rotation, 9, s, scenes, start.rotation);
  pick(in.rate, 3, s, scenes, start.rate);
  if (in.mass_at_dynamics != nullptr)
    start.thrust_gain = in.thrust_scale_at_dynamics[s] / in.mass_at_dynamics[s];
  if (in.wind != nullptr) {
    start.inverse_mass = 1.0f / in.mass_at_wind_map[s];
    for (int i = 0; i < 3; ++i) start.wind[i] = in.wind[i * scenes + s] / in.mass_at_wind_map[s];
  }
  if (in.mass_at_normalise_thrust != nullptr)
    start.inverse_weight = 1.0f / (in.mass_at_normalise_thrust[s] * gravity);
  pick(in.mass_at_features, 1, s, scenes, start.shown);
  pick(in.thrust_scale_at_features, 1, s, scenes, start.shown + 1);
  pick(in.code, LATENT, s, scenes, start.code);
  return start;
}

struct Motion {
  Row position[3], velocity[3], rotation[9], rate[3];
};

// Rows in the order in which layers read them, so that no layer's input has to be gathered.
struct Network {
  Row known[EMBEDDING + LATENT + MOST_FEATURES];
  Row hidden[2][MOST_HIDDEN];
  Row gates[2 * LATENT];
  Row memory[LATENT];
  Row outputs[MOST_OUTPUTS];

  Row* embedding() { return known; }
  Row* latent() { return known + EMBEDDING; }
  Row* features() { return known + EMBEDDING + LATENT; }
};

INLINE void observe(const Motion& now, const Row* command, const Start& start, Row* features) {
  for (int i = 0; i < 3; ++i) features[i] = now.velocity[i];
  for (int i = 0; i < 9; ++i) features[3 + i] = now.rotation[i];
  for (int i = 0; i < 3; ++i) features[12 + i] = now.rate[i];
  for (int v = 0; v < WIDE; ++v)
    features[MOTION].part[v] = command[0].part[v] * start.inverse_weight;
  for (int i = 1; i < COMMAND; ++i) features[MOTION + i] = command[i];
}

// One step of the gated unit: latent <- (1 - update) candidate + update latent, in place: what all
// outputs need of the latent is worked out before. Its weights carry the scale that `logistic` wants.
INLINE void remember(const Predictor& model, Network& net) {
  dense(model.gates, net.embedding(), net.gates, logistic);
  dense(model.remembered, net.latent(), net.memory, [](Vector x) { return x; });
  const float* weights = model.candidate.weights;
  for (int first = 0; first < LATENT; first += OUTPUTS) {
    Row sums[OUTPUTS];
    start<OUTPUTS>(weights, sums);
    accumulate<OUTPUTS>(weights + OUTPUTS, net.embedding(), EMBEDDING, sums);
    weights += (1 + EMBEDDING) * OUTPUTS;
    for (int o = 0; o < OUTPUTS; ++o)
      for (int v = 0; v < WIDE; ++v) {
        const int at = first + o;
        const Vector reset = net.gates[at].part[v], update = net.gates[LATENT + at].part[v];
        const Vector half = logistic(fma(reset, net.memory[at].part[v], sums[o].part[v]));
        const Vector fresh = fma(splat(2.0f), half, splat(-1.0f));  // the hyperbolic tangent
        Vector& latent = net.latent()[at].part[v];
        latent = fma(update, latent - fresh, fresh);
      }
  }
}

INLINE void think(const Predictor& model, Network& net) {
  dense(model.embed, net.features() + MOTION, net.embedding(), rectified);
  remember(model, net);
  dense(model.first, net.latent(), net.hidden[0], rectified);
  dense(model.second, net.hidden[0], net.hidden[1], rectified);
  dense(model.last, net.hidden[1], net.outputs, [](Vector x) { return x; });
}

INLINE void integrate(const Predictor& model, const Start& start, const Row* command,
                      const Row* residual, Motion& now) {
  const float dt = model.dt;
  for (int v = 0; v < WIDE; ++v) {
    Vector turn[3];
    for (int i = 0; i < 3; ++i) {
      const Vector target = command[1 + i].part[v];
      const Vector lag = now.rate[i].part[v] - target;
      turn[i] = fma(lag, splat(model.mean), target) * dt;
      now.rate[i].part[v] = fma(lag, splat(model.keep), target);
      if (residual != nullptr) {
        const Vector angular = hyperbolic_tangent(residual[3 + i].part[v]) * model.angular_bound;
        turn[i] = fma(angular, splat(0.5f * dt * dt), turn[i]);
        now.rate[i].part[v] = fma(angular, splat(dt), now.rate[i].part[v]);
      }
    }
    Vector before[9], after[9], by[9];
    for (int i = 0; i < 9; ++i) before[i] = now.rotation[i].part[v];
    rotation_of(turn, by);
    compose(before, by, after);

    Vector pushed[3] = {};
    if (model.windy) {
      Vector air[3];
      for (int i = 0; i < 3; ++i) {
        air[i] = splat(start.wind[i]);
        if (model.dragging) air[i] = fma(now.velocity[i].part[v], splat(-start.inverse_mass), air[i]);
      }
      Vector body[3];
      rotate_back(before, air, body);
      for (int i = 0; i < 3; ++i) body[i] = body[i] * model.drag[i];
      rotate(before, body, pushed);
    }
    const Vector gain = command[0].part[v] * (0.5f * start.thrust_gain);
    for (int i = 0; i < 3; ++i) {
      Vector acceleration = fma(before[3 * i + 2] + after[3 * i + 2], gain, pushed[i]);
      if (i == 2) acceleration = acceleration - model.gravity;
      if (residual != nullptr)
        acceleration = fma(hyperbolic_tangent(residual[i].part[v]), splat(model.linear_bound),
                           acceleration);
      const Vector velocity = now.velocity[i].part[v];
      const Vector ahead = fma(acceleration, splat(dt), velocity);
      now.velocity[i].part[v] = ahead;
      now.position[i].part[v] = fma(velocity + ahead, splat(0.5f * dt), now.position[i].part[v]);
    }
    for (int i = 0; i < 9; ++i) now.rotation[i].part[v] = after[i];
  }
}

INLINE void increment(const Predictor& model, const Row* outputs, Motion& now) {
  for (int v = 0; v < WIDE; ++v) {
    Vector turn[3], before[9], after[9], by[9];
    for (int i = 0; i < 3; ++i) {
      now.position[i].part[v] =
          fma(outputs[i].part[v], splat(model.spread[i]), now.position[i].part[v]);
      now.velocity[i].part[v] =
          fma(outputs[3 + i].part[v], splat(model.spread[3 + i]), now.velocity[i].part[v]);
      now.rate[i].part[v] =
          fma(outputs[6 + i].part[v], splat(model.spread[6 + i]), now.rate[i].part[v]);
      turn[i] = outputs[9 + i].part[v] * model.spread[9 + i];
    }
    for (int i = 0; i < 9; ++i) before[i] = now.rotation[i].part[v];
    rotation_of(turn, by);
    compose(before, by, after);
    for (int i = 0; i < 9; ++i) now.rotation[i].part[v] = after[i];
  }
}

INLINE void begin(const Start& start, Motion& now, Network& net) {
  for (int i = 0; i < 3; ++i) {
    now.position[i] = each(start.position[i]);
    now.velocity[i] = each(start.velocity[i]);
    now.rate[i] = each(start.rate[i]);
  }
  for (int i = 0; i < 9; ++i) now.rotation[i] = each(start.rotation[i]);
  for (int i = 0; i < LATENT; ++i) net.latent()[i] = each(start.code[i]);
  for (int i = 0; i < 2; ++i) net.features()[MOTION + COMMAND + i] = each(start.shown[i]);
}

void roll_tile(const Predictor& model, const Start& start, const float* commands, int64_t steps,
               int64_t scenes, int64_t candidates, int64_t count, float* positions,
               float* velocities, float* ends) {
  Network net;
  Motion now;
  begin(start, now, net);
  const int64_t row = scenes * candidates;           // commands [H, 4, S, K], ends [12, S, K]
  const int64_t axis = scenes * steps * candidates;  // positions [3, S, H, K]
  for (int64_t h = 0; h < steps; ++h) {
    Row command[COMMAND];
    for (int i = 0; i < COMMAND; ++i) take(commands + (h * COMMAND + i) * row, count, command[i]);
    if (model.kind != KINEMATIC) {
      observe(now, command, start, net.features());
      think(model, net);
    }
    if (model.kind == UNANCHORED)
      increment(model, net.outputs, now);
    else
      integrate(model, start, command, model.kind == ANCHORED ? net.outputs : nullptr, now);
    for (int i = 0; i < 3; ++i) {
      give(now.position[i], count, positions + i * axis + h * candidates);
      give(now.velocity[i], count, velocities + i * axis + h * candidates);
    }
  }
  for (int i = 0; i < 9; ++i) give(now.rotation[i], count, ends + i * row);
  for (int i = 0; i < 3; ++i) give(now.rate[i], count, ends + (9 + i) * row);
}

}  // namespace

// `commands` [H, 4, S, K]; `positions` and `velocities` [3, S, H, K]; `ends` [12, S, K]: rotation and
// rate at the end.
extern "C" __attribute__((visibility("default"))) void faultpath_roll(
    const Predictor* model, const Inputs* inputs, const float* commands, int64_t steps,
    int64_t scenes, int64_t candidates, float* positions, float* velocities, float* ends) {
  for (int64_t s = 0; s < scenes; ++s) {
    const Start start = gather(*inputs, s, scenes, model->gravity);
    for (int64_t first = 0; first < candidates; first += TILE) {
      const int64_t at = s * candidates + first;
      const int64_t along = s * steps * candidates + first;
      roll_tile(*model, start, commands + at, steps, scenes, candidates, candidates - first,
                positions + along, velocities + along, ends + at);
    }
  }
}
