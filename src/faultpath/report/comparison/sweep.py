"""Audits of one question under several sizes of a fault, and what their number means."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from faultpath.record.family import ALPHA, CORRECT
from faultpath.report.comparison import facts
from faultpath.report.comparison.runs import Compared, joined, titles
from faultpath.report.scale import tick_label

_LEAST = 3
"""Fewer runs are listed: two points show no course."""
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
    if len(set(sizes)) < len(sizes) or not facts.asked_alike(runs, _MAY_DIFFER):
        return None
    name, _, rest = found[0]
    return Swept(f"{name}{rest}", sizes)


def sentences(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return what the number of sizes does to what was decided; nothing for other runs."""
    sizes = swept(runs)
    if sizes is None:
        return ()
    together = min(100.0, 100 * ALPHA * len(runs))
    return (
        *_differ(runs, sizes),
        *_same(runs),
        f"Each size is decided by itself, with a chance of at most {100 * ALPHA:g} % of a wrong "
        f"decision; over all {len(runs)} sizes that chance can reach {together:g} %.",
        *_strict(runs, sizes),
    )


def _differ(runs: Sequence[Compared], sizes: Swept) -> Iterator[str]:
    """Say on which paths verdicts are not the same at every size, and what they are."""
    for path, title in titles(runs).items():
        at: dict[str, list[str]] = {}
        for run, size in sorted(zip(runs, sizes.sizes, strict=True), key=lambda each: each[1]):
            sign = effect.sign if (effect := run.effect(path)) else 0
            ahead = {1: f"{run.asked.repair} ahead", -1: f"{run.asked.baseline} ahead"}
            at.setdefault(ahead.get(sign, "not decided"), []).append(tick_label(size))
        if len(at) > 1:
            said = "; ".join(f"{words} at {joined(where)}" for words, where in at.items())
            yield f"{title}, verdicts differ with the size: {said}."


def _same(runs: Sequence[Compared]) -> Iterator[str]:
    found = [run.effect(CORRECT) for run in runs]
    code = {run.provenance.system_fingerprint for run in runs}
    same = {(each.success.value, each.wins, each.losses) for each in found if each}
    if None not in found and len(same) == len(code) == 1:
        yield (
            "Correct inputs are the same trials at every size: one result, drawn as often as there "
            "are sizes."
        )


def _strict(runs: Sequence[Compared], sizes: Swept) -> Iterator[str]:
    """Say what stays decided where the error is to hold for all sizes together."""
    known = [effect for run in runs for effect in run.record.effects if effect.sign]
    if not known or any(effect.adjusted_p_value is None for effect in known):
        return
    told: list[str] = []
    for path, title in titles(runs).items():
        for sign, ahead in ((1, "repair"), (-1, "baseline")):
            at = [
                tick_label(size)
                for run, size in zip(runs, sizes.sizes, strict=True)
                if (effect := run.effect(path))
                and effect.sign == sign
                and (effect.adjusted_p_value or 0.0) * len(runs) <= ALPHA
            ]
            if at and not (path == CORRECT and list(_same(runs))):
                told.append(f"{title}: for the {ahead} at {joined(at)}")
    kept = "; ".join(told) or "none on any path that the fault strikes"
    yield (
        f"Decisions that stand where {100 * ALPHA:g} % has to do for all sizes together "
        f"(p-values times {len(runs)}): {kept}."
    )
