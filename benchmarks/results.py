"""Measurements as `results.json` keeps them; the page is made from nothing else."""

import json
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results.json"
EARLIER = ROOT / "benchmarks" / "earlier.json"
"""Comparisons with other planners, measured before on another machine."""
DEVICE = ROOT / "benchmarks" / "device.json"
WAITS = ROOT / "benchmarks" / "waits.json"


TIMES = {"ms": 1e3, "s": 1.0}
"""Units of rows that show the time of a call and not a rate, and how many make a second."""
VEHICLE_STEPS, LOOP_STEPS = "vehicle-steps/s", "steps/s"
"""Units of rows that the page shows as times a step."""
TAPS = 10
"""Places at which the modules and the plant of the two-link arm read."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Target(_Frozen):
    """A bound that was set before the measurement."""

    of: Literal["ratio", "ours"]
    sense: Literal["at least", "at most"]
    value: float

    def met_by(self, value: float) -> bool:
        return value >= self.value if self.sense == "at least" else value <= self.value


class Record(_Frozen):
    """One number of ours, beside one of a peer where there is a peer."""

    name: str
    """Name of the row in the page's table; unique."""
    unit: str
    ours: float | None = None
    """Median over the rounds; `None` where it was not measured, and `note` says why."""
    peer: float | None = None
    peer_name: str = ""
    ratio: float | None = None
    """Median over the rounds of how many times as fast ours is, each from the same round."""
    low: float | None = None
    """Least ratio over the rounds; without a peer, least of ours."""
    high: float | None = None
    target: Target | None = None
    met: bool | None = None
    note: str = ""


def record(
    name: str,
    unit: str,
    ours: Sequence[float],
    peer: Sequence[float] = (),
    peer_name: str = "",
    target: Target | None = None,
) -> Record:
    """Return the record of some rounds, as rates or, where the unit is one of `TIMES`, as times."""
    fast = (lambda a, b: b / a) if unit in TIMES else (lambda a, b: a / b)
    ratios = [fast(a, b) for a, b in zip(ours, peer, strict=True)] if peer else []
    ratio = median(ratios) if ratios else None
    value = ratio if target is not None and target.of == "ratio" else median(ours)
    return Record(
        name=name,
        unit=unit,
        ours=median(ours),
        peer=median(peer) if peer else None,
        peer_name=peer_name,
        ratio=ratio,
        low=min(ratios or ours),
        high=max(ratios or ours),
        target=target,
        met=None if target is None or value is None else target.met_by(value),
    )


class Machine(_Frozen):
    date: str
    processor: str
    cores: int
    system: str
    python: str
    packages: dict[str, str]
    kernels: str
    """Instruction set of the compiled kernels that ran, or `portable`."""
    commit: str | None


class Results(_Frozen):
    machine: Machine
    records: tuple[Record, ...] = ()


def load(path: Path = RESULTS) -> Results:
    return Results.model_validate_json(path.read_bytes())


def stored(path: Path) -> Any:
    return json.loads(path.read_text("utf-8"))


def save(results: Results) -> None:
    """Write `results.json`, six digits a number: more would only be noise."""
    content = json.loads(
        results.model_dump_json(), parse_float=lambda digits: float(f"{float(digits):.6g}")
    )
    RESULTS.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")
