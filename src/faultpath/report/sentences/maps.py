"""Sentences on a map: only what is significant, each time with the sizes at which it is."""

from collections.abc import Iterator, Sequence

from faultpath.analyses.map.model import Flip, MapFacts, MapPoint, MapResult
from faultpath.analyses.model import SHARED
from faultpath.core.text import series
from faultpath.report.sentences.phrases import NO_RESULT, scenes_like_these
from faultpath.report.sentences.wording import MINUS, interval, signed
from faultpath.stats.power import MIN_SCENES


def size_label(facts: MapFacts, size: float) -> str:
    """Return the size of an error: `+20 %`, or `+0.2 m`."""
    if facts.relative:
        return f"{100 * size:+.3g} %".replace("-", MINUS) if size else "0 %"
    return f"{size:+.3g} {facts.unit}".replace("-", MINUS).removesuffix(" 1")


def headline(record: MapResult) -> str:
    """Return at how many of the pairs of errors that were run who is ahead, or which of these show
    that sharing the error reverses the ranking."""
    run = len(record.points)
    if record.invalid:
        return NO_RESULT[record.invalid]
    if record.scenes < MIN_SCENES:
        return f"Too few scenes: {record.scenes} compared, and at least {MIN_SCENES} are needed."
    if turned := _turned(record):
        module, sign, values = turned[0]
        return (
            f"Sharing the error reverses the ranking at {_sizes(record.facts, values)}: "
            f"{record.winner(sign)} is ahead with the {module} alone wrong, "
            f"{record.winner(-sign)} with both."
        )
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (1, -1)}
    if not any(ahead.values()):
        return f"At none of {run} pairs of errors is the difference significant."
    clauses = [f"{record.winner(sign)} at {count}" for sign, count in ahead.items() if count]
    first, *others = clauses
    text = f"{first.replace(' at ', ' is ahead at ', 1)} of {run} pairs of errors"
    return f"{', '.join([text, *others])}; elsewhere neither is significantly ahead."


def sentences(record: MapResult) -> tuple[str, ...]:
    """Return what is significant and what it rests on, sentence by sentence."""
    run = len(record.points)
    if record.invalid:
        return ()
    if record.scenes < MIN_SCENES:
        return (_distribution(record),)
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (-1, 1)}
    return (
        f"What is significant holds for {scenes_like_these(record.facts)}, at the pairs of errors "
        "that were run.",
        f"Of {run} pairs of errors run, {record.winner(-1)} is significantly ahead at {ahead[-1]} "
        f"and {record.winner(1)} at {ahead[1]}; at {run - ahead[-1] - ahead[1]} neither.",
        *_reversals(record),
        *(_flipped(record, flip) for flip in record.flips),
        _distribution(record),
        _expected(record),
    )


def _expected(record: MapResult) -> str:
    """Say what the interpolated map averages to, from which nothing is concluded."""
    correlated = {0.0: "with independent errors", 1.0: "with fully correlated ones"}
    texts: list[str] = []
    for expectation in record.joint.requested:
        other = f"with a correlation of {expectation.correlation:g}".replace("-", MINUS)
        where = correlated.get(expectation.correlation, other)
        texts.append(f"{signed(expectation.value)} pp {interval(expectation)} {where}")
    return (
        f"The map, interpolated between the pairs that were run, averages to {series(texts)}; "
        "these intervals leave out the error of interpolating, so nothing is concluded from them."
    )


def _distribution(record: MapResult) -> str:
    facts = record.facts
    text = "Errors are taken to be Gaussian"
    for module, mean, spread in zip(facts.modules, facts.means, facts.spreads, strict=True):
        middle = f"mean {size_label(facts, mean)}, " if mean else ""
        size = size_label(facts, spread).removeprefix("+")
        text += f", at the {module} with {middle}standard deviation {size}"
    text += "."
    if record.joint.outside >= 0.005:
        text += (
            f" Up to {100 * record.joint.outside:.0f} % of them lie beyond the map and count as at "
            "its edge."
        )
    return text + (f" Without error: {', '.join(facts.others)}." if facts.others else "")


def _turned(record: MapResult) -> list[tuple[str, int, list[float]]]:
    """Return the module, the side ahead with it alone wrong, and the sizes at which sharing the
    error reverses that."""
    of = {point.errors: point.sign for point in record.points}
    turned: list[tuple[str, int, list[float]]] = []
    for place, module in enumerate(record.facts.modules):
        alone = {sum(e): sign for e, sign in of.items() if not e[1 - place] and e[place]}
        for sign in (-1, 1):
            sizes = sorted(s for s in alone if alone[s] == sign and of.get((s, s)) == -sign)
            if sizes:
                turned.append((module, sign, sizes))
    return turned


def _sizes(facts: MapFacts, values: Sequence[float]) -> str:
    return series([size_label(facts, size) for size in values])


def _reversals(record: MapResult) -> Iterator[str]:
    for module, sign, values in _turned(record):
        yield (
            f"Sharing the error reverses the ranking at {_sizes(record.facts, values)}: with the "
            f"{module} alone wrong {record.winner(sign)} is ahead, with both wrong alike "
            f"{record.winner(-sign)}."
        )


def _flipped(record: MapResult, flip: Flip) -> str:
    facts = record.facts
    where = (
        "With both wrong alike"
        if flip.condition == SHARED
        else f"With the {flip.condition} alone wrong"
    )
    where += ", error above 0" if flip.direction > 0 else ", error below 0"
    clauses: list[str] = []
    if flip.start and flip.until is not None:
        reach = "at every size run"
        if abs(flip.until) < facts.up_to:
            reach = (
                f"at the sizes run up to {size_label(facts, flip.until)}" if flip.until else "at 0"
            )
        clauses.append(f"{record.winner(flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        first = size_label(facts, flip.first)
        reach = f"at the sizes run from {first} on"
        if abs(flip.last) < facts.up_to:
            reach = f"at the sizes run from {first} to {size_label(facts, flip.last)}"
            reach = f"at {first}" if flip.first == flip.last else reach
        clauses.append(f"{record.winner(flip.turned)} is ahead {reach}")
    elif not flip.start or abs(flip.until or 0.0) < facts.up_to:
        clauses.append(
            "no size changes that significantly" if clauses else "nothing is significant"
        )
    return f"{where}: {', '.join(clauses)}."


def at_point(record: MapResult, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    sizes = [size_label(record.facts, error) for error in point.errors]
    named = zip(record.facts.modules, sizes, strict=True)
    pair = ", ".join(f"{module} {size}" for module, size in named)
    decided = f"{record.winner(point.sign)} ahead" if point.sign else "not significant"
    return f"{pair}: {signed(point.difference)} pp {interval(point)}, {decided}"
