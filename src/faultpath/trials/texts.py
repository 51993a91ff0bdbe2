"""How questions take what is given as text, by itself, or as one of several."""

import re
from collections.abc import Sequence
from typing import cast

LARGEST = 2**63 - 1
"""The largest seed that the tables hold."""


def several(given: object) -> tuple[object, ...]:
    """Return what may be given by itself, or several of it."""
    if isinstance(given, Sequence) and not isinstance(given, str):
        return tuple(cast("Sequence[object]", given))
    return (given,)


def read_seeds(given: object) -> object:
    """Return seeds, from `0,1,2` too; `ValueError` for what are none."""
    found = several(given)
    if isinstance(given, str):
        parts = [part.strip() for part in given.split(",")]
        if not all(re.fullmatch(r"-?[0-9]+", part) for part in parts):
            raise ValueError(f"{given!r:.80} is not a list of whole numbers, for example 0,1,2")
        found = tuple(int(part) if len(part) < 20 else LARGEST + 1 for part in parts)
    for seed in found:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= LARGEST:
            raise ValueError(f"{seed!r:.80} is not a seed: give whole numbers from 0 to 2^63 - 1")
    if not found or len(set(found)) < len(found):
        raise ValueError("give at least one seed, each of them once")
    return found


def read_sizes(given: object) -> object:
    """Return numbers, from `0.1,0.2` too; `ValueError` for what are none."""
    if not isinstance(given, str):
        return several(given)
    try:
        return tuple(float(part) for part in given.split(","))
    except ValueError:
        raise ValueError(f"{given!r:.80} is not a list of numbers, for example 0.1,0.2") from None


def read_names(given: object) -> object:
    """Return names, from `a,b` too; `ValueError` for an empty one or one given twice."""
    if not isinstance(given, str):
        return several(given)
    found = tuple(part.strip() for part in given.split(","))
    if not all(found):
        raise ValueError(f"'{given}' holds an empty name: part names by one comma each")
    if twice := [name for place, name in enumerate(found) if name in found[:place]]:
        raise ValueError(f"'{given}' names '{twice[0]}' twice: name each once")
    return found
