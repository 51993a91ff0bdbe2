"""Finds values that parts of a program share: one object in several, or copies of a number."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import FunctionType, MethodType, ModuleType
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import HostArray
from faultpath.core.text import listed

_LARGEST_WALK = 100_000
"""Largest number of objects of one part that are visited, so that a walk ends."""
_LEAVES = (str, bytes, bool, int, float, complex, type, ModuleType, type(None), np.generic)


@dataclass(frozen=True)
class Shared:
    """A value that several parts read: a candidate for a channel with a reader in each part."""

    what: str
    """Class of an object, or name and value of a number."""
    places: tuple[str, ...]
    """Places such as `observer.par`; at least one in each of two parts."""
    alias: bool
    """Whether it is one object; else each part keeps an equal number of the same name."""
    written: tuple[str, ...]
    """Places of its numbers that changed while `run` ran."""

    def __str__(self) -> str:
        sentence = f"{self.what} {'is one object ' if self.alias else ''}at {listed(self.places)}"
        return f"{sentence}; the run wrote {listed(self.written)}" if self.written else sentence


def shared_objects(
    parts: Mapping[str, Any], run: Callable[[], Any] | None = None
) -> tuple[Shared, ...]:
    """Return the values that several parts of a program share, objects first.

    It follows attributes, keys, items, bound methods and closures, but not compiled code. The
    contents of a shared object are listed only if there is a copy outside of it. A number of the
    same name in two parts may have been copied from one source. Zeros, whole numbers and booleans
    are left out.

    Args:
        parts: The objects that read, by name.
        run: Makes one or more steps; the result names the numbers that it changes.
    """
    walks = [Walk(part, root) for part, root in parts.items()]
    reached: dict[int, list[Walk]] = {}
    for walk in walks:
        for key in walk.objects:
            reached.setdefault(key, []).append(walk)
    aliases = {key: walkers for key, walkers in reached.items() if len(walkers) > 1}
    copies: dict[tuple[str, bytes], list[str]] = {}
    within = {place for walk in walks for place in walk.inside(aliases)}
    for walk in walks:
        for place, value in walk.numbers.items():
            if value.any():
                name = place.rpartition(".")[2]
                copies.setdefault((name, value.tobytes()), []).append(place)
    before = {place: value for walk in walks for place, value in walk.numbers.items()}
    after = before
    if run is not None:
        run()
        again = [Walk(part, root) for part, root in parts.items()]
        after = {place: value for walk in again for place, value in walk.numbers.items()}
    changed = [p for p, v in before.items() if p not in after or v.tobytes() != after[p].tobytes()]
    shared: list[Shared] = []
    for key, walkers in aliases.items():
        if all(walk.objects[key].parent in aliases for walk in walkers):
            continue
        places = tuple(walk.objects[key].place for walk in walkers)
        written = tuple(p for p in changed if p == places[0] or p.startswith(f"{places[0]}."))
        shared.append(Shared(type(walkers[0].objects[key].value).__name__, places, True, written))
    for places in copies.values():
        parts_of = {place.partition(".")[0] for place in places}
        if len(parts_of) > 1 and not within.issuperset(places):
            number = f"{places[0].rpartition('.')[2]} = {before[places[0]]}"
            written = tuple(p for p in changed if p in places)
            shared.append(Shared(number, tuple(places), False, written))
    return tuple(shared)


@dataclass(frozen=True)
class _Object:
    value: Any
    place: str
    parent: int


class Walk:
    """Objects and numbers that can be reached from one part, each by its shortest path."""

    def __init__(self, part: str, root: Any) -> None:
        self.objects: dict[int, _Object] = {}
        """Mutable objects by identity; only these matter if they are shared."""
        self.numbers: dict[str, HostArray] = {}
        """Copies of numbers, by place."""
        seen: set[int] = set()
        waiting = deque([_Object(root, part, 0)])
        while waiting and len(seen) < _LARGEST_WALK:
            node = waiting.popleft()
            value = node.value
            if isinstance(value, float | complex | np.floating):
                self.numbers[node.place] = np.array(value)
            if isinstance(value, _LEAVES) or id(value) in seen:
                continue
            key = id(cast("object", value))
            seen.add(key)
            if not isinstance(value, tuple | FunctionType | MethodType):
                self.objects[key] = node
            if isinstance(value, np.ndarray):
                array = cast("HostArray", value)
                if array.dtype.kind in "fc":
                    self.numbers[node.place] = array.copy()
                continue
            waiting += [_Object(f, f"{node.place}.{n}", key) for n, f in _members(value)]

    def inside(self, shared: Mapping[int, Any]) -> Iterator[str]:
        """Yield the places of numbers in shared objects."""
        tops = [node.place for key, node in self.objects.items() if key in shared]
        for place in self.numbers:
            if any(place == top or place.startswith(f"{top}.") for top in tops):
                yield place


def _members(holder: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(holder, MethodType):
        yield "__self__", holder.__self__
    elif isinstance(holder, FunctionType):
        for name, cell in zip(holder.__code__.co_freevars, holder.__closure__ or (), strict=True):
            try:
                yield name, cell.cell_contents
            except ValueError:  # its variable is not set yet
                continue
    elif isinstance(
        holder, dict
    ):  # `dict.items` gets the contents of a stand-in, without a delivery
        for key, value in cast("Any", dict).items(holder):
            yield str(key), value
    elif isinstance(holder, Mapping):
        for key, value in cast("Mapping[Any, Any]", holder).items():
            yield str(key), value
    elif isinstance(holder, list | tuple | set | frozenset | deque):
        for index, value in enumerate(cast("list[Any]", holder)):
            yield str(index), value
    else:
        yield from getattr(holder, "__dict__", {}).items()
        for kind in type(holder).__mro__:
            slots = kind.__dict__.get("__slots__", ())
            for name in (slots,) if isinstance(slots, str) else slots:
                if not name.startswith("__") and hasattr(holder, name):
                    yield name, getattr(holder, name)
