"""Predictors, reconstructions and planners that a user brings, named as `my_model.py:create`.

`create(seed)` builds one; `seed` is that of the trained model, and `None` where only what it is and
what it reads will be looked at, so that weights may be blank.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import nn

from faultpath.blame import explained, located
from faultpath.errors import SystemMistake
from faultpath.quadrotor import brought_checks as checks
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.planners import Planner, SamplerSettings
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.trials import SystemSpec
from faultpath.trials.registry import factory_root, load_parts

Part = Predictor | Reconstruction | Planner
KINDS: tuple[type[Part], ...] = (Predictor, Reconstruction, Planner)


@dataclass(frozen=True)
class Brought:
    """A part that the user named."""

    name: str
    blank: Part
    """What its factory gives without a seed."""
    _folder: Path
    _create: Callable[[int | None], Part]
    _settings: SamplerSettings
    _tried: set[int] = field(default_factory=set[int])

    @property
    def reads(self) -> frozenset[Any]:
        """Where a predictor or a reconstruction reads; a planner reads through the loop."""
        return _reads(self.blank)

    @property
    def description(self) -> str:
        """What it is, in words."""
        return f"{type(self.blank).__name__} of {self.name}"

    @property
    def data_files(self) -> Sequence[Path]:
        """The files that decide what it does beside its code; relative ones lie beside that."""
        return tuple(self._folder / each for each in self.blank.data_files or ())

    def load(self, seed: int | None, device: torch.device = CPU) -> Any:
        """Return a new one for an arm of this seed; the first one of a seed is tried out.

        Raises `SystemMistake` for one that is not like its blank, or that fails when it is tried.
        """
        if seed is None:
            return self.blank
        with device:
            part = _built(self.name, self._create, seed)
            if type(part) is not type(self.blank) or _reads(part) != _reads(self.blank):
                raise SystemMistake(
                    f"{self.name} returned a part for seed {seed} that is of another class or "
                    "reads elsewhere than the one for None: let seeds differ in weights only"
                )
            if seed not in self._tried:
                _explaining(lambda: checks.try_out(self.name, part, self._settings))
                self._tried.add(seed)
        return part


def bring(names: Sequence[str], settings: SamplerSettings) -> dict[str, Brought]:
    """Load the parts of these names, for a planner of these settings.

    `UserError` for a name that leads nowhere, `SystemMistake` for what is no part, or reads where
    nothing is.
    """
    created = _explaining(lambda: load_parts(names))
    return {name: _brought(name, create, settings) for name, create in created.items()}


def _brought(name: str, create: Callable[..., Any], settings: SamplerSettings) -> Brought:
    part = _built(name, create, None)
    checks.check_reads(name, part)
    if part.data_files is None and _trained(part):
        raise SystemMistake(
            f"{name} returned a {type(part).__name__} that holds trained weights and does not say "
            "where they come from: set its data_files to the files that they are read from, for "
            "every seed, or to () where no file is read"
        )
    code = factory_root(SystemSpec(name=name)).path
    return Brought(name, part, Path() if code is None else code.parent, create, settings)


def _built(name: str, create: Callable[..., Any], seed: int | None) -> Part:
    if not _takes_a_seed(create):
        raise SystemMistake(f"{name} cannot be called with a seed alone: let it take just that")
    part = _explaining(lambda: create(seed))
    if not isinstance(part, KINDS):
        kinds = " or a ".join(kind.__name__ for kind in KINDS)
        raise SystemMistake(
            f"{name} returned a {type(part).__name__} for seed {seed}: it must return a {kinds}, "
            "derived from the class of that name"
        )
    return part


def _takes_a_seed(create: Callable[..., Any]) -> bool:
    try:
        inspect.signature(create).bind(0)
    except TypeError:
        return False
    except ValueError:  # of some built-in functions nothing is known
        return True
    return True


def _explaining(act: Callable[[], Any]) -> Any:
    """Do what runs the user's code; what is wrong with it comes as one sentence, with its line."""
    try:
        return act()
    except Exception as error:
        mistake = explained(error)
        if mistake is None:
            raise
        raise located(mistake) from error


def _reads(part: Part) -> frozenset[Any]:
    return frozenset() if isinstance(part, Planner) else frozenset(part.reads)


def _trained(part: Part) -> bool:
    held = [part, *vars(part).values()]
    return any(
        isinstance(each, nn.Module) and next(each.parameters(), None) is not None for each in held
    )
