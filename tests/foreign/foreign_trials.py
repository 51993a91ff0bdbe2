"""An example on a package of other people: loading it, one trial of it, whom a fault reached."""

from collections.abc import Sequence
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from faultpath.run.attempt import attempt
from faultpath.run.plan import Treatment
from faultpath.system import System

ROOT = Path(__file__).resolve().parents[2]


def loaded(path: Path) -> Any:
    spec = spec_from_file_location(path.stem, path)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def imported(patch: pytest.MonkeyPatch, file: str, **settings: object) -> Any:
    """Return an example as those beside it import it, with other settings."""
    patch.syspath_prepend(str(ROOT / "examples"))
    module = import_module(file.removesuffix(".py"))
    for name, value in settings.items():
        patch.setattr(module, name, value)
    return module


def attempted(system: System, variant: str, scenes: Sequence[str], fault: str = "") -> Any:
    faults = system.fault(fault) if fault else ()
    return attempt(system, Treatment(variant=variant, faults=faults), scenes)


def faulted(trial: Any) -> dict[str, int]:
    """Return in how many steps the fault acted, by the readers in which it did."""
    return {tap.reader: tap.faulted_steps for tap in trial.taps if tap.faulted_steps}


def lines(text: str) -> int:
    """Return how many lines have code in them."""
    words = [line.strip() for line in text.splitlines()]
    return sum(bool(line) and not line.startswith(("#", '"""')) for line in words)
