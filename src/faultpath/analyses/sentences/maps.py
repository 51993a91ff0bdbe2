"""Sentences on a map: only what is significant, each time with the sizes at which it is."""

from collections.abc import Iterator, Sequence

from faultpath.analyses.map.lattice import SHARED
from faultpath.analyses.map.model import Flip, MapPoint, MapResult, ResolvedMap
from faultpath.analyses.sentences.phrases import NO_RESULT
from faultpath.analyses.sentences.wording import MINUS, plain, series, signed
from faultpath.stats.contrast import MIN_SCENES


def estimand(question: ResolvedMap) -> str:
    """Return what everything speaks of."""
    return "new scenes like these" + (", for these trained models" if question.trained else "")


def headline(record: MapResult) -> str:
    """Return at how many of the pairs of errors that were run who is ahead, or which of these show
    that sharing the error reverses the ranking."""
    question, run = record.question, len(record.points)
    if record.invalid:
        return NO_RESULT[record.invalid]
    if record.scenes < MIN_SCENES:
        return f"Too few scenes: {record.scenes} compared, and at least {MIN_SCENES} are needed."
    if turned := _turned(record):
        module, sign, values = turned[0]
        return (
            f"Sharing the error reverses the ranking at {_sizes(question, values)}: "
            f"{question.winner(sign)} is ahead with the {module} alone wrong, "
            f"{question.winner(-sign)} with both."
        )
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (1, -1)}
    if not any(ahead.values()):
        return f"At none of {run} pairs of errors is the difference significant."
    clauses = [f"{question.winner(sign)} at {count}" for sign, count in ahead.items() if count]
    first, *others = clauses
    text = f"{first.replace(' at ', ' is ahead at ', 1)} of {run} pairs of errors"
    return f"{', '.join([text, *others])}; elsewhere neither is significantly ahead."


def sentences(record: MapResult) -> tuple[str, ...]:
    """Return what is significant and what it rests on, sentence by sentence."""
    question, run = record.question, len(record.points)
    if record.invalid:
        return ()
    if record.scenes < MIN_SCENES:
        return (_distribution(record),)
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (-1, 1)}
    return (
        f"What is significant holds for {estimand(question)}, at the pairs of errors that were "
        "run.",
        f"Of {run} pairs of errors run, {question.baseline} is significantly ahead at {ahead[-1]} "
        f"and {question.repair} at {ahead[1]}; at {run - ahead[-1] - ahead[1]} neither.",
        *_reversals(record),
        *(_flipped(question, flip) for flip in record.flips),
        _distribution(record),
        _expected(record),
    )


def _expected(record: MapResult) -> str:
    """Say what the interpolated map averages to, from which nothing is concluded."""
    correlated = {0.0: "with independent errors", 1.0: "with fully correlated ones"}
    texts: list[str] = []
    for expectation in record.joint.asked:
        other = f"with a correlation of {expectation.correlation:g}".replace("-", MINUS)
        ends = f"[{plain(expectation.low)}, {plain(expectation.high)}]"
        where = correlated.get(expectation.correlation, other)
        texts.append(f"{signed(expectation.value)} pp {ends} {where}")
    return (
        f"The map, interpolated between the pairs that were run, averages to {series(texts)}; "
        "these intervals leave out the error of interpolating, so nothing is concluded from them."
    )


def _distribution(record: MapResult) -> str:
    question = record.question
    text = "Errors are taken to be Gaussian"
    for module, mean, spread in zip(
        question.against, question.means, question.spreads, strict=True
    ):
        middle = f"mean {question.said(mean)}, " if mean else ""
        size = question.said(spread).removeprefix("+")
        text += f", at the {module} with {middle}standard deviation {size}"
    text += "."
    if record.joint.outside >= 0.005:
        text += (
            f" Up to {100 * record.joint.outside:.0f} % of them lie beyond the map and count as at "
            "its edge."
        )
    return text + (f" Without error: {', '.join(question.others)}." if question.others else "")


def _turned(record: MapResult) -> list[tuple[str, int, list[float]]]:
    """Return the module, the side ahead with it alone wrong, and the sizes at which sharing the
    error reverses that."""
    of = {point.errors: point.sign for point in record.points}
    turned: list[tuple[str, int, list[float]]] = []
    for place, module in enumerate(record.question.against):
        alone = {sum(e): sign for e, sign in of.items() if not e[1 - place] and e[place]}
        for sign in (-1, 1):
            sizes = sorted(s for s in alone if alone[s] == sign and of.get((s, s)) == -sign)
            if sizes:
                turned.append((module, sign, sizes))
    return turned


def _sizes(question: ResolvedMap, values: Sequence[float]) -> str:
    return series([question.said(size) for size in values])


def _reversals(record: MapResult) -> Iterator[str]:
    question = record.question
    for module, sign, values in _turned(record):
        yield (
            f"Sharing the error reverses the ranking at {_sizes(question, values)}: with the "
            f"{module} alone wrong {question.winner(sign)} is ahead, with both wrong alike "
            f"{question.winner(-sign)}."
        )


def _flipped(question: ResolvedMap, flip: Flip) -> str:
    where = (
        "With both wrong alike"
        if flip.condition == SHARED
        else f"With the {flip.condition} alone wrong"
    )
    where += ", error above 0" if flip.direction > 0 else ", error below 0"
    clauses: list[str] = []
    if flip.start and flip.until is not None:
        reach = "at every size run"
        if abs(flip.until) < question.up_to:
            reach = f"at the sizes run up to {question.said(flip.until)}" if flip.until else "at 0"
        clauses.append(f"{question.winner(flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        first = question.said(flip.first)
        reach = f"at the sizes run from {first} on"
        if abs(flip.last) < question.up_to:
            reach = f"at the sizes run from {first} to {question.said(flip.last)}"
            reach = f"at {first}" if flip.first == flip.last else reach
        clauses.append(f"{question.winner(flip.turned)} is ahead {reach}")
    elif not flip.start or abs(flip.until or 0.0) < question.up_to:
        clauses.append(
            "no size changes that significantly" if clauses else "nothing is significant"
        )
    return f"{where}: {', '.join(clauses)}."


def at_point(question: ResolvedMap, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    sizes = zip(question.against, map(question.said, point.errors), strict=True)
    pair = ", ".join(f"{module} {size}" for module, size in sizes)
    decided = f"{question.winner(point.sign)} ahead" if point.sign else "not significant"
    interval = f"[{plain(point.low)}, {plain(point.high)}]"
    return f"{pair}: {signed(point.difference)} pp {interval}, {decided}"
