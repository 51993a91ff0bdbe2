"""Observations of environments, nested or plain arrays, stacked into a batch or hashed."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from hashlib import sha256
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import HostArray, is_array, to_numpy
from faultpath.core.errors import SystemMistake
from faultpath.core.text import ADDRESS, listed

_LOCATION = re.compile(rf"faultpath_system_\w+\.|{ADDRESS}")
"""The module of a system, named after the path of its file, and an object's address in memory."""


Selector = str | int | slice | tuple[Any, ...] | Callable[[Any], Any]
"""A source's part of the observation: a key, an index or slice, several in turn, or a function of
the batch's observation that returns an array `[B, ...]`."""


def select(
    observes: Mapping[str, Selector], observations: Sequence[Any], observed: str
) -> dict[str, HostArray]:
    """Return the values of all sources, `[B, ...]`, from observations of single scenes.

    `observed` names these in messages. Raises `SystemMistake` for a part that they do not have.
    """
    batch = cache(lambda: stacked(observations))  # only where needed: the observation may be large
    mapped, sources = isinstance(observations[0], Mapping), dict[str, HostArray]()
    try:
        for name, path in observes.items():
            keys = () if callable(path) else path if isinstance(path, tuple) else (path,)
            if callable(path):
                part = path(batch())
            elif mapped and keys and isinstance(keys[0], str):
                part = stacked([_part(name, row, keys[0], observed) for row in observations])
                keys = keys[1:]
            else:
                part = batch()
            for key in keys:
                if isinstance(key, str):
                    part = _part(name, part, key, observed)
                elif isinstance(part, tuple):
                    part = cast("tuple[Any, ...]", part)[key]
                else:
                    part = part[:, key]
            sources[name] = np.array(part)
    except (LookupError, TypeError) as error:
        shape = getattr(batch(), "shape", None)
        kind = type(batch()).__name__ if shape is None else list(shape[1:])
        raise SystemMistake(
            f"observes: {observed} ({kind}) holds no such part ({error}): give a key, an "
            "index or a slice of it"
        ) from error
    return sources


def _part(source: str, observation: Any, key: str, observed: str) -> Any:
    try:
        return observation[key]
    except KeyError:
        raise SystemMistake(
            f"observes: source '{source}': {observed} has no key '{key}'; it has "
            f"{listed(map(str, observation))}"
        ) from None


def stacked(rows: Sequence[Any]) -> Any:
    """Return observations of single scenes as one of a batch."""
    first = rows[0]
    if isinstance(first, Mapping):
        return {
            key: stacked([row[key] for row in rows]) for key in cast("Mapping[Any, Any]", first)
        }
    if isinstance(first, tuple):
        return tuple(stacked(column) for column in zip(*rows, strict=True))
    return np.array(rows) if _alike(rows) else np.stack(rows)


def _alike(rows: Sequence[Any]) -> bool:
    """Return whether `np.array` may replace `np.stack`, which takes three times as long."""
    first = rows[0]
    if type(first) is float:
        return all(type(row) is float for row in rows)
    if type(first) is not np.ndarray:
        return False
    return (
        first.ndim < 2
        and first.dtype.kind in "biuf"
        and all(
            type(row) is np.ndarray and row.dtype == first.dtype and row.shape == first.shape
            for row in rows
        )
    )


def hashed(*parts: Any) -> str:
    """Return a hash of arrays, numbers and their containers, exact to the bit.

    Any other object, such as a simulator, counts by its `repr` without addresses.
    """

    def exact(part: Any) -> str:
        if isinstance(part, Mapping):
            items = cast("Mapping[Any, Any]", part).items()
            return str({str(key): exact(value) for key, value in items})
        if isinstance(part, tuple | list):
            return str([exact(element) for element in cast("Sequence[Any]", part)])
        if isinstance(part, np.generic) or is_array(part):
            array = to_numpy(part)
            return f"{array.dtype}{array.shape}{array.tobytes().hex()}"
        return _LOCATION.sub("", repr(part))

    return sha256("\n".join(map(exact, parts)).encode()).hexdigest()
