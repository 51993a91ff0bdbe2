"""Treatments over identical scenes: what a plan runs."""

import hashlib
import json
from collections.abc import Iterable

from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.faults import Fault
from faultpath.system.declared import Library, SceneRef

_OBJECT = " object"


class SystemSpec(Frozen):
    """How a worker process builds the system: a registered name or `module:attribute`."""

    name: str
    options: dict[str, str] = Field(default_factory=dict[str, str])

    @classmethod
    def of_class(cls, kind: type) -> "SystemSpec":
        """Return what stands for an object of this class, which only its own process has."""
        return cls(name=f"{kind.__name__}{_OBJECT}")

    @property
    def is_object(self) -> bool:
        """Whether nothing can build the system again; no name of a factory reads like this."""
        return self.name.endswith(_OBJECT) and ":" not in self.name


class Treatment(Frozen):
    """One variant of the system under one set of faults, with one seed."""

    variant: str
    faults: tuple[Fault, ...] = ()
    """As `faultpath.faults.resolve` returns them."""
    seed: int = 0

    def key(self) -> str:
        """Content hash: treatments that would run the same trials have the same key."""
        # Sorted and in JSON, so that neither the order of fields nor the process decides the key.
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]

    def describe(self) -> str:
        """Return its faults in words."""
        return " and ".join(fault.describe() for fault in self.faults) or "correct inputs"


class Row(Frozen):
    """Where a treatment stands in the outcome table. Two rows may share a treatment, which runs
    once."""

    variant: str
    condition: str
    seed: int
    treatment: Treatment
    scenes: tuple[str, ...] = ()
    """Those of the plan in which it runs; empty: all of them. Two rows of a treatment have the
    same scenes, or none in common."""


class Plan(Frozen):
    """Which treatments run over which scenes."""

    name: str
    system: SystemSpec
    library: str
    scenes: tuple[str, ...]
    rows: tuple[Row, ...]
    scenes_per_analysis: int = 0
    """Scenes of a sequential plan from one analysis of the results to the next, in the order of
    `scenes`. 0 runs them all, in the blocks of their library."""

    def treatments(self) -> tuple[Treatment, ...]:
        """Return each distinct treatment once, in the order of the rows."""
        return tuple({row.treatment.key(): row.treatment for row in self.rows}.values())

    def parts(self) -> dict[tuple[str, ...], tuple[Treatment, ...]]:
        """Return the distinct treatments that run in the same scenes, by what their rows say of
        these."""
        parts: dict[tuple[str, ...], dict[str, Treatment]] = {}
        for row in self.rows:
            parts.setdefault(row.scenes, {})[row.treatment.key()] = row.treatment
        return {scenes: tuple(treatments.values()) for scenes, treatments in parts.items()}


def selected(plan: Plan, library: Library) -> tuple[SceneRef, ...]:
    """Return the scenes of a plan by index; `UserError` for an unknown, repeated or absent one."""
    known = {scene.id: scene for scene in library.scenes}
    unknown = [scene for scene in plan.scenes if scene not in known]
    if unknown:
        raise UserError(
            f"library {library.name!r} has no scene {unknown[0]!r}: choose from its "
            f"{len(known)} scenes, the first of which is {next(iter(known), 'none')!r}"
        )
    if not plan.scenes:
        raise UserError(f"plan {plan.name!r} selects no scene: choose at least one")
    if len(set(plan.scenes)) < len(plan.scenes):
        twice = next(s for s in plan.scenes if plan.scenes.count(s) > 1)
        raise UserError(f"plan {plan.name!r} selects scene {twice!r} twice: select it once")
    return tuple(sorted((known[scene] for scene in plan.scenes), key=lambda scene: scene.index))


def check_rows(rows: Iterable[Row], variants: Iterable[str]) -> None:
    """Raise `UserError` for a row without a known variant, or for two rows at one address."""
    known = tuple(variants)
    addresses: set[tuple[str, str, int, tuple[str, ...]]] = set()
    for row in rows:
        if row.treatment.variant not in known:
            raise UserError(
                f"the system has no variant {row.treatment.variant!r}: choose from "
                f"{', '.join(known)}"
            )
        address = (row.variant, row.condition, row.seed, row.scenes)
        if address in addresses:
            raise UserError(
                f"two rows of the plan are both called variant {row.variant!r}, "
                f"condition {row.condition!r}, seed {row.seed}: give them different names"
            )
        addresses.add(address)
