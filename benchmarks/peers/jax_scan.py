"""WM-A's rollout written by hand in JAX: one jitted `lax.scan` over the horizon.

The kinematics work on single components `[K]`, which the compiler fuses; features are `[F, K]`.
"""

from collections.abc import Sequence
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks import planning
from benchmarks.peers import rows
from benchmarks.side import Side, check_same
from faultpath.quadrotor.predictors import anchored
from faultpath.quadrotor.vehicle import CONTROL_DT_S

Array = jax.Array
DT = CONTROL_DT_S


def scan() -> Side:
    """The rollout of one scene's 512 candidates: positions and velocities of every step."""
    state = jnp.asarray(rows.initial().numpy())
    start, code = state[: rows.CODE.start], state[rows.CODE]
    commands = jnp.asarray(planning.commands()[:, :, 0].numpy())
    rollout = jax.jit(_rollout(rows.RowsModel()))
    positions = np.asarray(rollout(start, code, commands)[0])[:, :, : planning.CHECKED]
    check_same(positions.swapaxes(0, 1).ravel(), planning.positions(), 1e-3)
    return Side(lambda: jax.block_until_ready(rollout(start, code, commands)))


def _rollout(model: rows.RowsModel):
    def layer(linear) -> tuple[Array, Array]:
        weight = jnp.asarray(linear.weight.detach().numpy())
        bias = jnp.asarray(linear.bias.detach().numpy())
        return weight, bias[:, None]

    cell = model.cell
    layers = [layer(part) for part in (model.embed, *(model.head[i] for i in (0, 2, 4)))]
    from_input = layer(SimpleNamespace(weight=cell.weight_ih, bias=cell.bias_ih))
    from_latent = layer(SimpleNamespace(weight=cell.weight_hh, bias=cell.bias_hh))
    constant = [float(value) for value in model.constant]
    gain, weight_n = model.gain, model.weight_n

    def product(affine: tuple[Array, Array], x: Array) -> Array:
        weight, bias = affine
        return weight @ x + bias

    def network(latent: Array, motion: Sequence[Array], action: Sequence[Array]):
        acted = jnp.stack(action, 0)
        embedded = jax.nn.relu(product(layers[0], acted))
        ri, zi, ni = jnp.split(product(from_input, embedded), 3, 0)
        rh, zh, nh = jnp.split(product(from_latent, latent), 3, 0)
        reset, update = jax.nn.sigmoid(ri + rh), jax.nn.sigmoid(zi + zh)
        candidate = jnp.tanh(ni + reset * nh)
        latent = candidate + update * (latent - candidate)
        hidden = jnp.concatenate((latent, jnp.stack([*motion, *action], 0)), 0)
        hidden = jax.nn.relu(product(layers[1], hidden))
        outputs = jnp.tanh(product(layers[3], jax.nn.relu(product(layers[2], hidden))))
        return latent, [jnp.take(outputs, i, 0) for i in range(6)]

    def step(carry, command: Array):
        p, v, r, w, latent = carry
        action = [command[0] / weight_n, *command[1:]]
        latent, outputs = network(latent, [*v, *r, *w], action)
        linear = [anchored.LINEAR_BOUND_MPS2 * value for value in outputs[:3]]
        angular = [anchored.ANGULAR_BOUND_RADPS2 * value for value in outputs[3:]]
        lag = [now - wanted for now, wanted in zip(w, command[1:], strict=True)]
        turn = [
            (command[1 + i] + rows.MEAN * lag[i]) * DT + 0.5 * DT * DT * angular[i]
            for i in range(3)
        ]
        ahead = _compose(r, _exponential(*turn))
        thrust = 0.5 * gain * command[0]
        speed = [
            v[i] + DT * ((r[3 * i + 2] + ahead[3 * i + 2]) * thrust + constant[i] + linear[i])
            for i in range(3)
        ]
        place = [p[i] + 0.5 * DT * (v[i] + speed[i]) for i in range(3)]
        rate = [command[1 + i] + rows.KEEP * lag[i] + DT * angular[i] for i in range(3)]
        return (place, speed, ahead, rate, latent), (jnp.stack(place), jnp.stack(speed))

    def run(start: Array, code: Array, commands: Array):
        count = commands.shape[-1]
        spread = [jnp.broadcast_to(value, (count,)) for value in start]
        latent = jnp.broadcast_to(code[:, None], (len(code), count))
        carry = (spread[0:3], spread[3:6], spread[6:15], spread[15:18], latent)
        return jax.lax.scan(step, carry, commands)[1]

    return run


def _compose(a: Sequence[Array], b: Sequence[Array]) -> list[Array]:
    return [
        sum(a[3 * i + k] * b[3 * k + j] for k in range(1, 3)) + a[3 * i] * b[j]
        for i in range(3)
        for j in range(3)
    ]


def _exponential(x: Array, y: Array, z: Array) -> list[Array]:
    angle = jnp.sqrt(x * x + y * y + z * z + 1e-24)
    s, c = jnp.sin(0.5 * angle), jnp.cos(0.5 * angle)
    x, y, z = (part * (s / angle) for part in (x, y, z))
    cos = c * c - s * s
    return [
        cos + 2 * x * x, 2 * (x * y - c * z), 2 * (x * z + c * y),
        2 * (x * y + c * z), cos + 2 * y * y, 2 * (y * z - c * x),
        2 * (x * z - c * y), 2 * (y * z + c * x), cos + 2 * z * z,
    ]  # fmt: skip
