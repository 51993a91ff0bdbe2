"""What was measured, as `results.json` keeps it; the page is made from nothing else."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results.json"


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


def at_least(value: float, of: Literal["ratio", "ours"] = "ratio") -> Target:
    """Return a lower bound on the ratio, or on our own number."""
    return Target(of=of, sense="at least", value=value)


def at_most(value: float, of: Literal["ratio", "ours"] = "ratio") -> Target:
    """Return an upper bound on the ratio, or on our own number."""
    return Target(of=of, sense="at most", value=value)


class Record(_Frozen):
    """One number of ours, beside one of a peer where there is a peer."""

    name: str
    """What is measured, as the page's table says it; unique."""
    comparison: str = ""
    """The comparison that measured it; `--only` names these."""
    unit: str = ""
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

    def judged(self) -> "Record":
        """Return the record with its target looked at."""
        value = self.ratio if self.target and self.target.of == "ratio" else self.ours
        met = None if self.target is None or value is None else self.target.met_by(value)
        return self.model_copy(update={"met": met})


def record(
    name: str,
    unit: str,
    ours: Sequence[float],
    peer: Sequence[float] = (),
    ratios: Sequence[float] = (),
    **said: Any,
) -> Record:
    """Return the record of some rounds; `said` are further fields of it."""
    spread = ratios or ours
    several = len(spread) > 1
    return Record(
        name=name,
        unit=unit,
        ours=median(ours),
        peer=median(peer) if peer else None,
        ratio=median(ratios) if ratios else None,
        low=min(spread) if several else None,
        high=max(spread) if several else None,
        **said,
    ).judged()


def unmeasured(name: str, reason: str, **said: Any) -> Record:
    """Return a record without numbers that says why it has none."""
    return Record(name=name, note=f"Not measured: {reason}", **said)


class Curve(_Frozen):
    """How a time grows with the size of the work."""

    name: str
    comparison: str = ""
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
    others: float = 0.0
    """Share of the processor's time that other work took meanwhile."""
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
    records: tuple[Record, ...] = ()
    curves: tuple[Curve, ...] = ()
    apart: Mapping[str, Machine] = {}
    """What a comparison was measured on that was taken by itself, by its name."""
    editions: Mapping[str, int] = {}
    """Which edition of a comparison was measured, by its name, where it is not the first."""

    def replaced(
        self,
        machine: Machine,
        comparison: str,
        found: Iterable[Record | Curve],
        apart: bool,
        edition: int = 1,
    ) -> "Results":
        """Return these results with one comparison measured again, with all others or `apart`."""
        here = [each.model_copy(update={"comparison": comparison}) for each in found]
        kept = [each for each in (*self.records, *self.curves) if each.comparison != comparison]
        alone = {name: each for name, each in self.apart.items() if name != comparison}
        older = {name: each for name, each in self.editions.items() if name != comparison}
        return Results(
            machine=self.machine if apart else machine,
            records=tuple(each for each in (*kept, *here) if isinstance(each, Record)),
            curves=tuple(each for each in (*kept, *here) if isinstance(each, Curve)),
            apart={**alone, comparison: machine} if apart else alone,
            editions={**older, comparison: edition} if edition > 1 else older,
        )


def load() -> Results:
    """Read `results.json`."""
    return Results.model_validate_json(RESULTS.read_bytes())


def save(results: Results) -> None:
    """Write `results.json`, six digits a number: more would only be noise."""
    content = _rounded(results.model_dump(mode="json"))
    RESULTS.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")


def _rounded(content: object) -> object:
    if isinstance(content, float):
        return float(f"{content:.6g}")
    if isinstance(content, dict):
        return {key: _rounded(value) for key, value in content.items()}
    if isinstance(content, list):
        return [_rounded(value) for value in content]
    return content
