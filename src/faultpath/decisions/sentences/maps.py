"""Sentences on a map: only what is significant, each time with the sizes at which it is."""

import math
from collections.abc import Iterator

from faultpath.decisions.map.lattice import SHARED
from faultpath.decisions.map.model import CorrelationRegion, Flip, MapPoint, MapRecord, ResolvedMap
from faultpath.decisions.sentences.wording import MINUS, plain, series, signed
from faultpath.statistics.contrast import MIN_SCENES

_DIGITS = 3
"""Digits of sizes in words."""


def estimand(question: ResolvedMap) -> str:
    """Return what everything speaks of."""
    return "new scenes like these" + (", for these trained models" if question.trained else "")


def headline(record: MapRecord) -> str:
    """Return who does better at which correlation of the two errors."""
    question, regions = record.question, record.joint.regions
    if record.scenes < MIN_SCENES:
        return f"Too few scenes: {record.scenes} compared, and at least {MIN_SCENES} are needed."
    if not regions:
        return (
            f"At no correlation of the two errors does {question.baseline} or {question.repair} do "
            "significantly better."
        )
    decided = {point.sign for point in record.points}
    if not (regions := tuple(region for region in regions if region.sign in decided)):
        winners = series(sorted({question.winner(region.sign) for region in record.joint.regions}))
        return (
            "No single pair of errors shows which is better; only their average does, in favour "
            f"of {winners}."
        )
    first, *others = regions
    if (first.low, first.high) == (-1.0, 1.0):
        return f"{question.winner(first.sign)} does better at every correlation of the two errors."
    clauses = [
        f"{question.winner(first.sign)} does better with an error correlation {_range(first)}"
    ]
    clauses += [f"{question.winner(region.sign)} {_range(region)}" for region in others]
    # Beside three regions it would be more than twenty words.
    clauses += ["elsewhere neither does significantly better"] if len(regions) < 3 else []
    return f"{'; '.join(clauses)}."


def _range(region: CorrelationRegion) -> str:
    low, high = math.ceil(100 * region.low - 1e-6) / 100, math.floor(100 * region.high + 1e-6) / 100
    if region.low == -1.0:
        text = f"up to {high:g}"
    else:
        text = f"from {low:g} on" if region.high == 1.0 else f"from {low:g} to {high:g}"
    return text.replace("-", MINUS)


def sentences(record: MapRecord) -> tuple[str, ...]:
    """Return what is decided and what it rests on, sentence by sentence."""
    question, run = record.question, len(record.points)
    if record.scenes < MIN_SCENES:
        return (_distribution(record),)
    texts = [f"What is significant holds for {record.estimand}.", _distribution(record)]
    for expectation in record.joint.asked:
        where = f"With a correlation of {expectation.correlation:g}".replace("-", MINUS)
        at = {0.0: "With independent errors", 1.0: "With errors that are correlated fully"}
        where = at.get(expectation.correlation, where)
        low, high = plain(expectation.low), plain(expectation.high)
        numbers = f"({signed(expectation.value)} pp [{low}, {high}])"
        if expectation.sign:
            winner = question.winner(expectation.sign)
            texts.append(f"{where} {winner} is expected to succeed more often {numbers}.")
        else:
            texts.append(f"{where} no expected difference is significant {numbers}.")
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (-1, 1)}
    texts.append(
        f"Of {run} pairs of errors run, {question.baseline} is significantly ahead at {ahead[-1]} "
        f"and {question.repair} at {ahead[1]}; at {run - ahead[-1] - ahead[1]} neither."
    )
    return (*texts, *_reversals(record), *(_flipped(question, flip) for flip in record.flips))


def _distribution(record: MapRecord) -> str:
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


def _reversals(record: MapRecord) -> Iterator[str]:
    question = record.question
    of = {point.errors: point.sign for point in record.points}
    for place, module in enumerate(question.against):
        alone = {sum(e): sign for e, sign in of.items() if not e[1 - place] and e[place]}
        for sign in (-1, 1):
            turned = (s for s in alone if alone[s] == sign and of.get((s, s)) == -sign)
            if values := sorted(turned):
                sizes = series([question.said(size) for size in values])
                yield (
                    f"Sharing the error reverses the ranking at {sizes}: with the {module} alone "
                    f"wrong {question.winner(sign)} is ahead, with both wrong alike "
                    f"{question.winner(-sign)}."
                )


def _flipped(question: ResolvedMap, flip: Flip) -> str:
    where = "With both wrong alike" if flip.path == SHARED else f"With the {flip.path} alone wrong"
    where += ", error above 0" if flip.direction > 0 else ", error below 0"
    clauses: list[str] = []
    if flip.start and flip.until is not None:
        reach = "at every size of the map"
        if abs(flip.until) < question.up_to:
            reach = f"up to {question.said(cut(flip.until, out=False))}" if flip.until else "at 0"
        clauses.append(f"{question.winner(flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        first = question.said(cut(flip.first, out=True))
        reach = f"from {first} on"
        if abs(flip.last) < question.up_to:
            reach = f"between {first} and {question.said(cut(flip.last, out=False))}"
        clauses.append(f"{question.winner(flip.turned)} is ahead {reach}")
    elif not flip.start or abs(flip.until or 0.0) < question.up_to:
        clauses.append(
            "no size changes that significantly" if clauses else "nothing is significant"
        )
    return f"{where}: {', '.join(clauses)}."


def cut(size: float, out: bool) -> float:
    """Return a size at three digits, rounded away from 0 or towards it: never to claim more."""
    if not size:
        return size
    digit = 10.0 ** (math.floor(math.log10(abs(size))) - _DIGITS + 1)
    steps = abs(size) / digit
    whole = math.ceil(steps - 1e-6) if out else math.floor(steps + 1e-6)
    return math.copysign(whole * digit, size)


def at_point(question: ResolvedMap, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    sizes = zip(question.against, map(question.said, point.errors), strict=True)
    pair = ", ".join(f"{module} {size}" for module, size in sizes)
    decided = f"{question.winner(point.sign)} ahead" if point.sign else "not significant"
    interval = f"[{plain(point.low)}, {plain(point.high)}]"
    return f"{pair}: {signed(point.difference)} pp {interval}, {decided}"
