"""Finished audits beside each other as data: effects, and what differs between the runs.

Every audit keeps its own result. Only sizes of one fault are tested anew, as one family.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from faultpath.analyses.contrasts import effect_name
from faultpath.analyses.effects import Effect
from faultpath.analyses.family import decide_sizes
from faultpath.analyses.model import CORRECT, SHARED, AuditResult
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences import phrases, wording
from faultpath.report.sentences.headline import headline
from faultpath.run.provenance import RunProvenance
from faultpath.stats.estimate import Sign

_SIZED = re.compile(r"([^=,@]+)=([^=,@/]+)(.*)", re.DOTALL)
_MAY_DIFFER = ("Fault", "Scenes run", "Scenes compared")
_DIGITS = 8


@dataclass(frozen=True, eq=False)
class Compared:
    """A finished audit beside others."""

    number: int
    """Its place among them, from 1."""
    folder: str
    source: ReportInput
    """All that its pages are made from."""
    family: Mapping[str, tuple[Sign, float]] | None = None
    """For a sweep over sizes: by condition, the side that is significantly ahead over all of them
    together, and the adjusted p. `None` where every audit stands by itself."""

    @property
    def record(self) -> AuditResult:
        """Result of the audit."""
        return self.source.record

    @property
    def provenance(self) -> RunProvenance:
        """Code and machine that it was made with."""
        return self.source.provenance

    def effect(self, condition: str) -> Effect | None:
        """Return its effect under a condition, as tested together with the others; `None` where it
        has none."""
        effect = self.record.effect(condition)
        if effect is None or self.family is None or condition not in self.family:
            return effect
        sign, p = self.family[condition]
        return effect.model_copy(update={"sign": sign, "corrected_p": p})

    @property
    def headline(self) -> str:
        """Its own headline, qualified where something in it is not significant over all sizes."""
        own, family = headline(self.record), self.family or {}
        fallen = any(
            e.sign and not family.get(e.condition, (e.sign, 0))[0] for e in self.record.effects
        )
        return f"By itself, and not over all sizes: {own}" if fallen else own

    def absent(self, condition: str) -> str:
        """Say why it has no effect under a condition."""
        return "every pair missing" if condition in self.record.titles else "not run"


def titles(runs: Sequence[Compared]) -> dict[str, str]:
    """Return the conditions of all runs, correct inputs first and the shared fault last, with
    titles that say which is primary in all of them."""
    by_condition: dict[str, str] = {}
    for run in runs:
        for condition, title in run.record.titles.items():
            by_condition.setdefault(condition, title)
    primaries = {run.record.facts.primary for run in runs}
    places = {CORRECT: 0, SHARED: 2}
    return {
        condition: by_condition[condition] + (" (primary)" if primaries == {condition} else "")
        for condition in sorted(by_condition, key=lambda condition: places.get(condition, 1))
    }


Facts = Mapping[str, tuple[str, ...]]
"""By title, the value in each run."""


def _side_by_side(columns: Sequence[Mapping[str, str]], absent: str) -> dict[str, tuple[str, ...]]:
    keys = dict.fromkeys(key for values in columns for key in values)
    return {key: tuple(values.get(key, absent) for values in columns) for key in keys}


def _question(runs: Sequence[Compared]) -> dict[str, tuple[str, ...]]:
    facts = [
        {
            "Fault": str(run.record.question.fault or "not given"),
            "Baseline": run.record.question.baseline,
            "Repair": run.record.question.repair,
            "System": run.record.facts.system,
            "Library": run.record.facts.library,
            "State of the library": run.record.facts.library_hash[:_DIGITS],
            "Scenes run": phrases.scenes_run(run.record),
            "Scenes compared": str(run.record.scenes),
            "Seeds": ", ".join(map(str, run.record.facts.seeds)),
            "Primary contrast": run.record.facts.primary,
            "Intervals and tests hold for": phrases.estimand(run.record.question, run.record.facts),
            "Stopping": wording.sentence(phrases.stopping(run.record) or "all scenes were run"),
            **{
                f"Option {key}": value for key, value in sorted(run.record.question.options.items())
            },
        }
        for run in runs
    ]
    return _side_by_side(facts, "not given")


def differing(runs: Sequence[Compared]) -> Facts:
    """Return what differs between runs: first in question and trials, then in code and machine."""
    environments = [
        {
            "Code, data and packages": code.system_fingerprint[:_DIGITS],
            "faultpath": code.faultpath_version,
            "Python": machine.python,
            "Computed with": machine.backend or "not said",
            "Processor": machine.processor,
            "Platform": machine.platform,
            **{f"Package {name}": version for name, version in sorted(machine.packages.items())},
        }
        for code, machine in ((run.provenance.code, run.provenance.machine) for run in runs)
    ]
    facts = _question(runs) | _side_by_side(environments, "not named")
    return {title: values for title, values in facts.items() if len(set(values)) > 1}


def labels(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return a label for each run: its number, with what of the question tells all of them apart
    if one thing does, and otherwise with its folder."""
    apart = [values for values in _question(runs).values() if len(set(values)) == len(runs)]
    texts = apart[0] if apart else tuple(Path(run.folder).name for run in runs)
    return tuple(f"{run.number}  {text}" for run, text in zip(runs, texts, strict=True))


def swept(runs: Sequence[Compared]) -> tuple[str, tuple[float, ...]] | None:
    """Return the fault in whose size alone the questions differ, with the size in each run;
    `None` where they differ in something else."""
    parts = [_SIZED.fullmatch(str(run.record.question.fault)) for run in runs]
    groups = [part.groups() for part in parts if part]
    if len(runs) < 2 or len(groups) < len(runs) or len({(a, c) for a, _, c in groups}) > 1:
        return None
    try:
        sizes = tuple(float(size) for _, size, _ in groups)
    except ValueError:
        return None
    alike = all(
        len(set(values)) == 1 or title in _MAY_DIFFER for title, values in _question(runs).items()
    )
    if len(set(sizes)) < len(sizes) or not alike:
        return None
    name, _, rest = groups[0]
    return f"{name}{rest}", sizes


def same_correct_trials(runs: Sequence[Compared]) -> bool:
    """Return whether all runs saw the same of the same code under correct inputs."""
    effects = [run.effect(CORRECT) for run in runs]
    code = {run.provenance.code.system_fingerprint for run in runs}
    same = {(effect.value, effect.won) for effect in effects if effect}
    return None not in effects and len(same) == len(code) == 1


def together(runs: Sequence[Compared]) -> tuple[Compared, ...]:
    """Return runs of which sizes of one fault are tested as one family; others as they are."""
    if swept(runs) is None:
        return tuple(runs)
    # Correct inputs that are the same trials at every size are one contrast.
    once = (effect_name(CORRECT),) if same_correct_trials(runs) else ()
    families = decide_sizes([run.record for run in runs], once)
    return tuple(replace(run, family=of) for run, of in zip(runs, families, strict=True))
