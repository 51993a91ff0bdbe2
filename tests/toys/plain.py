"""Plain functions as a plant, systems of them, and what a module writes for one scene."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from faultpath.loop import Batch, Inputs, Module, Port
from faultpath.system import ComposedSystem, FunctionPlant, writes


def functions(start, step, action="push", steps=2, succeeded=lambda episode: True, **options):
    """Return a plant of plain functions in which every scene succeeds."""
    options = {"dt_s": 0.1, "steps": steps, "succeeded": succeeded} | options
    return FunctionPlant(start, step, action=action, **options)


def composed(
    variants: Mapping[str, Sequence[Module]], units: Mapping[str, str], start, step, **options: Any
) -> ComposedSystem:
    """Return a system of such a plant, which shows what its state holds of these units."""
    observes = {name: name for name in start(np.random.default_rng(0)) if name in units}
    plant = functions(start, step, observes=observes, **options)
    return ComposedSystem("cart", plant, variants, units)


def stepped(of, function, **values):
    """Return what a module gets for one scene, to which these values are delivered at `part`."""
    module = writes("out", of=of)(function)
    rows = {Port(name, f"part.{name}"): np.array([value]) for name, value in values.items()}
    return module.step(Inputs("module", 0, rows, {}), module.begin(Batch(("a",), 0, 0.1)))[0]["out"]
