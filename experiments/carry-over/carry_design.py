"""Design of the study, as its file states it, and results of its flights."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.files.plain import Misread, read_yaml
from faultpath.core.results import Frozen

Levels = dict[str, str]
"""A level of each factor, by its name."""
Reach = Literal["isolated", "shared"]
Only = dict[str, tuple[str, ...]]
"""The levels that are kept, of the factors that are restricted."""
VOID = "x"


class Question(Frozen):
    """A repair and what it is set against."""

    baseline: str
    repair: str
    isolated: str
    """The module that is struck alone."""
    claims: str
    """Numbers of the paper's claims."""
    paper: dict[Reach, str]
    """Who is ahead in the paper, where it says so."""
    only: Only = Field(default_factory=dict)

    def sign(self, reach: Reach) -> int:
        """Return the paper's side: 1 for the repair, -1 for the baseline, 0 where it has none."""
        ahead = self.paper.get(reach)
        return (ahead == self.repair) - (ahead == self.baseline)


class Quick(Frozen):
    """Part of the design that a quick trial flies."""

    scenes: int
    only: Only


class Design(Frozen):
    """The file `design.yaml`; its comments say what each entry is."""

    library: str
    seed: int = Field(ge=0)
    first: int = Field(ge=1)
    look: int = Field(ge=1)
    most: int = Field(ge=1)
    alpha: float = Field(gt=0, lt=1)
    fault: str
    factors: dict[str, dict[str, dict[str, str]]]
    questions: tuple[Question, ...]
    quick: Quick

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a design; `UserError` for what is none."""
        try:
            design = read_yaml(path.read_bytes()).fill(cls)
        except (OSError, Misread) as error:
            where = error.at(path) if isinstance(error, Misread) else f"{path}: {error.strerror}"
            raise UserError(f"{where}.") from None
        for only in (design.quick.only, *(question.only for question in design.questions)):
            for factor, levels in only.items():
                if odd := set(levels) - set(design.factors.get(factor, {})):
                    raise UserError(f"{path}: there is no level '{min(odd)}' of '{factor}'.")
        if design.first % design.look or design.most % design.look or design.first > design.most:
            raise UserError(f"{path}: first and most are no numbers of whole looks, ascending.")
        return design

    def restricted(self, only: Mapping[str, tuple[str, ...]], scenes: int | None = None) -> Self:
        """Return the design with these levels alone, and with so many scenes where that is said."""
        factors = {
            name: {level: to for level, to in levels.items() if level in only.get(name, levels)}
            for name, levels in self.factors.items()
        }
        few = {} if scenes is None else dict.fromkeys(("first", "look", "most"), scenes)
        same = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self)(**{**same, "factors": factors, **few})  # a copy would keep `needed`

    def settings(self) -> Iterator[tuple[Levels, dict[str, str]]]:
        """Yield each system that flies something, by its levels, with its options."""
        for levels in self._combined(fault=False):
            if any(True for _ in self.asked(levels)):
                options = (self.factors[name][level] for name, level in levels.items())
                yield levels, {key: value for level in options for key, value in level.items()}

    def asked(self, setting: Levels) -> Iterator[tuple[Question, Levels, str]]:
        """Yield what is asked in a setting: question, levels of all factors, and the fault."""
        for question, of_fault in product(self.questions, self._combined(fault=True)):
            levels = {**setting, **of_fault}
            if all(levels[name] in kept for name, kept in question.only.items()):
                yield question, levels, self.fault.format(**levels)

    def _combined(self, fault: bool) -> Iterator[Levels]:
        names = [name for name in self.factors if (f"{{{name}}}" in self.fault) == fault]
        for chosen in product(*(self.factors[name] for name in names)):
            yield dict(zip(names, chosen, strict=True))

    @cached_property
    def needed(self) -> dict[tuple[str, str], float]:
        """By baseline and repair, the logarithm of the capital that decides a cell.

        A capital is a bet against "this side is not ahead", and grows so far with a chance of at
        most its inverse, however often one looks. With two bets a cell, any wrong verdict among
        the cells of a question on one condition has a chance of at most `alpha`.
        """
        every = (q for levels, _ in self.settings() for q, _, _ in self.asked(levels))
        cells = Counter((q.baseline, q.repair) for q in every)
        return {pair: math.log(2 * count / self.alpha) for pair, count in cells.items()}


class Cell(Frozen):
    """Two variants in one setting under one fault, as they were flown."""

    levels: Levels
    baseline: str
    repair: str
    reach: Reach
    ended: tuple[str, str]
    """How baseline and repair ended, a letter a scene in the order of flight: 1 for success, 0 for
    none, x where a trial failed or the two met different conditions."""

    @property
    def void(self) -> bool:
        """Whether a pair is none: then nothing is decided."""
        return any(VOID in letters for letters in self.ended)

    @property
    def differences(self) -> NDArray[np.float64]:
        """Repair minus baseline, scene by scene, without void pairs."""
        pairs = [pair for pair in zip(*self.ended, strict=True) if VOID not in pair]
        return np.array([int(repair) - int(baseline) for baseline, repair in pairs], dtype=float)


class Round(Frozen):
    """Work computed between two looks of a setting."""

    workers: int
    blocks: int
    trials: int
    seconds: float


class Flown(Frozen):
    """Everything that the flights leave, from which all else is decided."""

    design: Design
    """Without the levels that were left out."""
    left_out: dict[str, str]
    """Levels that the installed system does not offer, and why."""
    options: dict[str, str]
    """Options of the system that flew last, by which its code is known."""
    cells: tuple[Cell, ...]
    trials: int
    """That the cells rest on; a variant of several cells counts once."""
    rounds: tuple[Round, ...]
    complete: bool
