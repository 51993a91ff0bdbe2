"""Design of the study, as its file states it, and what its flights showed."""

from pathlib import Path
from typing import Self

from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.files.plain import Misread, read_yaml
from faultpath.core.results import Frozen
from faultpath.run.plan import SystemSpec


class Design(Frozen):
    """The file `design.yaml`; its comments say what each entry is."""

    options: dict[str, str]
    library: str
    baseline: str
    repairs: dict[str, tuple[str, str]]
    """Variant and filter of each repair, by its name."""
    faults: dict[str, str]
    modules: dict[str, str]
    seed: int = Field(ge=0)
    audits: tuple[tuple[str, str], ...]
    """Fault and repair."""

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a design; `UserError` for what is none."""
        try:
            return read_yaml(path.read_bytes()).fill(cls)
        except (OSError, Misread) as error:
            where = error.at(path) if isinstance(error, Misread) else f"{path}: {error.strerror}"
            raise UserError(f"{where}.") from None

    @property
    def spec(self) -> SystemSpec:
        """The system that flies."""
        return SystemSpec(name="quadrotor", options=self.options)

    @property
    def variants(self) -> dict[str, dict[str, str]]:
        """The filter of each variant that meets a fault, by fault."""
        filters = {fault: {self.baseline: self.options["estimator"]} for fault, _ in self.audits}
        for fault, repair in self.audits:
            variant, estimator = self.repairs[repair]
            filters[fault][variant] = estimator
        return filters


class Audit(Frozen):
    """Findings on a repair under a fault, by condition."""

    fault: str
    repair: str
    success: dict[str, tuple[float, float]]
    """Share of trials that succeeded: repair, baseline."""
    effects: dict[str, tuple[float, float, float, int]]
    """Difference in percentage points, both ends of its interval, and its sign if significant."""
    turns: dict[str, str]
    """How a condition with the fault at one module compares with the shared one."""


class ErrorSize(Frozen):
    """Size of the errors that a filter made under a fault."""

    fault: str
    filter: str
    rms: dict[str, float]
    """Root mean square length by channel; of a rotation in degrees."""


class SensorAudits(Frozen):
    """All audits of the design."""

    design: Design
    options: dict[str, str]
    """Those of the system."""
    scenes: int
    audits: tuple[Audit, ...]
    errors: tuple[ErrorSize, ...]
