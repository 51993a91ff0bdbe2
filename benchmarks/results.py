"""What was measured, as `results.json` keeps it; the page is made from nothing else."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
RESULTS = HERE / "results.json"


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Target(_Frozen):
    """A bound that was set before the measurement."""

    of: Literal["ratio", "ours"]
    sense: Literal["at least", "at most"]
    value: float

    def met_by(self, value: float) -> bool:
        """Return whether a measured value keeps to the bound."""
        return value >= self.value if self.sense == "at least" else value <= self.value


class Record(_Frozen):
    """One number of ours, beside one of a peer where there is a peer."""

    name: str
    """What is measured, as the page's table says it; unique."""
    comparison: str
    """The comparison that measured it; `--only` names these."""
    unit: str
    ours: float | None = None
    """Median over the rounds; `None` where it was not measured, and `note` says why."""
    ours_name: str = "faultpath"
    peer: float | None = None
    peer_name: str = ""
    ratio: float | None = None
    """Median over the rounds of ours over peer, each from the same round."""
    low: float | None = None
    """Least over the rounds: of the ratio where there is one, else of ours."""
    high: float | None = None
    target: Target | None = None
    met: bool | None = None
    note: str = ""


class Curve(_Frozen):
    """How a time grows with the size of the work."""

    name: str
    comparison: str
    across: str
    """What the horizontal axis counts."""
    unit: str
    points: tuple[tuple[float, float], ...]
    """Size and median time, smallest first."""


class Machine(_Frozen):
    """What the numbers were measured on."""

    processor: str
    cores: int
    memory_gib: float
    load: float
    """Processes that wanted a processor in the minute before: zero on a quiet machine."""
    system: str
    python: str
    packages: dict[str, str]
    kernels: str
    """Instruction set of the compiled kernels that ran, or `portable`."""
    compiler: str
    commit: str | None
    dirty: bool | None
    date: str


class Results(_Frozen):
    """Everything in `results.json`."""

    machine: Machine
    records: tuple[Record, ...]
    curves: tuple[Curve, ...]
    apart: Mapping[str, Machine] = {}
    """What a comparison was measured on that was taken by itself, by its name."""

    def replaced(
        self,
        machine: Machine,
        comparison: str,
        records: Sequence[Record],
        curves: Sequence[Curve],
        apart: bool,
    ) -> "Results":
        """Return these results with one comparison measured again, with all others or `apart`."""
        kept = [record for record in self.records if record.comparison != comparison]
        lines = [curve for curve in self.curves if curve.comparison != comparison]
        alone = {name: each for name, each in self.apart.items() if name != comparison}
        if apart:
            alone[comparison] = machine
        return Results(
            machine=self.machine if apart else machine,
            records=(*kept, *records),
            curves=(*lines, *curves),
            apart=alone,
        )


def load(path: Path = RESULTS) -> Results:
    """Read `results.json`."""
    return Results.model_validate_json(path.read_bytes())


def save(results: Results, path: Path = RESULTS) -> None:
    """Write `results.json`, six digits a number: more would only be noise."""
    content = _rounded(results.model_dump(mode="json"))
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")


def _rounded(content: object) -> object:
    if isinstance(content, float):
        return float(f"{content:.6g}")
    if isinstance(content, dict):
        return {key: _rounded(value) for key, value in content.items()}
    if isinstance(content, list):
        return [_rounded(value) for value in content]
    return content
