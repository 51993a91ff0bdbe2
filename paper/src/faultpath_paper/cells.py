"""Settings and cells that the paper's studies fly, and the profiles that size them."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any, Literal, NamedTuple

import yaml

from faultpath.core.results import Frozen
from faultpath.run.pairing import Group

SYSTEM = "quadrotor"
HELD_OUT = "held-out"
SELECTION = "selection"
CORRECT = "correct"
SEEDS = (0, 1, 2)
"""The paper trains every learned model three times."""


@dataclass(frozen=True)
class Setting:
    """Where a cell is flown: the options of the system that no treatment changes."""

    library: str = HELD_OUT
    """Role of the library; a run may put another library into the place of the held-out one."""
    wind: str = "L0"
    environment: str = "obstacles"
    others: tuple[tuple[str, str], ...] = ()
    """Further options of the system, for example `("clearance", "true")`."""

    @property
    def options(self) -> dict[str, str]:
        """Options of the system."""
        return {"wind": self.wind, "environment": self.environment, **dict(self.others)}

    def __str__(self) -> str:
        changed = [f"{name}={value}" for name, value in self.others]
        return ", ".join([self.library, self.environment, self.wind, *changed])


@dataclass(frozen=True)
class Cell:
    """One variant under one set of faults in one setting, with its seeds: a figure of a table."""

    setting: Setting
    variant: str
    faults: tuple[str, ...] = ()
    """As on the command line; none for correct inputs."""
    seeds: tuple[int, ...] = (0,)
    quick: bool = True
    """Whether the quick profile flies it."""
    fixed: bool = False
    """Whether no seed trains it anew: it flies once, and is paired with each trained seed."""

    @property
    def condition(self) -> str:
        """Path of the outcome table that holds the cell's trials."""
        return f"{self.setting}: {' and '.join(self.faults) or CORRECT}"

    @property
    def group(self) -> Group:
        """Its trials."""
        return Group(self.variant, self.condition, self.seeds[0] if self.fixed else None)

    def __str__(self) -> str:
        return f"{self.variant} ({self.condition})"


def of_seed(cell: Cell, seed: int = 0) -> Cell:
    """Return a cell with one of its seeds alone."""
    return replace(cell, seeds=(seed,))


@dataclass(frozen=True)
class Profile:
    """How much of the paper is flown."""

    name: str
    scenes: int | None
    """The first N scenes of each library; `None`: all of them."""
    seeds: tuple[int, ...]

    def cells(self, cells: Iterable[Cell]) -> tuple[Cell, ...]:
        """Return the cells that this profile flies: each variant and condition once, all its
        seeds."""
        flown: dict[tuple[str, str], Cell] = {}
        for cell in cells:
            seeds = [seed for seed in cell.seeds if seed in self.seeds]
            if not seeds or (self.name == QUICK.name and not cell.quick):
                continue
            address = cell.variant, cell.condition
            earlier = flown.get(address)
            every = {*seeds, *(earlier.seeds if earlier else ())}
            flown[address] = Cell(cell.setting, cell.variant, cell.faults, tuple(sorted(every)))
        return tuple(flown.values())


QUICK = Profile("quick", scenes=10, seeds=(0,))
PAPER = Profile("paper", scenes=None, seeds=SEEDS)
PROFILES = {profile.name: profile for profile in (QUICK, PAPER)}


def calibration(error: float, module: str | None = None) -> str:
    """Return the coupled calibration fault (paper, Section IV-B), at one module or at all."""
    return f"calibration={error:+g}" + (f"@{module}" if module else "")


class PublishedClaim(Frozen):
    """A finding of the paper, stated so that our own runs can confirm or refute it."""

    id: str
    kind: Literal["platform", "finding"]
    """`platform`: a property that the selection library could be used to match."""
    claim: str
    paper: str
    """Result that the paper reports."""


class Printed(NamedTuple):
    """A figure of the paper, in the unit of what is compared with it."""

    value: float
    interval: tuple[float, float] | None = None
    """95 %, where the paper prints one: a figure worked out from two others has none."""


def published(*keys: str | int) -> Any:
    """Return a figure of the paper by its keys in `data/published.yaml`; `KeyError` for none."""
    figure: Any = data("published.yaml")
    for key in keys:
        figure = figure[key]
    return figure


def published_claims() -> tuple[PublishedClaim, ...]:
    """Return every claim of `data/claims.yaml`, in its order."""
    return tuple(PublishedClaim.model_validate(entry) for entry in data("claims.yaml"))


@cache
def data(name: str) -> Any:
    """Return a file of `data`."""
    return yaml.safe_load((files("faultpath_paper") / "data" / name).read_text("utf-8"))
