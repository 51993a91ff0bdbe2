"""The smallest size of a fault that turns the verdict, from audits of several sizes."""

import re
from collections.abc import Iterator, Sequence

from faultpath.record.family import ALPHA, CORRECT
from faultpath.record.model import Effect
from faultpath.report.comparison.runs import Compared, titles
from faultpath.report.comparison.sweep import COURSE, swept
from faultpath.report.scale import tick_label
from faultpath.tables import MISSING, Line, Table, line

Sized = tuple[float, Compared]
_ZERO = ("", "bias", "delay", "dropout", "noise", "offset", "uniform_scale")
_NO_FAULT = {"scale": 1.0, **dict.fromkeys(_ZERO, 0.0)}
"""Which size is no fault, by the kind of fault; a preset has none."""


def turning(runs: Sequence[Compared]) -> Table | None:
    """Return who is decided to be ahead up to which size and from which on, path by path.

    What is decided holds for all sizes together (`sweep.together`). `None` for runs that are no
    sizes of one fault, where no size says what no fault is, and for sequential audits.
    """
    sizes = swept(runs)
    if sizes is None or len(runs) < COURSE or any(run.record.stopped for run in runs):
        return None
    kind = re.split("[,@]", sizes.name)[0].partition(":")[2]
    if kind not in _NO_FAULT:
        return None
    none = _NO_FAULT[kind]
    known = sorted(zip(sizes.sizes, runs, strict=True), key=lambda each: abs(each[0] - none))
    sides = [
        (word, each)
        for word, sign in (("above", 1.0), ("below", -1.0))
        if (each := [(size, run) for size, run in known if (size - none) * sign > 0.0])
    ]
    rows = [
        _row(f"{title}, {word} {none:g}", path, each)
        for path, title in titles(runs).items()
        if path != CORRECT
        for word, each in sides
    ]
    return Table(
        title="Smallest size that turns the verdict",
        corner="Path",
        columns=("Ahead without fault, up to", "Estimate turned at", "Ahead then, at"),
        lines=tuple(rows),
        notes=(
            "Ahead is who is decided to be, with an error of at most "
            f"{100 * ALPHA:g} % for all sizes together. Only sizes that were flown are named: the "
            "turn lies between the one up to which the verdict without fault stands, and the first "
            "at which the other is decided. A dash: there is none. faultpath map bisects the size.",
        ),
    )


def _row(label: str, path: str, known: Sequence[Sized]) -> Line:
    first = known[0][1].effect(CORRECT)
    start = first.sign if first else 0
    effects = [(size, run.effect(path)) for size, run in known]
    signs = [(size, effect.sign if effect else 0) for size, effect in effects]
    kept = _until(signs, start) if start else None
    turned = next(((size, sign) for size, sign in signs if sign and sign != start), None)
    ahead = {1: known[0][1].asked.repair, -1: known[0][1].asked.baseline}
    texts = (
        f"{ahead[start]}, {tick_label(kept)}" if kept is not None else MISSING,
        next(_against(first, effects), MISSING),
        f"{ahead[turned[1]]}, {tick_label(turned[0])}" if turned else MISSING,
    )
    return line(label, *texts)


def _until(signs: Sequence[tuple[float, int]], start: int) -> float | None:
    kept = None
    for size, sign in signs:
        if sign != start:
            break
        kept = size
    return kept


def _against(first: Effect | None, effects: Sequence[tuple[float, Effect | None]]) -> Iterator[str]:
    for size, effect in effects:
        if first and effect and first.success.value * effect.success.value < 0.0:
            yield tick_label(size)
