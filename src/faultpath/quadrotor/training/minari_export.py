"""A pool as a Minari dataset, for those whose tools read that format (extra `minari`)."""

from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from faultpath.errors import UserError
from faultpath.quadrotor.training.flight import EPISODE_STEPS
from faultpath.quadrotor.training.pool import Pool, read_pool
from faultpath.quadrotor.training.recorded import COMPONENTS, SIGNALS
from faultpath.quadrotor.vehicle import COLLECTIVE_MAX_N, RATE_LIMIT_RADPS

_OBSERVED = ("position", "velocity", "rotation", "rate")


def export_minari(pool_path: Path, dataset_id: str) -> int:
    """Write the pool as the local Minari dataset `dataset_id` and return its number of episodes.

    Observations are position, velocity, rotation (row by row) and body rate, float32 [N + 1, 18];
    actions are commands, [N, 4]; rewards are zero, as nothing is to be achieved. The vehicle and
    the episode's index stand in the options, the wind and the motors' thrust in the infos. An
    episode that diverged is terminated, any other is truncated.

    Raises `UserError` when Minari is not installed, when it refuses the dataset (there may be one
    of this name), or when the pool cannot be read.
    """
    minari, collector, spaces = (
        _import(name) for name in ("minari", "minari.data_collector", "gymnasium.spaces")
    )
    pool = read_pool(pool_path)
    flown = [episode for episode, steps in enumerate(pool.steps.tolist()) if steps]
    limits = np.array((COLLECTIVE_MAX_N, *RATE_LIMIT_RADPS), np.float32)
    least = np.array((0.0, *(-limit for limit in RATE_LIMIT_RADPS)), np.float32)
    try:
        minari.create_dataset_from_buffers(
            dataset_id=dataset_id,
            buffer=[collector.EpisodeBuffer(**_episode(pool, episode)) for episode in flown],
            observation_space=spaces.Box(-np.inf, np.inf, (18,), np.float32),
            action_space=spaces.Box(least, limits, dtype=np.float32),
            algorithm_name="waypoint controller with perturbed commands",
            description=f"faultpath pool '{pool.name}', rows {pool.provenance.rows_sha256}",
        )
    except ValueError as error:
        raise UserError(
            f"Minari refused the dataset '{dataset_id}' ({error}): choose another name or version."
        ) from error
    return len(flown)


def _import(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError as error:
        raise UserError(
            "Minari is not installed, and the export needs it: "
            "install faultpath with the extra 'minari'."
        ) from error


def _episode(pool: Pool, episode: int) -> dict[str, Any]:
    """Return the fields of Minari's `EpisodeBuffer`, time first as it has it."""
    first, steps = int(pool.first_row[episode]), int(pool.steps[episode])

    def signal(name: str, count: int) -> np.ndarray:
        channels = [COMPONENTS.index(component) for component in SIGNALS[name]]
        return pool.values[channels, first : first + count].T

    diverged = steps < EPISODE_STEPS
    last = np.arange(steps) == steps - 1
    return {
        "options": {
            "episode": episode,
            "vehicle": {
                name: values[..., episode].tolist() for name, values in pool.vehicles.items()
            },
        },
        "observations": np.concatenate([signal(name, steps + 1) for name in _OBSERVED], axis=1),
        "actions": signal("command", steps),
        "rewards": np.zeros(steps, np.float32),
        "terminations": last & diverged,
        "truncations": last & (not diverged),
        "infos": {name: signal(name, steps + 1) for name in ("wind_mps", "motor_thrust_n")},
    }
