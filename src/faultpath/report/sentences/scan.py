"""Sentences on a scan: which errors cancel, what that means, and what was left out."""

import shlex
from collections.abc import Iterator, Sequence

from faultpath.analyses.effects import FLOOR_PERCENT
from faultpath.analyses.scan.model import ScanError, ScannedPair, ScannedVersion, ScanResult
from faultpath.core.text import capital, counted, series
from faultpath.faults import FaultText
from faultpath.report.sentences.phrases import NO_RESULT, scenes_like_these
from faultpath.report.sentences.wording import MINUS, in_words, unit
from faultpath.stats.estimate import ALPHA

HELPS = ALPHA / 2
"""Level at which an error raises success."""
FEW_SCENES = 30
"""With fewer scenes for pairs, a scan says that it can show little of them."""
ANY_REPAIR = "REPAIR"
"""Stands in a command for the name of a variant that only its reader knows."""


def size(error: ScanError) -> str:
    """Return the size of an error: `+20 %`, `−0.1 m`, or `(+1, 0, 0) m`."""
    factor, ending = (100.0, " %") if error.relative else (1.0, f" {unit(error.unit)}")
    numbers = [f"{factor * part:+.3g}" if part else "0" for part in error.change]
    text = numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
    shown = f"{text}{ending}".replace("-", MINUS).removesuffix(" 1").rstrip()
    options = FaultText.read(error.fault).options
    return ", ".join([shown, *(f"{name}={value}" for name, value in options.items())])


def named(error: ScanError) -> str:
    """Return an error in words: `gain at controller (+20 %)`."""
    text = size(error)
    return f"{in_words(error.source)} at {error.reader} {text if text[0] == '(' else f'({text})'}"


def rate(percent: float) -> str:
    """Return a success rate: `79 %`."""
    return f"{percent:.0f} %"


def headline(result: ScanResult) -> str:
    """Return which errors cancel, in each version."""
    if result.invalid:
        return NO_RESULT[result.invalid]
    texts = [_in_short(result, version) for version in result.versions]
    if len(texts) == 1:
        return f"{capital(texts[0])}."
    names = (version.variant for version in result.versions)
    return " ".join(f"In {name}, {text}." for name, text in zip(names, texts, strict=True))


def _in_short(result: ScanResult, version: ScannedVersion) -> str:
    listed = version.listed
    if not listed:
        return "no pair of errors is shown to cancel"
    cancelling = [pair for pair in listed if pair.kind == "cancel"]
    best = max(cancelling or listed, key=lambda pair: pair.gain)
    if not cancelling:
        return f"no pair of errors is shown to cancel, but {_covers(result, best)}"
    if len(cancelling) == 1:
        return f"{_both(result, best)} cancel: {_rates(best)}"
    return (
        f"{len(cancelling)} pairs of errors cancel, such as {_both(result, best)}: {_rates(best)}"
    )


def sentences(result: ScanResult) -> tuple[str, ...]:
    """Return what the scan found, sentence by sentence, then what it left out."""
    if result.invalid:
        return ()
    results = *_results(result), *_idle(result), *_halved(result), _counts(result)
    return *results, *_left_out(result)


def _results(result: ScanResult) -> Iterator[str]:
    for version in result.versions:
        before = f"In {version.variant}: " if len(result.versions) > 1 else ""
        for pair in version.listed:
            yield before + of_pair(result, pair)
        hurting = [single for single in version.singles if single.kind == "hurts"]
        if hurting:
            names = [
                f"{named(result.errors[single.error])} {rate(single.alone)}"
                for single in sorted(hurting, key=lambda single: single.alone)
            ]
            none = rate(hurting[0].none)
            yield f"{before}Alone, these cost success ({none} without an error): {series(names)}."
        if helping := [stage for stage in version.first if stage.helps_p <= HELPS]:
            names = [f"{named(stage.error)} {rate(stage.alone)}" for stage in helping]
            none = rate(helping[0].none)
            yield (
                f"{before}Alone, these raised success in the first stage ({none} without an "
                f"error): {series(names)}."
            )


def of_pair(result: ScanResult, pair: ScannedPair) -> str:
    """Return what two errors do to each other, and what follows for who corrects them."""
    if pair.kind == "covers":
        return f"{capital(_covers(result, pair))}."
    first, second = (result.errors[place] for place in pair.errors)
    one, other = f"only the {in_words(first.source)}", f"only the {in_words(second.source)}"
    if first.source == second.source:
        one, other = (f"it only at {error.reader}" for error in (first, second))
    return (
        f"{capital(_both(result, pair))} cancel: {_rates(pair)}. Correct {one}: "
        f"{rate(pair.second)}. Correct {other}: {rate(pair.first)}. Correct both together."
    )


def _both(result: ScanResult, pair: ScannedPair) -> str:
    first, second = (named(result.errors[place]) for place in pair.errors)
    return f"{first} and {second}"


def _rates(pair: ScannedPair) -> str:
    return f"{rate(pair.both)} with both, {rate(pair.none)} with neither"


def _covers(result: ScanResult, pair: ScannedPair) -> str:
    rates = dict(zip(pair.errors, (pair.first, pair.second), strict=True))
    (covering,) = {*pair.errors} - {pair.worse}
    worse, other = result.errors[pair.worse], result.errors[covering]
    return (
        f"{named(other)} covers for {named(worse)}: {_rates(pair)}, {rate(rates[pair.worse])} with "
        f"the one at {worse.reader} alone, {rate(rates[covering])} with the one at {other.reader} "
        "alone"
    )


def _halved(result: ScanResult) -> Iterator[str]:
    """Say which sizes were halved, those of a source together where they are equal."""
    sizes: dict[str, list[str]] = {}
    for error in result.errors:
        if error.halvings:
            alike = [other for other in result.errors if other.source == error.source]
            same = len({tuple(map(abs, other.change)) for other in alike}) == 1
            place = in_words(error.source) + ("" if same else f" at {error.reader}")
            shown = size(error)
            opposite = {size(other) for other in alike if other.sign != error.sign}
            if same and len(error.change) == 1 and opposite:
                shown = f"±{shown[1:]}"
            if shown not in sizes.setdefault(place, []):
                sizes[place].append(shown)
    if sizes:
        texts = [f"{place} to {' and '.join(shown)}" for place, shown in sizes.items()]
        yield (
            "Errors that cost more than 50 percentage points were halved, at all readers of the "
            f"source: {series(texts)}."
        )


def _idle(result: ScanResult) -> Iterator[str]:
    """Say which errors changed no reading."""
    for version in result.versions:
        before = f"In {version.variant}: " if len(result.versions) > 1 else ""
        if names := [named(first.error) for first in version.first if not first.acted]:
            yield f"{before}No reading was ever changed by {series(names)}: nothing was tested."


def _counts(result: ScanResult) -> str:
    chosen, total = len(result.chosen), len(result.errors)
    first, second = result.scenes
    if not chosen:
        return (
            f"Of {counted(total, 'error')}, each run alone in {counted(first, 'scene')}, none is "
            "seen to cost success, so no pair was tested."
        )
    pairs, alone = len(result.versions[0].pairs), len(result.versions[0].singles)
    same = alone - chosen
    others = f", with {same} more at other readers of the same sources" if same else ""
    return (
        f"Of {counted(total, 'error')}, each run alone in {counted(first, 'scene')}, {chosen} "
        f"seemed to cost success and went on{others}; {counted(pairs, 'pair')} ran in {second} "
        "other scenes."
    )


def _left_out(result: ScanResult) -> Iterator[str]:
    """Say what was not scanned or may have been missed, and how far the list holds."""
    scenes = result.scenes[1]
    if result.chosen and scenes < FEW_SCENES:
        yield (
            f"In {counted(scenes, 'scene')} only pairs that cancel nearly completely are seen: a "
            "pair that is not listed may cancel as well. A larger library leaves more scenes for "
            "pairs."
        )
    if names := [s.name for s in result.ranking.sources if not s.fault and not s.at]:
        yield f"Without a declared size, and so not scanned: {series(names)}; --fault gives one."
    for version in result.versions:
        if version.first[0].none < FLOOR_PERCENT:
            yield (
                f"In {version.variant} only {rate(version.first[0].none)} succeed without an "
                "error, so that none can cost much: choose easier scenes."
            )
    if result.failed:
        scenes = "its scene does" if result.failed == 1 else "their scenes do"
        yield (
            f"{counted(result.failed, 'trial')} failed, and {scenes} not count there: what is "
            "listed holds if failing has nothing to do with how a trial would have ended."
        )
    apart = " Versions are tested separately." if len(result.versions) > 1 else ""
    yield (
        f"What is listed holds for {scenes_like_these(result.facts)}, at these sizes. Nothing is "
        f"claimed of other pairs, nor that any errors add up.{apart}"
    )


def commands(result: ScanResult) -> tuple[str, ...]:
    """Return a command for each listed pair that audits a repair under these errors."""
    question, facts = result.question, result.facts
    if facts.system.endswith(" object"):
        return ()
    listed = {pair.errors for version in result.versions for pair in version.listed}
    repair = question.repair or facts.other or ANY_REPAIR
    options = [f"--set={key}={value}" for key, value in question.options.items()]
    words = ["faultpath", "audit", facts.system, *options]
    words += ["--baseline", question.variant, "--repair", repair, "--fault"]
    return tuple(shlex.join([*words, _fault(result, places)]) for places in sorted(listed))


def _fault(result: ScanResult, places: Sequence[int]) -> str:
    """Return both errors as one fault; it names no readers where it reaches all of them."""
    first, second = (result.errors[place] for place in places)
    if first.fault != second.fault:
        return f"{first.text} & {second.text}"
    alike = [e for e in result.errors if (e.source, e.sign) == (first.source, first.sign)]
    whole = len(alike) == 2 and all(error.at == (error.reader,) for error in alike)
    return first.fault if whole else f"{first.fault}@{'+'.join((*first.at, *second.at))}"
