"""Declarations of a system, checked when made: variants, libraries of scenes, floor plans."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from numbers import Integral
from typing import Any, cast

from faultpath.core.errors import SystemMistake
from faultpath.core.text import has_control_characters, one_line, represented

_LONGEST_NAME = 200
_LARGEST_INDEX = 2**63 - 1
"""Largest index that the tables hold."""


def check_name(what: str, name: Any) -> None:
    """Raise `SystemMistake` for a name that does not suit tables, files and the terminal."""
    if not isinstance(name, str):
        raise SystemMistake(f"{what} is {shown(name)}: it must be text")
    if not name:
        raise SystemMistake(f"{what} is empty: give it a name")
    if len(name) > _LONGEST_NAME:
        raise SystemMistake(
            f"{what} has {len(name)} characters: a name has at most {_LONGEST_NAME}"
        )
    if has_control_characters(name):
        raise SystemMistake(f"{what} is {shown(name)}: a name holds no control characters")


@dataclass(frozen=True)
class Variant:
    """One way to wire the system: which source feeds each channel, and which readers exist."""

    name: str
    description: str
    readers: frozenset[str]
    """Readers of this variant; a fault cannot reach any other."""
    bindings: Mapping[str, str] = field(default_factory=dict[str, str])
    """Channel to source, where it is not the channel's first source."""
    privileged: frozenset[str] = frozenset()
    """Privileged sources that this variant may read."""

    def __post_init__(self) -> None:
        """Raise `SystemMistake` for parts of another type."""
        check_name("the name of a variant", self.name)
        label = f"variant '{self.name}'"
        for what in ("readers", "privileged"):
            for name in _items(f"{label}: {what}", getattr(self, what)):
                check_name(f"{label}: one of {what}", name)
        bindings: Any = self.bindings
        if not isinstance(bindings, Mapping):
            raise SystemMistake(f"{label}: bindings is {shown(bindings)}: map channels to sources")


@dataclass(frozen=True)
class SceneRef:
    """A scene as the engine knows it: its name, its index in the library and its kind."""

    id: str
    index: int
    topology: str = ""

    def __post_init__(self) -> None:
        """Raise `SystemMistake` for values that no table could hold."""
        check_name("the id of a scene", self.id)
        index: Any = self.index
        if not isinstance(index, Integral) or not 0 <= int(index) <= _LARGEST_INDEX:
            raise SystemMistake(
                f"scene '{self.id}' has the index {shown(index)}: give its position in the "
                "library, a whole number from 0 to 2^63 - 1"
            )
        if self.topology != "":
            check_name(f"the topology of scene '{self.id}'", self.topology)


@dataclass(frozen=True)
class Library:
    """A frozen set of scenes."""

    name: str
    scenes: tuple[SceneRef, ...]
    content_hash: str

    def __post_init__(self) -> None:
        """Raise `SystemMistake` for scenes of another type, or that share a name or an index."""
        check_name("the name of a library", self.name)
        label = f"library '{self.name}'"
        check_name(f"the content hash of {label}", self.content_hash)
        seen: set[str] = set()
        ids: dict[int, str] = {}
        for scene in _items(f"{label}: scenes", self.scenes):
            if not isinstance(scene, SceneRef):
                raise SystemMistake(f"{label} holds {shown(scene)}: every scene is a SceneRef")
            if scene.id in seen:
                raise SystemMistake(f"{label} holds scene '{scene.id}' twice: name each scene once")
            seen.add(scene.id)
            if (other := ids.setdefault(scene.index, scene.id)) != scene.id:
                raise SystemMistake(
                    f"{label} gives scenes '{other}' and '{scene.id}' the index {scene.index}: "
                    "number its scenes 0, 1, 2, ..."
                )
        if not seen:
            raise SystemMistake(f"{label} holds no scene: give it at least one")


def _items(what: str, members: Any) -> Iterable[Any]:
    if isinstance(members, (str, bytes)) or not isinstance(members, Iterable):
        raise SystemMistake(f"{what} is {shown(members)}: give several, as a tuple or a set")
    return cast("Iterable[Any]", members)


def shown(value: Any) -> str:
    """Return a wrong value in one line, short enough for a message."""
    text = one_line(represented(value))
    return text if len(text) <= 80 else f"{text[:80]}…"


@dataclass(frozen=True)
class Prism:
    """A vertical prism: corners `(x, y)` in order, from `bottom` to `top`, metres."""

    corners: tuple[tuple[float, float], ...]
    bottom: float
    top: float


@dataclass(frozen=True)
class Pillar:
    """A vertical cylinder, metres."""

    x: float
    y: float
    radius: float
    bottom: float
    top: float


@dataclass(frozen=True)
class FloorPlan:
    """A scene seen from above: `low` and `high` are the corners of the free volume, metres."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    prisms: tuple[Prism, ...]
    pillars: tuple[Pillar, ...]
    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    title: str
