"""Sentences on a scan: which errors cancel, what that means, and what was left out."""

import shlex
from collections.abc import Iterator

from faultpath.decisions.scan.model import (
    ScanError,
    ScannedPair,
    ScannedVersion,
    ScanResult,
)
from faultpath.decisions.sentences.phrases import NO_RESULT
from faultpath.decisions.sentences.wording import MINUS, capital, counted, series

ANY_REPAIR = "REPAIR"
"""Stands in a command for the name of a variant that only its reader knows."""


def size(error: ScanError) -> str:
    """Return the size of an error: `+20 %`, `−0.1 m`, or `(+1, 0, 0) m`."""
    factor, unit = (100.0, " %") if error.relative else (1.0, f" {error.unit}")
    numbers = [f"{factor * part:+.3g}" if part else "0" for part in error.change]
    text = numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
    return f"{text}{unit}".replace("-", MINUS).removesuffix(" 1").rstrip()


def named(error: ScanError) -> str:
    """Return an error in words: `gain at controller (+20 %)`."""
    return f"{error.source} at {error.reader} ({size(error)})"


def whole(percent: float) -> str:
    """Return a success rate."""
    return f"{percent:.0f} %"


def headline(record: ScanResult) -> str:
    """Return which errors cancel, in each version."""
    if record.invalid:
        return NO_RESULT[record.invalid]
    texts = [_in_short(record, version) for version in record.versions]
    if len(texts) == 1:
        return f"{capital(texts[0])}."
    names = (version.variant for version in record.versions)
    return " ".join(f"In {name}, {text}." for name, text in zip(names, texts, strict=True))


def _in_short(record: ScanResult, version: ScannedVersion) -> str:
    cancelling = [pair for pair in version.listed if pair.kind == "cancel"]
    covering = [pair for pair in version.listed if pair.kind == "covers"]
    if cancelling:
        best = max(cancelling, key=lambda pair: pair.gain)
        count = "" if len(cancelling) == 1 else f"{len(cancelling)} pairs of errors cancel: "
        text = f"{count}{_both(record, best)}"
        text += f" cancel: {_rates(best)}" if not count else f" most, {_rates(best)}"
        return text
    if covering:
        best = max(covering, key=lambda pair: pair.gain)
        return f"no pair of errors is shown to cancel, but {_covers(record, best)}"
    return "no pair of errors is shown to cancel"


def sentences(record: ScanResult) -> tuple[str, ...]:
    """Return what the scan found, sentence by sentence, then what it left out."""
    if record.invalid:
        return ()
    return (*_found(record), *_halved(record), _counts(record), _limits(record))


def _found(record: ScanResult) -> Iterator[str]:
    several = len(record.versions) > 1
    for version in record.versions:
        before = f"{version.variant}: " if several else ""
        for pair in version.listed:
            yield before + in_words(record, pair)
        for kind, verb in (("hurts", "cost success"), ("helps", "raise success")):
            names = [
                f"{named(record.errors[single.error])} {whole(single.alone)}"
                for single in version.singles
                if single.kind == kind
            ]
            if names:
                without = whole(version.singles[0].none)
                yield before + f"Alone, these {verb} ({without} without an error): {series(names)}."


def in_words(record: ScanResult, pair: ScannedPair) -> str:
    """Return what two errors do to each other, and what follows for who corrects them."""
    if pair.kind == "covers":
        return f"{capital(_covers(record, pair))}."
    first, second = (record.errors[place] for place in pair.errors)
    if first.source == second.source:
        short = [f"{error.source} only at {error.reader}" for error in (first, second)]
    else:
        short = [f"only {error.source}" for error in (first, second)]
    return (
        f"{capital(_both(record, pair))} cancel: {_rates(pair)}. Correct {short[0]}: "
        f"{whole(pair.second)}. Correct {short[1]}: {whole(pair.first)}. Correct both together."
    )


def _both(record: ScanResult, pair: ScannedPair) -> str:
    first, second = (named(record.errors[place]) for place in pair.errors)
    return f"{first} and {second}"


def _rates(pair: ScannedPair) -> str:
    return f"{whole(pair.both)} with both, {whole(pair.none)} with neither"


def _covers(record: ScanResult, pair: ScannedPair) -> str:
    at = pair.errors.index(pair.worse)
    worse, other = (record.errors[pair.errors[place]] for place in (at, 1 - at))
    alone = (pair.first, pair.second)
    return (
        f"{named(other)} covers for {named(worse)}: {_rates(pair)}, {whole(alone[at])} with "
        f"{worse.source} wrong at {worse.reader} alone, {whole(alone[1 - at])} at {other.reader} "
        "alone"
    )


def _halved(record: ScanResult) -> Iterator[str]:
    texts: list[str] = []
    for error in record.errors:
        if error.halvings:
            before = error.model_copy(
                update={"change": tuple(part * 2**error.halvings for part in error.change)}
            )
            texts.append(f"{error.source} at {error.reader} from {size(before)} to {size(error)}")
    if texts:
        yield (
            "Halved, because a size of the source cost more than 50 percentage points: "
            f"{series(texts)}."
        )


def _counts(record: ScanResult) -> str:
    chosen, total = len(record.chosen), len(record.errors)
    first, second = record.scenes
    text = f"Of {counted(total, 'error')}, each alone in {counted(first, 'scene')}, "
    if not chosen:
        return f"{text}none cost success there, so no pair was tested."
    pairs = len(record.versions[0].pairs)
    return (
        f"{text}{chosen} cost success there and {total - chosen} were left out; "
        f"{counted(pairs, 'pair')} of those tested in {counted(second, 'other scene')}."
    )


def _limits(record: ScanResult) -> str:
    models = ", for these trained models" if record.question.trained else ""
    apart = " Versions are tested separately." if len(record.versions) > 1 else ""
    return (
        f"What is listed holds for new scenes like these{models}, at these sizes. Of other pairs "
        f"nothing is claimed, and of no pair that its errors add up.{apart}"
    )


def commands(record: ScanResult) -> tuple[str, ...]:
    """Return a command for each listed pair that audits a repair under these errors."""
    question = record.question
    if question.system.endswith(" object"):
        return ()
    listed = {pair.errors for version in record.versions for pair in version.listed}
    repair = question.repair or question.other or ANY_REPAIR
    options = [f"--set={key}={value}" for key, value in question.options.items()]
    lines: list[str] = []
    for places in sorted(listed):
        words = ["faultpath", "audit", question.system, *options, "--baseline", question.variant]
        words += ["--repair", repair, "--fault", _fault(record, places)]
        lines.append(shlex.join(words))
    return tuple(lines)


def _fault(record: ScanResult, places: tuple[int, int]) -> str:
    """Return both errors as one fault: at both readers where their size is the same."""
    first, second = (record.errors[place] for place in places)
    if first.fault == second.fault:
        return f"{first.fault}@{'+'.join((*first.at, *second.at))}"
    return f"{first.text} & {second.text}"
