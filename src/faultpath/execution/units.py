"""Units of work: one arm over one block of scenes."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from faultpath.trials.arm import Arm
from faultpath.trials.declared import Library, SceneRef
from faultpath.version import __version__


@dataclass(frozen=True)
class Unit:
    """One arm over the scenes of one block, stored and resumed as a whole."""

    key: str
    """Content hash of everything that decides the result."""
    arm: Arm
    block: int
    scenes: tuple[str, ...]


def blocks(scenes: Sequence[SceneRef], block_size: int) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Group scenes, given by index, into the blocks of their library.

    A block is a place in the library, not a count of selected scenes, so a selection and the
    whole library share the blocks that both hold in full.
    """
    for block, members in groupby(scenes, key=lambda scene: scene.index // block_size):
        yield block, tuple(scene.id for scene in members)


def plan(
    arms: Sequence[Arm],
    scenes: Sequence[SceneRef],
    block_size: int,
    library: Library,
    fingerprint: str,
) -> tuple[Unit, ...]:
    """Return every unit: block by block, in each the arms in order."""
    return tuple(
        Unit(_key(arm, ids, library, fingerprint), arm, block, ids)
        for block, ids in blocks(scenes, block_size)
        for arm in arms
    )


def _key(arm: Arm, scenes: Sequence[str], library: Library, fingerprint: str) -> str:
    content = {
        "faultpath": __version__,
        "system": fingerprint,
        "arm": arm.model_dump(mode="json"),
        "scenes": list(scenes),
        "library": library.content_hash,
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
