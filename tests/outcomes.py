"""Outcomes and trials made up, for tests of what follows from them."""

from typing import Any

from faultpath.run.trials import Trial
from faultpath.system import Outcome, Status


def outcome(
    scene: int | str, status: Status = Status.SUCCESS, seed: int = 0, **fields: Any
) -> Outcome:
    """Return an outcome that pairs with any other of its scene and seed; a number names a scene."""
    if isinstance(scene, int):
        scene = f"s{scene:03d}"
    usual: dict[str, Any] = {"initial_hash": f"i-{scene}", "disturbance_hash": f"d-{scene}"}
    usual["planner_noise_hash"] = f"n-{scene}-{seed}"
    usual["time_s"] = 0.0 if status is Status.FAILED else 5.0
    return Outcome(scene=scene, status=status, **usual | fields)


def trial(
    variant: str,
    condition: str,
    index: int,
    status: Status = Status.SUCCESS,
    *,
    seed: int = 0,
    topology: str = "",
    scene: str | None = None,
    **fields: Any,
) -> Trial:
    """Return a trial with such an outcome; its scene is named by its index unless it has a name."""
    ended = outcome(index if scene is None else scene, status, seed, **fields)
    return Trial(variant, condition, seed, index, topology, ended)
