"""Types of questions whose values may be texts, or one of several by itself."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, cast

from pydantic import BeforeValidator, Field, PlainSerializer

from faultpath.core.files.opening import named_path
from faultpath.core.text import number_in

LARGEST = 2**63 - 1
"""The largest seed that the tables hold."""
_SEEDS = re.compile(r"(-?[0-9]+)(?:\.\.([0-9]+))?")
"""A seed, or the first and the last of a range."""
_MOST = 1000
"""Seeds of one range."""


def several(value: object) -> tuple[object, ...]:
    """Return a sequence as it is, and any other value as the only one of several."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(cast("Sequence[object]", value))
    return (value,)


def read_seeds(value: object) -> object:
    """Return seeds, from `0,1,2` and `0..2` too; `ValueError` for anything else."""
    seeds = several(value)
    if isinstance(value, str):
        parts = [_SEEDS.fullmatch(part.strip()) for part in value.split(",")]
        if not all(parts):
            raise ValueError(
                f"{value!r:.80} is not a list of whole numbers, for example 0,1,2, or 0..2"
            )
        ends = [(_seed(part[1]), _seed(part[2] or part[1])) for part in parts if part]
        if any(last < first for first, last in ends):
            raise ValueError(f"{value!r:.80} holds a range that ends below its beginning")
        if any(last - first >= _MOST for first, last in ends):
            raise ValueError(f"{value!r:.80} holds too many seeds: a range has at most {_MOST}")
        seeds = tuple(seed for first, last in ends for seed in range(first, last + 1))
    for seed in seeds:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= LARGEST:
            raise ValueError(f"{seed!r:.80} is not a seed: give whole numbers from 0 to 2^63 - 1")
    if not seeds or len(set(seeds)) < len(seeds):
        raise ValueError("give at least one seed, each of them once")
    return seeds


def _seed(text: str) -> int:
    return int(text) if len(text) < 20 else LARGEST + 1


def read_sizes(value: object) -> object:
    """Return numbers, from `0.1,0.2` too; `ValueError` for anything else."""
    if not isinstance(value, str):
        return several(value)
    try:
        return tuple(number_in(part) for part in value.split(","))
    except ValueError as error:
        raise ValueError(
            f"{value!r:.80} is not a list of numbers, for example 0.1,0.2: each must be {error}"
        ) from None


def read_names(value: object) -> object:
    """Return names, from `a,b` too; `ValueError` for an empty or a repeated one."""
    if not isinstance(value, str):
        return several(value)
    names = tuple(part.strip() for part in value.split(","))
    if not all(names):
        raise ValueError(f"'{value}' holds an empty name: part names by one comma each")
    if twice := [name for place, name in enumerate(names) if name in names[:place]]:
        raise ValueError(f"'{value}' names '{twice[0]}' twice: name each once")
    return names


_path = BeforeValidator(lambda place: named_path(place) if isinstance(place, str | Path) else place)
_DRAWN = "Seeds of the noise, and of trained models where there are any: 0,1,2 or 0..2."

Names = Annotated[
    tuple[str, ...],
    BeforeValidator(read_names, json_schema_input_type=str | tuple[str, ...]),
]
Place = Annotated[Path | None, _path, PlainSerializer(lambda path: path and str(path))]
Seeds = Annotated[
    tuple[int, ...],
    BeforeValidator(read_seeds, json_schema_input_type=int | str | tuple[int, ...]),
    Field(description=_DRAWN),
]
Sizes = Annotated[
    tuple[float, ...],
    BeforeValidator(read_sizes, json_schema_input_type=float | str | tuple[float, ...]),
]
