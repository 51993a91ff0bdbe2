"""How the outcomes of a second flight differ from those of the first."""

from collections.abc import Sequence

import numpy as np

from faultpath.execution.attempt import Died, Done, Raised, Reply, Wrong
from faultpath.trials.outcome import Outcome

_NUMBERS = ("time_s", "terminal_distance_m", "min_clearance_m", "struck_steps", "altered_steps")
_HASHES = ("initial_hash", "disturbance_hash", "planner_noise_hash")


def difference(first: Sequence[Outcome], reply: Reply) -> str:
    """Say how a second flight of the same scenes differs; empty where it is the same to the bit."""
    match reply:
        case Done():
            second = reply.outcomes
        case Raised():
            return f"failed the second time ({reply.error}), which differs"
        case Wrong():
            return f"failed the second time ({reply.error}), which differs"
        case Died():
            return f"could not be flown again ({reply.how}), which differs"
    pairs = [(one, two) for one, two in zip(first, second, strict=True) if not _same(one, two)]
    if not pairs:
        return ""
    scene = pairs[0][0].scene
    ends = sum(one.status is not two.status for one, two in pairs)
    parts = [f"{ends} end otherwise" if ends else "none ends otherwise"]
    gaps = {name: max(_gap(a, b, name) for a, b in pairs) for name in (*_NUMBERS, *_HASHES)}
    parts += [f"{name} by up to {gaps[name]:.3g}" for name in _NUMBERS if gaps[name]]
    parts += [f"{name} too" for name in _HASHES if gaps[name]]
    return f"differs in {len(pairs)} of {len(first)}, {scene!r} for one ({', '.join(parts)})"


def _gap(one: Outcome, two: Outcome, name: str) -> float:
    a, b = getattr(one, name), getattr(two, name)
    if a == b:
        return 0.0
    if isinstance(a, int | float) and isinstance(b, int | float):
        return abs(a - b)
    return float("inf")  # one of them has none, or they are hashes


def _same(one: Outcome, two: Outcome) -> bool:
    if one.status is not two.status or any(_gap(one, two, n) for n in (*_NUMBERS, *_HASHES)):
        return False
    if one.trace is None or two.trace is None:
        return one.trace is two.trace
    return np.array_equal(one.trace, two.trace)
