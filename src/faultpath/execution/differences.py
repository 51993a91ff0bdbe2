"""How a second flight differs from the first, and what that means for a reader of the results."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from faultpath.execution.attempt import Died, Done, Raised, Reply, Wrong
from faultpath.record.provenance import FlownAgain
from faultpath.trials.outcome import Outcome

_NUMBERS = ("time_s", "struck_steps", "altered_steps")
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
    pairs = _unlike(first, second)
    if not pairs:
        return ""
    scene = pairs[0][0].scene
    ends = sum(one.status is not two.status for one, two in pairs)
    parts = [f"{ends} end otherwise" if ends else "none ends otherwise"]
    numbers = (_NUMBERS[0], *dict.fromkeys(n for a, _ in pairs for n in a.metrics), *_NUMBERS[1:])
    gaps = {name: max(_gap(a, b, name) for a, b in pairs) for name in (*numbers, *_HASHES)}
    parts += [f"{name} by up to {gaps[name]:.3g}" for name in numbers if gaps[name]]
    parts += [f"{name} too" for name in _HASHES if gaps[name]]
    return f"differs in {len(pairs)} of {len(first)}, {scene!r} for one ({', '.join(parts)})"


def differing(first: Sequence[Outcome], reply: Reply) -> tuple[str, ...]:
    """Return the scenes of which a second flight gave something else, or nothing."""
    if not isinstance(reply, Done):
        return tuple(outcome.scene for outcome in first)
    return tuple(one.scene for one, _ in _unlike(first, reply.outcomes))


def _unlike(first: Sequence[Outcome], second: Sequence[Outcome]) -> list[tuple[Outcome, Outcome]]:
    return [(one, two) for one, two in zip(first, second, strict=True) if not _same(one, two)]


def _gap(one: Outcome, two: Outcome, name: str) -> float:
    a, b = (o.metrics[name] if name in o.metrics else getattr(o, name, None) for o in (one, two))
    if a == b:
        return 0.0
    if isinstance(a, int | float) and isinstance(b, int | float):
        return abs(a - b)
    return float("inf")  # one of them has none, or they are hashes


def _same(one: Outcome, two: Outcome) -> bool:
    if one.status is not two.status or one.metrics != two.metrics:
        return False
    if any(_gap(one, two, name) for name in (*_NUMBERS, *_HASHES)):
        return False
    if one.trace is None or two.trace is None:
        return one.trace is two.trace
    return np.array_equal(one.trace, two.trace)


def findings(flown: Iterable[FlownAgain]) -> tuple[str, ...]:
    """Return what second flights found, a sentence or two each; nothing where all were the same.

    What does not repeat differs in every flight: no other cause is named beside it.
    """
    flown = tuple(flown)
    writes = tuple(_writes(each) for each in flown if each.wrote)
    chance = tuple(_chance(each) for each in flown if each.differs and whole(each))
    return (*writes, *(chance or (*_crowded(flown), *_shared(flown))))


def _writes(shown: FlownAgain) -> str:
    return (
        f"A consumer writes into its reading, seen with {_where(shown)}: {shown.wrote}. Without a "
        "fault that changes what others read, and with one it does not."
    )


def _chance(shown: FlownAgain) -> str:
    return (
        f"Results do not repeat: {_where(shown)}, flown twice over {_scenes(shown.unit_scenes)}, "
        f"{shown.differs}. Effects may be chance: look for random numbers that are not of "
        "faultpath.streams, for threads, and for what is kept from one call of run() to the next."
    )


def _crowded(flown: Sequence[FlownAgain]) -> Iterator[str]:
    """Name units of which a part differs while the whole does not."""
    same = {each.unit for each in flown if each.why == "repeat" and not each.differs}
    for part in flown:
        if part.why not in ("sample", "alone") or not part.differs or part.unit not in same:
            continue
        if len(part.scenes) == 1:
            who = f"scene {part.scenes[0]!r} of {_where(part)}, flown alone"
        else:
            who = f"{len(part.scenes)} scenes of {_where(part)}, flown without the others"
        yield (
            f"Results depend on the block: {who}, {part.differs} from the flight among "
            f"{part.unit_scenes} scenes; all of them flown again came out the same. Look for what "
            "scenes of one call of run() share."
        )


def _shared(flown: Sequence[FlownAgain]) -> Iterator[str]:
    """Name units of which a scene differs with guarded readings, and without them does not."""
    same = {(each.unit, each.scenes) for each in flown if each.why == "alone" and not each.differs}
    for guarded in flown:
        if guarded.why == "guarded" and guarded.differs and (guarded.unit, guarded.scenes) in same:
            yield (
                f"Results depend on who else holds a reading: scene {guarded.scenes[0]!r} of "
                f"{_where(guarded)}, flown with a copy of every reading for each consumer, "
                f"{guarded.differs}; with the readings themselves it came out the same. Look for "
                "what is written into an array after it was delivered; a fault hides it."
            )


def whole(shown: FlownAgain) -> bool:
    """Return whether a unit was flown again just as it was the first time."""
    return shown.why != "guarded" and len(shown.scenes) == shown.unit_scenes


def _where(shown: FlownAgain) -> str:
    return f"'{shown.variant}' under {shown.faults}, seed {shown.seed}"


def _scenes(count: int) -> str:
    return f"{count} scene{'s' * (count != 1)}"
