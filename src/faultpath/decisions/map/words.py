"""What is said of a map: only what was decided, each time with the sizes at which it was."""

import math
from collections.abc import Iterable

from faultpath.decisions.map.asked import MapQuestion
from faultpath.decisions.map.lattice import SHARED
from faultpath.decisions.map.model import CorrelationRegion, Expectation, Flip, MapPoint, MapRecord
from faultpath.decisions.wording import MINUS, plain, series, signed
from faultpath.statistics.contrast import MIN_SCENES

_DIGITS = 3
"""Of sizes in words."""


def estimand(question: MapQuestion) -> str:
    """Return what everything speaks of."""
    return "new scenes like these" + (", for these trained models" if question.trained else "")


def headline(record: MapRecord) -> str:
    """Return who does better at which correlation of the two errors."""
    asked, regions = record.question, record.joint.regions
    if record.scenes < MIN_SCENES:
        return (
            f"Too few scenes to decide anything: {record.scenes}, and {MIN_SCENES} are the least."
        )
    if not regions:
        return (
            f"At no correlation of the two errors is it decided which of {asked.baseline} and "
            f"{asked.repair} does better."
        )
    if len(regions) == 1 and (regions[0].low, regions[0].high) == (-1.0, 1.0):
        return (
            f"{_winner(asked, regions[0].sign)} does better at every correlation of the two errors."
        )
    first, *others = regions
    said = [f"{_winner(asked, first.sign)} does better with an error correlation {_range(first)}"]
    said += [f"{_winner(asked, each.sign)} {_range(each)}" for each in others]
    # Beside three regions it would be more than twenty words.
    said += ["elsewhere nothing is decided"] if len(regions) < 3 else []
    return f"{'; '.join(said)}."


def _range(region: CorrelationRegion) -> str:
    low, high = math.ceil(100 * region.low - 1e-6) / 100, math.floor(100 * region.high + 1e-6) / 100
    if region.low == -1.0:
        said = f"up to {high:g}"
    else:
        said = f"from {low:g} on" if region.high == 1.0 else f"from {low:g} to {high:g}"
    return said.replace("-", MINUS)


def sentences(record: MapRecord) -> tuple[str, ...]:
    """Return what is decided and what it rests on, sentence by sentence."""
    if record.scenes < MIN_SCENES:
        return (_distribution(record),)
    said = [f"What is decided holds for {record.estimand}.", _distribution(record)]
    said += [_expected(record.question, each) for each in record.joint.asked]
    said += [_decided(record), *_reversals(record)]
    said += [_flipped(record.question, each) for each in record.flips]
    return tuple(said)


def _distribution(record: MapRecord) -> str:
    asked = record.question
    said = "Errors are taken to be Gaussian"
    for module, mean, spread in zip(asked.against, asked.means, asked.spreads, strict=True):
        middle = f"mean {asked.said(mean)}, " if mean else ""
        said += f", at the {module} with {middle}standard deviation {_plain(asked, spread)}"
    said += "."
    if record.joint.outside >= 0.005:
        said += (
            f" Up to {100 * record.joint.outside:.0f} % of them lie beyond the map and count as at "
            "its edge."
        )
    if asked.others:
        said += f" Without error: {', '.join(asked.others)}."
    return said


def _expected(asked: MapQuestion, found: Expectation) -> str:
    at = {0.0: "With independent errors", 1.0: "With errors that are correlated fully"}
    of = f"{found.correlation:g}".replace("-", MINUS)
    where = at.get(found.correlation, f"With a correlation of {of}")
    numbers = f"({signed(found.value)} pp [{plain(found.low)}, {plain(found.high)}])"
    if not found.sign:
        return f"{where} no expected difference is decided {numbers}."
    return f"{where} {_winner(asked, found.sign)} is expected to succeed more often {numbers}."


def _decided(record: MapRecord) -> str:
    asked, flown = record.question, len(record.points)
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (-1, 1)}
    return (
        f"Of {flown} pairs of errors flown, {asked.baseline} is ahead at {ahead[-1]} and "
        f"{asked.repair} at {ahead[1]}; at {flown - ahead[-1] - ahead[1]} it is not decided."
    )


def _reversals(record: MapRecord) -> Iterable[str]:
    asked = record.question
    of = {point.errors: point for point in record.points}
    for place, module in enumerate(asked.against):
        alone = {sum(e): p for e, p in of.items() if not e[1 - place] and e[place]}
        turned = {
            size: (point, of[size, size])
            for size, point in sorted(alone.items())
            if (size, size) in of and point.sign * of[size, size].sign < 0
        }
        for sign in (-1, 1):
            found = [size for size, (point, _) in turned.items() if point.sign == sign]
            if found:
                sizes = series([asked.said(size) for size in found])
                yield (
                    f"Sharing the error reverses the ranking at {sizes}: with the "
                    f"{module} alone wrong {_winner(asked, sign)} is ahead, with both wrong alike "
                    f"{_winner(asked, -sign)}."
                )


def _flipped(asked: MapQuestion, flip: Flip) -> str:
    where = "With both wrong alike" if flip.path == SHARED else f"With the {flip.path} alone wrong"
    where += ", error above 0" if flip.direction > 0 else ", error below 0"
    clauses: list[str] = []
    if flip.start and flip.until is not None:
        reach = "at every size of the map"
        if abs(flip.until) < asked.up_to:
            reach = f"up to {asked.said(cut(flip.until, out=False))}" if flip.until else "at 0"
        clauses.append(f"{_winner(asked, flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        reach = f"from {asked.said(cut(flip.first, out=True))} on"
        if abs(flip.last) < asked.up_to:
            ends = cut(flip.first, out=True), cut(flip.last, out=False)
            reach = f"between {asked.said(ends[0])} and {asked.said(ends[1])}"
        clauses.append(f"{_winner(asked, flip.turned)} is ahead {reach}")
    elif not flip.start or abs(flip.until or 0.0) < asked.up_to:
        clauses.append("no size is decided to change that" if clauses else "nothing is decided")
    return f"{where}: {', '.join(clauses)}."


def cut(size: float, out: bool) -> float:
    """Return a size at three digits, rounded away from 0 or towards it: never to claim more."""
    if not size:
        return size
    digit = 10.0 ** (math.floor(math.log10(abs(size))) - _DIGITS + 1)
    steps = abs(size) / digit
    whole = math.ceil(steps - 1e-6) if out else math.floor(steps + 1e-6)
    return math.copysign(whole * digit, size)


def _winner(asked: MapQuestion, sign: int) -> str:
    return asked.repair if sign > 0 else asked.baseline


def _plain(asked: MapQuestion, size: float) -> str:
    return asked.said(size).removeprefix("+")


def at_point(asked: MapQuestion, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    pair = ", ".join(
        f"{module} {asked.said(size)}"
        for module, size in zip(asked.against, point.errors, strict=True)
    )
    decided = f"{_winner(asked, point.sign)} ahead" if point.sign else "not decided"
    interval = f"[{plain(point.low)}, {plain(point.high)}]"
    return f"{pair}: {signed(point.difference)} pp {interval}, {decided}"
