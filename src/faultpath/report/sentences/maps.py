"""Sentences on a map: only what is significant, each time with the sizes at which it is."""

from collections.abc import Sequence

from faultpath.analyses.map.model import Flip, MapFacts, MapPoint, MapResult
from faultpath.analyses.model import SHARED
from faultpath.core.text import series
from faultpath.report.sentences.phrases import NO_RESULT, scenes_like_these
from faultpath.report.sentences.wording import MINUS, interval, signed, unit
from faultpath.stats.power import MIN_SCENES


def size_label(facts: MapFacts, size: float) -> str:
    """Return the size of an error: `+20 %`, or `+0.2 m`."""
    shown, measured = (100 * size, "%") if facts.relative else (size, unit(facts.unit))
    number = f"{shown:+.3g}".replace("-", MINUS) if size else "0"
    return f"{number} {measured}".removesuffix(" 1").rstrip()


def headline(result: MapResult) -> str:
    """Return at how many of the pairs of errors that were run who is ahead, or which of these show
    that sharing the error reverses the ranking."""
    run = len(result.points)
    if result.invalid:
        return NO_RESULT[result.invalid]
    if result.scenes < MIN_SCENES:
        return f"Too few scenes: {result.scenes} compared, and at least {MIN_SCENES} are needed."
    if turned := _turned(result):
        module, sign, values = turned[0]
        return (
            f"Sharing the error reverses the ranking at {_sizes(result.facts, values)}: "
            f"{result.winner(sign)} is ahead with the {module} alone wrong, "
            f"{result.winner(-sign)} with both."
        )
    ahead = {sign: sum(point.sign == sign for point in result.points) for sign in (1, -1)}
    if not any(ahead.values()):
        return f"At none of {run} pairs of errors is the difference significant."
    (sign, most), *others = [(sign, count) for sign, count in ahead.items() if count]
    text = f"{result.winner(sign)} is ahead at {most} of {run} pairs of errors"
    text += "".join(f", {result.winner(sign)} at {count}" for sign, count in others)
    elsewhere = "; elsewhere neither is significantly ahead" if sum(ahead.values()) < run else ""
    return f"{text}{elsewhere}."


def sentences(result: MapResult) -> tuple[str, ...]:
    """Return what is significant and what it rests on, sentence by sentence."""
    run = len(result.points)
    if result.invalid:
        return ()
    if result.scenes < MIN_SCENES:
        return (_distribution(result),)
    ahead = {sign: sum(point.sign == sign for point in result.points) for sign in (-1, 1)}
    holds = "What is significant holds" if any(ahead.values()) else "The intervals hold"
    return (
        f"{holds} for {scenes_like_these(result.facts)}, at the pairs of errors that were run.",
        f"Of {run} pairs of errors run, {result.winner(-1)} is significantly ahead at {ahead[-1]} "
        f"and {result.winner(1)} at {ahead[1]}; at {run - ahead[-1] - ahead[1]} neither.",
        *(
            f"Sharing the error reverses the ranking at {_sizes(result.facts, sizes)}: with the "
            f"{module} alone wrong {result.winner(sign)} is ahead, with both wrong alike "
            f"{result.winner(-sign)}."
            for module, sign, sizes in _turned(result)
        ),
        *(_flipped(result, flip) for flip in result.flips if flip.start or flip.turned),
        _distribution(result),
        _expected(result),
    )


def _expected(result: MapResult) -> str:
    """Say what the interpolated map averages to, from which nothing is concluded."""
    correlated = {0.0: "with independent errors", 1.0: "with fully correlated ones"}
    texts: list[str] = []
    for expectation in result.joint.requested:
        other = f"with a correlation of {expectation.correlation:g}".replace("-", MINUS)
        where = correlated.get(expectation.correlation, other)
        texts.append(f"{signed(expectation.value)} pp {interval(expectation)} {where}")
    return (
        f"The map, interpolated between the pairs that were run, averages to {series(texts)}; "
        "these intervals leave out the error of interpolating, so nothing is concluded from them."
    )


def _distribution(result: MapResult) -> str:
    facts = result.facts
    text = "Errors are taken to be Gaussian"
    for module, mean, spread in zip(facts.modules, facts.means, facts.spreads, strict=True):
        middle = f"mean {size_label(facts, mean)}, " if mean else ""
        size = size_label(facts, spread).removeprefix("+")
        text += f", at the {module} with {middle}standard deviation {size}"
    text += "."
    if result.joint.outside >= 0.005:
        text += (
            f" Up to {100 * result.joint.outside:.0f} % of them lie beyond the map and count as at "
            "its edge."
        )
    return text + (f" Without error: {', '.join(facts.others)}." if facts.others else "")


def _turned(result: MapResult) -> list[tuple[str, int, list[float]]]:
    """Return the module, the side ahead with it alone wrong, and the sizes at which sharing the
    error reverses that."""
    signs = {point.errors: point.sign for point in result.points}
    turned: list[tuple[str, int, list[float]]] = []
    for place, module in enumerate(result.facts.modules):
        alone = {sum(e): sign for e, sign in signs.items() if not e[1 - place] and e[place]}
        for sign in (-1, 1):
            sizes = sorted(s for s in alone if alone[s] == sign and signs.get((s, s)) == -sign)
            if sizes:
                turned.append((module, sign, sizes))
    return turned


def _sizes(facts: MapFacts, values: Sequence[float]) -> str:
    return series([size_label(facts, size) for size in values])


def _flipped(result: MapResult, flip: Flip) -> str:
    facts = result.facts
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
        clauses.append(f"{result.winner(flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        first = size_label(facts, flip.first)
        reach = f"at the sizes run from {first} on"
        if abs(flip.last) < facts.up_to:
            reach = f"at the sizes run from {first} to {size_label(facts, flip.last)}"
            reach = f"at {first}" if flip.first == flip.last else reach
        clauses.append(f"{result.winner(flip.turned)} is ahead {reach}")
    elif abs(flip.until or 0.0) < facts.up_to:
        clauses.append("no size changes that significantly")
    return f"{where}: {', '.join(clauses)}."


def at_point(result: MapResult, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    sizes = [size_label(result.facts, error) for error in point.errors]
    named = zip(result.facts.modules, sizes, strict=True)
    pair = ", ".join(f"{module} {size}" for module, size in named)
    ahead = f"{result.winner(point.sign)} ahead" if point.sign else "not significant"
    return f"{pair}: {signed(point.difference)} pp {interval(point)}, {ahead}"
