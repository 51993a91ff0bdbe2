"""Random streams keyed by their purpose, never drawn from a shared generator.

A draw is addressed by (purpose, scene id, seed, step). Two trials that share these four get the
same numbers whatever else runs, which makes two treatments in a scene a pair.
"""

import hashlib
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.random.bit_generator import ISpawnableSeedSequence
from typing_extensions import override


@lru_cache(maxsize=65536)
def key(purpose: str, scene: str, seed: int) -> int:
    """Return the 128-bit Philox key of an address, for code that computes the stream itself."""
    digest = hashlib.blake2b(f"{purpose}\x1f{scene}\x1f{seed}".encode(), digest_size=16)
    return int.from_bytes(digest.digest(), "little")


def words(key: int) -> np.ndarray:
    """Return a 128-bit key as two words of 64 bits, low first, which is how Philox takes it."""
    return np.array([key & 0xFFFFFFFFFFFFFFFF, key >> 64], dtype=np.uint64)


def generator(purpose: str, scene: str, seed: int, step: int = 0) -> np.random.Generator:
    """Return the generator of one address; the same address always gives the same numbers.

    Philox is counter based: the address (purpose, scene, seed) is its 128-bit key and the step
    occupies the high word of its counter, so streams of different steps cannot overlap.
    """
    counter = np.array([0, 0, 0, step], dtype=np.uint64)
    source: Any = _Key(key(purpose, scene, seed), step)
    return np.random.Generator(np.random.Philox(source, counter=counter))


class _Key(ISpawnableSeedSequence):
    """A Philox key passed as a seed.

    If NumPy is given a key it draws a seed from the operating system as well and never uses it,
    which takes longer than everything else.
    """

    def __init__(self, key: int, step: int) -> None:
        self._key, self._step = key, step
        self._seeds: np.random.SeedSequence | None = None

    @override
    def generate_state(self, n_words: int, dtype: Any = np.uint32) -> np.ndarray:
        """Return the key as Philox takes it."""
        del n_words, dtype
        return words(self._key)

    @override
    def spawn(self, n_children: int) -> list[Any]:
        """Return seeds for further generators, which follow from the address too."""
        self._seeds = self._seeds or np.random.SeedSequence([self._key, self._step])
        return list(self._seeds.spawn(n_children))


def generators(
    purpose: str, scenes: Iterable[str], seed: int, step: int = 0
) -> Iterator[np.random.Generator]:
    """Yield `generator(purpose, scene, seed, step)` for each scene, much faster for many.

    One object moves from address to address, so each must be used before the next is taken.
    """
    bits = np.random.Philox(key=0, counter=np.array([0, 0, 0, step], dtype=np.uint64))
    stream, fresh = np.random.Generator(bits), bits.state
    for scene in scenes:
        fresh["state"]["key"] = words(key(purpose, scene, seed))
        bits.state = fresh
        yield stream
