"""Audits of one question under several sizes of a fault, and what their number means."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from faultpath.decisions.family import ALPHA, CORRECT, alpha_shares
from faultpath.decisions.model import DecisionRecord, Effect
from faultpath.decisions.wording import series
from faultpath.report.comparison.runs import Compared, asked_alike, titles
from faultpath.report.svg import tick_label
from faultpath.statistics import RULES, Sign
from faultpath.statistics.decisions import holm

_LEAST = 2
_SIZED = re.compile(r"([^=,@]+)=([^=,@/]+)(.*)", re.DOTALL)
_MAY_DIFFER = ("Fault", "Scenes flown", "Scenes compared")


@dataclass(frozen=True)
class Swept:
    """The fault that has several sizes, and the size in each run, in the order of the runs."""

    name: str
    sizes: tuple[float, ...]


def swept(runs: Sequence[Compared]) -> Swept | None:
    """Return the sizes of a fault in which alone the questions differ; `None` where it is else."""
    parts = [_SIZED.fullmatch(run.asked.fault) for run in runs]
    found = [part.groups() for part in parts if part]
    if len(runs) < _LEAST or len(found) < len(runs) or len({(a, c) for a, _, c in found}) > 1:
        return None
    try:
        sizes = tuple(float(size) for _, size, _ in found)
    except ValueError:
        return None
    if len(set(sizes)) < len(sizes) or not asked_alike(runs, _MAY_DIFFER):
        return None
    name, _, rest = found[0]
    return Swept(f"{name}{rest}", sizes)


def together(runs: Sequence[Compared]) -> tuple[Compared, ...]:
    """Return runs of which sizes of one fault are decided as one family; others as they are.

    Holm's procedure over every contrast of every size, weighted as each audit by itself: whatever
    is decided then holds with an error of at most 5 % for all sizes together. Correct inputs that
    are the same trials at every size are one contrast. A size decides no more than by itself.
    """
    if swept(runs) is None:
        return tuple(runs)
    once = {f"effect/{CORRECT}"} if _same(runs) else set[str]()
    p_values: dict[str, float] = {}
    weights: dict[str, float] = {}
    for run in runs:
        for name, (p, weight) in contrasts(run.record).items():
            key = name if name in once else f"{run.number}/{name}"
            p_values[key], weights[key] = p, weight
    adjusted = holm(p_values, weights)

    def decided(run: Compared, effect: Effect) -> tuple[Sign, float]:
        name = f"effect/{effect.path}"
        p = adjusted[name if name in once else f"{run.number}/{name}"]
        return (effect.sign if p <= ALPHA else 0), p

    return tuple(
        replace(
            run,
            family={
                effect.path: decided(run, effect)
                for effect in run.record.effects
                if effect.adjusted_p_value is not None
            },
        )
        for run in runs
    )


def contrasts(record: DecisionRecord) -> dict[str, tuple[float, float]]:
    """Return p and weight of every contrast that a record tested, by its name."""
    tested = [effect for effect in record.effects if effect.adjusted_p_value is not None]
    found = {f"effect/{effect.path}": effect.p_value for effect in tested}
    found |= {f"change/{change.isolated}": change.p_value for change in record.changes}
    asked = record.question
    parts = alpha_shares([effect.path for effect in tested], asked.primary)
    weighted = RULES[asked.rule].weighted or asked.stop is not None
    return {name: (p, parts[name] if weighted else 1.0) for name, p in found.items()}


def sentences(runs: Sequence[Compared]) -> Iterator[str]:
    """Yield what the number of sizes does to what was decided; nothing for other runs."""
    sizes = swept(runs)
    if sizes is None:
        return
    for path, title in titles(runs).items():
        at: dict[str, list[str]] = {}
        for run, size in sorted(zip(runs, sizes.sizes, strict=True), key=lambda each: each[1]):
            sign = effect.sign if (effect := run.effect(path)) else 0
            ahead = {1: f"{run.asked.repair} ahead", -1: f"{run.asked.baseline} ahead"}
            at.setdefault(ahead.get(sign, "not decided"), []).append(tick_label(size))
        if len(at) > 1:
            said = "; ".join(f"{words} at {series(where)}" for words, where in at.items())
            yield f"{title}, verdicts differ with the size: {said}."
    if _same(runs):
        yield "Correct inputs are the same trials at every size, and count once."
    yield (
        f"All {len(runs)} sizes are one family here: what is called decided, and what is bold, is "
        f"wrong in at most {100 * ALPHA:g} % of such sweeps, all sizes together (Holm)."
    )


def _same(runs: Sequence[Compared]) -> bool:
    found = [run.effect(CORRECT) for run in runs]
    code = {run.provenance.system_fingerprint for run in runs}
    same = {(each.success.value, each.wins, each.losses) for each in found if each}
    return None not in found and len(same) == len(code) == 1
