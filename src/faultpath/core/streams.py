"""Random streams keyed by what they are for, never drawn from a shared generator.

A draw is addressed by (purpose, scene id, seed, step). Two trials that share those four get the
same numbers whatever else runs beside them, which is what makes arms of a contrast paired.
"""

import hashlib
from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np


@lru_cache(maxsize=65536)
def key(purpose: str, scene: str, seed: int) -> int:
    """Return the 128-bit Philox key of an address, for whoever computes the stream himself."""
    digest = hashlib.blake2b(f"{purpose}\x1f{scene}\x1f{seed}".encode(), digest_size=16)
    return int.from_bytes(digest.digest(), "little")


def words(key: int) -> np.ndarray:
    """Return a 128-bit key as Philox takes it, two words of 64 bits, low first."""
    return np.array([key & 0xFFFFFFFFFFFFFFFF, key >> 64], dtype=np.uint64)


def generator(purpose: str, scene: str, seed: int, step: int = 0) -> np.random.Generator:
    """Return the generator of one address; the same address always gives the same numbers.

    Philox is counter based: the address (purpose, scene, seed) is its 128-bit key and the step
    occupies the high word of its counter, so streams of different steps cannot overlap.
    """
    counter = np.array([0, 0, 0, step], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key(purpose, scene, seed), counter=counter))


def generators(
    purpose: str, scenes: Iterable[str], seed: int, step: int = 0
) -> Iterator[np.random.Generator]:
    """Yield `generator(purpose, scene, seed, step)` for each scene, much faster for many.

    One object is moved from address to address, so each must be used before the next is asked for.
    """
    bits = np.random.Philox(key=0, counter=np.array([0, 0, 0, step], dtype=np.uint64))
    stream, fresh = np.random.Generator(bits), bits.state
    for scene in scenes:
        fresh["state"]["key"] = words(key(purpose, scene, seed))
        bits.state = fresh
        yield stream
