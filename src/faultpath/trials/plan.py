"""Treatments over identical scenes: what a study runs."""

import hashlib
import json

from pydantic import Field

from faultpath.core.results import Frozen
from faultpath.faults import Fault

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
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]


class Row(Frozen):
    """Where a treatment stands in the outcome table. Two rows may share a treatment, which runs
    once."""

    variant: str
    condition: str
    seed: int
    treatment: Treatment
    scenes: tuple[str, ...] = ()
    """Those of the study in which it runs; empty: all of them. Two rows of a treatment have the
    same scenes, or none in common."""


class Study(Frozen):
    """Which treatments run over which scenes."""

    name: str
    system: SystemSpec
    library: str
    scenes: tuple[str, ...]
    rows: tuple[Row, ...]
    look: int = 0
    """Scenes of a sequential study from one look at the results to the next, in the order of
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
