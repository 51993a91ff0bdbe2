"""jax-mppi: its `mppi.command`, compiled by JAX, with a cheap goal and speed cost.

It asks for Python 3.12, for which the torch of our sides may have no build. So it runs in an
environment of its own and reads the problem from the file that `benchmarks.peers.batched` writes.
"""

import os
import platform
from importlib.metadata import version
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax_mppi import mppi

from benchmarks.side import Side, check_same

POSITION, VELOCITY, ROTATION, RATE, CODE = np.split(np.arange(50), (3, 6, 15, 18))


def command() -> Side:
    """`mppi.command` for one scene; what it compiles is compiled before it is timed."""
    with np.load(os.environ["FAULTPATH_PROBLEM"]) as file:
        problem = {name: jnp.asarray(file[name], jnp.float32) for name in file.files}
        candidates, horizon = map(int, file["sizes"])

    def step(state: Any, action: Any) -> Any:
        return _step(problem, state, action)

    def moved(states: Any, actions: Any) -> tuple[Any, Any]:
        states = jax.vmap(step)(states, actions)
        return states, states[:, POSITION].T

    tried = problem["candidates"]
    start = jnp.tile(problem["initial"], (tried.shape[1], 1))
    positions = jax.lax.scan(moved, start, tried)[1].transpose(1, 0, 2)
    check_same(positions, problem["positions"], 1e-3)

    weight, limit = problem["speed"]

    def cost(state: Any, action: Any) -> Any:
        away = jnp.linalg.norm(state[POSITION] - problem["goal"])
        fast = jnp.linalg.norm(state[VELOCITY]) - limit
        return away + weight * jnp.maximum(fast, 0) ** 2

    config, plan = mppi.create(
        nx=50,
        nu=4,
        noise_sigma=jnp.diag(problem["sigma"] ** 2),
        num_samples=candidates,
        horizon=horizon,
        u_min=problem["low"],
        u_max=problem["high"],
        u_init=problem["centre"],
    )
    replan = jax.jit(lambda plan, state: mppi.command(config, plan, state, step, cost))

    def work() -> None:
        nonlocal plan
        _, plan = jax.block_until_ready(replan(plan, problem["initial"]))

    work()
    packages = " with ".join(f"{name} {version(name)}" for name in ("jax-mppi", "jax"))
    return Side(work, note=f"{packages} on Python {platform.python_version()}")


def _step(problem: dict[str, Any], state: Any, command: Any) -> Any:
    """Return the state `[50]` after one interval under `command` `[4]`, as `batched.BatchModel`."""

    def linear(name: str, value: Any) -> Any:
        return problem[f"{name}.weight"] @ value + problem[f"{name}.bias"]

    gain, weight_n, keep, mean, dt = problem["motion"]
    rotation, rate = state[ROTATION].reshape(3, 3), state[RATE]
    action = jnp.concatenate((command[:1] / weight_n, command[1:]))

    embedded, before = jax.nn.relu(linear("embed", action)), state[CODE]
    new = jnp.split(problem["cell.weight_ih"] @ embedded + problem["cell.bias_ih"], 3)
    old = jnp.split(problem["cell.weight_hh"] @ before + problem["cell.bias_hh"], 3)
    reset, update = (jax.nn.sigmoid(a + b) for a, b in zip(new[:2], old[:2], strict=True))
    latent = (1 - update) * jnp.tanh(new[2] + reset * old[2]) + update * before

    hidden = jnp.concatenate((latent, state[3:18], action))
    for name in ("head.0", "head.2"):
        hidden = jax.nn.relu(linear(name, hidden))
    residual = jnp.tanh(linear("head.4", hidden))
    pushed, turned = residual[:3] * problem["bounds"][0], residual[3:] * problem["bounds"][1]

    target = command[1:]
    lag = rate - target
    ahead = rotation @ _exponential((target + mean * lag) * dt + (0.5 * dt * dt) * turned)
    thrust = (rotation[:, 2] + ahead[:, 2]) * (0.5 * gain * command[0])
    velocity = state[VELOCITY] + dt * (thrust + problem["constant"] + pushed)
    position = state[POSITION] + (0.5 * dt) * (state[VELOCITY] + velocity)
    after = target + keep * lag + dt * turned
    return jnp.concatenate((position, velocity, ahead.ravel(), after, latent))


def _exponential(turn: Any) -> Any:
    """Return the rotation `[3, 3]` by `turn` `[3]`, rad."""
    angle = jnp.maximum(jnp.linalg.norm(turn), 1e-9)
    x, y, z = turn / angle
    cross = jnp.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return jnp.eye(3) + jnp.sin(angle) * cross + (1 - jnp.cos(angle)) * (cross @ cross)
