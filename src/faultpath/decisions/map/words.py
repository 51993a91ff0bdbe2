"""What is said of a map: only what was decided, each time with the sizes at which it was."""

import math
from collections.abc import Iterator

from faultpath.decisions.map.lattice import SHARED
from faultpath.decisions.map.model import CorrelationRegion, Flip, MapPoint, MapQuestion, MapRecord
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
    decided = {point.sign for point in record.points}
    if not (regions := tuple(each for each in regions if each.sign in decided)):
        winners = series(sorted({asked.winner(each.sign) for each in record.joint.regions}))
        return (
            "No single pair of errors shows which is better; only their average does, in favour "
            f"of {winners}."
        )
    first, *others = regions
    if (first.low, first.high) == (-1.0, 1.0):
        return f"{asked.winner(first.sign)} does better at every correlation of the two errors."
    said = [f"{asked.winner(first.sign)} does better with an error correlation {_range(first)}"]
    said += [f"{asked.winner(each.sign)} {_range(each)}" for each in others]
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
    asked, run = record.question, len(record.points)
    if record.scenes < MIN_SCENES:
        return (_distribution(record),)
    said = [f"What is significant holds for {record.estimand}.", _distribution(record)]
    for found in record.joint.asked:
        where = f"With a correlation of {found.correlation:g}".replace("-", MINUS)
        at = {0.0: "With independent errors", 1.0: "With errors that are correlated fully"}
        where = at.get(found.correlation, where)
        numbers = f"({signed(found.value)} pp [{plain(found.low)}, {plain(found.high)}])"
        if found.sign:
            winner = asked.winner(found.sign)
            said.append(f"{where} {winner} is expected to succeed more often {numbers}.")
        else:
            said.append(f"{where} no expected difference is decided {numbers}.")
    ahead = {sign: sum(point.sign == sign for point in record.points) for sign in (-1, 1)}
    said.append(
        f"Of {run} pairs of errors run, {asked.baseline} is ahead at {ahead[-1]} and "
        f"{asked.repair} at {ahead[1]}; at {run - ahead[-1] - ahead[1]} it is not decided."
    )
    return (*said, *_reversals(record), *(_flipped(asked, each) for each in record.flips))


def _distribution(record: MapRecord) -> str:
    asked = record.question
    said = "Errors are taken to be Gaussian"
    for module, mean, spread in zip(asked.against, asked.means, asked.spreads, strict=True):
        middle = f"mean {asked.said(mean)}, " if mean else ""
        size = asked.said(spread).removeprefix("+")
        said += f", at the {module} with {middle}standard deviation {size}"
    said += "."
    if record.joint.outside >= 0.005:
        said += (
            f" Up to {100 * record.joint.outside:.0f} % of them lie beyond the map and count as at "
            "its edge."
        )
    return said + (f" Without error: {', '.join(asked.others)}." if asked.others else "")


def _reversals(record: MapRecord) -> Iterator[str]:
    asked = record.question
    of = {point.errors: point.sign for point in record.points}
    for place, module in enumerate(asked.against):
        alone = {sum(e): sign for e, sign in of.items() if not e[1 - place] and e[place]}
        for sign in (-1, 1):
            turned = (s for s in alone if alone[s] == sign and of.get((s, s)) == -sign)
            if found := sorted(turned):
                sizes = series([asked.said(size) for size in found])
                yield (
                    f"Sharing the error reverses the ranking at {sizes}: with the {module} alone "
                    f"wrong {asked.winner(sign)} is ahead, with both wrong alike "
                    f"{asked.winner(-sign)}."
                )


def _flipped(asked: MapQuestion, flip: Flip) -> str:
    where = "With both wrong alike" if flip.path == SHARED else f"With the {flip.path} alone wrong"
    where += ", error above 0" if flip.direction > 0 else ", error below 0"
    clauses: list[str] = []
    if flip.start and flip.until is not None:
        reach = "at every size of the map"
        if abs(flip.until) < asked.up_to:
            reach = f"up to {asked.said(cut(flip.until, out=False))}" if flip.until else "at 0"
        clauses.append(f"{asked.winner(flip.start)} is ahead {reach}")
    if flip.first is not None and flip.last is not None:
        first = asked.said(cut(flip.first, out=True))
        reach = f"from {first} on"
        if abs(flip.last) < asked.up_to:
            reach = f"between {first} and {asked.said(cut(flip.last, out=False))}"
        clauses.append(f"{asked.winner(flip.turned)} is ahead {reach}")
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


def at_point(asked: MapQuestion, point: MapPoint) -> str:
    """Return a pair of errors and what was seen there, for the tip of a picture."""
    sizes = zip(asked.against, map(asked.said, point.errors), strict=True)
    pair = ", ".join(f"{module} {size}" for module, size in sizes)
    decided = f"{asked.winner(point.sign)} ahead" if point.sign else "not decided"
    interval = f"[{plain(point.low)}, {plain(point.high)}]"
    return f"{pair}: {signed(point.difference)} pp {interval}, {decided}"
