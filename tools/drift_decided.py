"""What is decided of the study of `drift_study.py`: as an audit is, from its outcome table."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import drift_study as study
from blocks import Run, Wrong, load

from faultpath.record import CORRECT, SHARED
from faultpath.record.compared import Compared, compared
from faultpath.record.family import Family, decide_paths, percent
from faultpath.statistics import Contrast, Estimate, detectable
from faultpath.store import read_outcomes
from faultpath.trials import OutcomeTable

CONSTANT = "One constant error"
LAWS = {"fixed": "One error a scene", "drift": "Drifting error"}


@dataclass(frozen=True)
class Law:
    """What was decided under one law of errors."""

    found: Compared
    family: Family

    def effect(self, path: str) -> Contrast:
        """Return the difference on a path."""
        return self.family.effects[path]

    def rates(self, path: str) -> tuple[float, float]:
        """Return success of the baseline and of the repair, per cent."""
        repair, baseline = self.found.trials[path].arms
        return percent(baseline), percent(repair)

    def detectable(self, path: str) -> float | None:
        """Return the least difference that would have been found with 80 % power."""
        made = self.effect(path).decision
        return (
            None
            if made is None
            else detectable(*self.found.trials[path].arms, rule="exact", alpha=made.critical_p)
        )


@cache
def laws(folder: Path = study.FOLDER) -> Mapping[str, Law]:
    """Return what was decided under each law; nothing where the study was not flown."""
    if not (folder / study.OUTCOMES).is_file():
        return {}
    table = read_outcomes(folder / study.OUTCOMES)
    return {law: _decided(table, law) for law in study.design().laws}


def _decided(table: OutcomeTable, law: str) -> Law:
    asked = study.design()
    rows = {study.row_name(law, path): path for path in asked.paths()}
    found = compared(asked.repair, asked.baseline, rows, table)
    if found.void:
        raise Wrong(f"no pair is left at {', '.join(found.void)}: fly the study again")
    found = Compared({rows[name]: each for name, each in found.trials.items()}, (), (), {})
    arms = {name: each.arms for name, each in found.trials.items()}
    return Law(found, decide_paths(arms, rule="exact"))  # by which its design was frozen


def constant() -> Run:
    """Return the reference run with one constant error."""
    run = load(study.design().like)
    if run is None:
        raise Wrong(f"docs/reference/{study.design().like} is missing: make the main job anew")
    return run


def where(path: str) -> str:
    """Return where the error strikes, and how far it goes together."""
    titles = {
        CORRECT: "correct inputs",
        study.RECONSTRUCTION: "reconstruction alone",
        SHARED: "both, correlation 1",
    }
    return titles.get(path, f"both, {path}")


@dataclass(frozen=True)
class Line:
    """A path under a law of errors."""

    law: str
    label: str
    rates: tuple[float, float]
    """Success of the baseline and of the repair, per cent."""
    effect: Estimate
    sign: int
    counts: str
    p: float | None
    change: Estimate | None
    """Of the difference, from this path to full correlation."""
    change_sign: int = 0
    change_p: float | None = None


def lines() -> Iterator[Line]:
    """Yield correct inputs, the constant error of the reference run, and what this study flew."""
    held = laws()
    yield _line(held["fixed"], "", CORRECT)
    record = constant().record
    changes = {each.isolated: each for each in record.changes}
    for effect in record.effects:
        if effect.path in (study.RECONSTRUCTION, SHARED):
            change = changes.get(effect.path)
            yield Line(
                law=CONSTANT,
                label=where(effect.path),
                rates=(effect.baseline_percent, effect.repair_percent),
                effect=effect.success,
                sign=effect.sign,
                counts=f"{sum(effect.wins)}:{sum(effect.losses)}",
                p=effect.adjusted_p_value,
                change=change.change if change else None,
                change_sign=change.sign if change else 0,
                change_p=change.adjusted_p_value if change else None,
            )
    for law, found in held.items():
        for path in study.design().paths()[1:]:
            yield _line(found, LAWS[law], path)


def _line(found: Law, law: str, path: str) -> Line:
    effect, change = found.effect(path), found.family.changes.get(path)
    return Line(
        law=law,
        label=where(path),
        rates=found.rates(path),
        effect=effect.estimate(),
        sign=effect.sign,
        counts=str(effect.counts),
        p=effect.decision.adjusted_p if effect.decision else None,
        change=change.estimate() if change else None,
        change_sign=change.sign if change else 0,
        change_p=change.decision.adjusted_p if change and change.decision else None,
    )
