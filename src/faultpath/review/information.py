"""Whether modules read what the interface declares, and whether faults reach them."""

from collections.abc import Iterator
from dataclasses import replace

from faultpath.execution.attempt import Done
from faultpath.execution.differences import difference
from faultpath.interface import Source
from faultpath.review.flights import Flown
from faultpath.review.report import Check, Struck
from faultpath.review.seen import Seen
from faultpath.taps import Read
from faultpath.trials.deliveries import unread

_FAR = 100.0
"""So many times the typical magnitude is another unit."""


def reads(seen: Seen) -> Check:
    """What runs reads what is declared, and nothing else."""
    failures = dict.fromkeys(f"{said}." for said in seen.errors("reads"))
    count = 0
    for variant, flown in seen.firsts():
        failures |= dict.fromkeys(
            unread(
                (variant, each)
                for each in flown.counts
                if (each.channel, each.consumer) not in flown.refused
            )
        )
        failures |= dict.fromkeys(differences(variant, flown))
        count += len({read.tap for read in flown.reads})
    says = f"{count} taps declared and read" if count else "no variant flew to its end"
    return Check(name="declared reads", says=says, failures=tuple(failures), judged=count > 0)


def differences(variant: str, flown: Flown) -> dict[str, tuple[tuple[str, str], ...]]:
    """Return how a flight differs from what is declared, in sentences, each with its taps.

    What never read at all is not among it: a flight may be too short to tell.
    """
    refused = {f"Variant '{variant}', {said}.": (tap,) for tap, said in flown.refused.items()}
    return refused | dict(_unused(variant, flown)) | dict(_two_readings(variant, flown))


def _unused(variant: str, flown: Flown) -> Iterator[tuple[str, tuple[tuple[str, str], ...]]]:
    looked: dict[tuple[str, str], bool] = {}
    for read in flown.reads:
        looked[read.tap] = looked.get(read.tap, False) or read.used is not False
    for (channel, consumer), used in looked.items():
        if not used:
            said = (
                f"Variant '{variant}' hands '{channel}' to {consumer}, which never looks at it; "
                "take the port out of the module's reads, or use what comes there."
            )
            yield said, ((channel, consumer),)


def _two_readings(variant: str, flown: Flown) -> Iterator[tuple[str, tuple[tuple[str, str], ...]]]:
    """Name channels that bring their consumers different readings of one step."""
    first: dict[tuple[str, str, int, int], Read] = {}
    told: set[str] = set()
    for read in flown.reads:
        if read.asks or read.channel in told:  # askers of a query ask for different things
            continue
        one = first.setdefault((read.channel, read.source, read.step, read.valid_step), read)
        if one.given != read.given:
            told.add(read.channel)
            said = (
                f"Variant '{variant}' gives {one.consumer} and {read.consumer} different readings "
                f"of channel '{read.channel}' at step {read.step}; deliver one reading to both, or "
                "declare a channel for each."
            )
            yield said, (one.tap, read.tap)


def delivery(seen: Seen) -> tuple[Check, tuple[Struck, ...]]:
    """A fault at a tap alters what its consumer gets, nothing at other taps, and has an effect."""
    failures, remarks = [f"{said}." for said in seen.errors("delivery")], list[str]()
    struck: list[Struck] = []
    for variant, first in seen.firsts():
        for channel, consumer in dict.fromkeys(read.tap for read in first.reads):
            why = f"struck {channel} {consumer}"
            if (variant, why) not in seen.flights:
                continue  # nobody declares it, which another check tells
            made = _struck(seen, variant, why, (channel, consumer))
            struck.append(made)
            named = f"Tap {channel} -> {consumer} of variant '{variant}', struck in "
            named += f"{made.trials} trials,"
            if said := _missed(made, seen.of(variant, why)):
                failures.append(f"{named} {said}")
            elif not _told(seen, variant, why):
                remarks.append(f"{named} {_INDIFFERENT}")
    altered = sum(each.altered for each in struck)
    says = (
        f"{len(struck)} taps, each struck by itself: {altered} readings altered, at no other tap"
        if struck
        else "no variant flew to its end"
    )
    check = Check(
        name="fault delivery",
        says=says,
        failures=tuple(failures),
        remarks=tuple(remarks),
        judged=bool(struck),
    )
    return check, tuple(struck)


_INDIFFERENT = (
    "changed nothing else, in no outcome and at no other tap; a consumer that is indifferent to it "
    "in these scenes looks like this, and so does one that uses something else than deliver() "
    "returned."
)


def _struck(seen: Seen, variant: str, why: str, tap: tuple[str, str]) -> Struck:
    flight, flown = seen.flights[variant, why]
    here = [read for read in flown.reads if read.tap == tap]
    altered = [a != b for read in here for a, b in zip(read.given, read.got, strict=True)]
    return Struck(
        variant=variant,
        channel=tap[0],
        consumer=tap[1],
        trials=len(flight.scenes),
        readings=len(altered),
        altered=sum(altered),
    )


def _missed(made: Struck, flown: Flown) -> str:
    """Say what is wrong where a fault did not reach the tap that it strikes."""
    if flown.blames == "delivery":
        return f"is not reached: {flown.error}."
    if not made.readings:
        return (
            "delivered nothing, though it did without the fault; deliver at every step that reads, "
            "and keep nothing from one call of run() to the next."
        )
    if not made.altered:
        return (
            f"altered none of {made.readings} readings; let the source hold numbers that a fault "
            "can change."
        )
    return ""


def _told(seen: Seen, variant: str, why: str) -> bool:
    whole = seen.flights.get((variant, f"{why} whole"), seen.flights[variant, why])[1]
    return bool(whole.error) or effective(seen, variant, whole)


def effective(seen: Seen, variant: str, flown: Flown) -> bool:
    """Return whether a fault at a tap changed anything but what came there."""
    first = seen.of(variant, "first")
    now = {(read.step, *read.tap): read.given for read in flown.reads}
    last = max((step for step, _, _ in now), default=-1)
    then = {(read.step, *read.tap): read.given for read in first.reads if read.step <= last}
    if any(now[key] != given if key in now else key[0] < last for key, given in then.items()):
        return True
    ends = tuple(replace(each, struck_steps=0, altered_steps=0) for each in flown.outcomes)
    return bool(ends) and bool(difference(first.outcomes, Done(ends, (), 0.0)))


def readings(seen: Seen) -> Check:
    """Each source gives what it is declared to give."""
    failures = dict.fromkeys(f"{said}." for said in seen.errors("readings"))
    interface, spans = seen.system.interface, dict[str, tuple[float, float]]()
    declared, wrong = {source.name for source in interface.sources}, set[str]()
    for variant, flown in seen.firsts():
        for read in flown.reads:
            if read.source not in declared:  # which another check tells
                continue
            source = interface.source(read.source)
            if (said := _malformed(source, read, seen.scenes)) and read.source not in wrong:
                failures[f"Variant '{variant}': {said}"] = None
                wrong.add(read.source)
            low, high = spans.get(read.source, (read.low, read.high))
            spans[read.source] = min(low, read.low), max(high, read.high)
    for name, (low, high) in spans.items():
        failures |= dict.fromkeys(_far(interface.source(name), low, high))
    shown = (
        f"{name} {low:.3g} to {high:.3g} {interface.source(name).unit}".removesuffix(" 1")
        for name, (low, high) in spans.items()
        if low <= high
    )
    says = ", ".join(shown) or "no variant flew to its end"
    return Check(name="shape and unit", says=says, failures=tuple(failures), judged=bool(spans))


def _malformed(source: Source, read: Read, scenes: tuple[str, ...]) -> str:
    """Say what is wrong with a reading after the first, which taps let pass."""
    where = f"source '{source.name}' at step {read.step}, read by {read.consumer},"
    if read.given and read.shape != source.shape:
        return (
            f"{where} has the shape {list(read.shape)} and is declared with {list(source.shape)}; "
            "mend one of the two."
        )
    if read.lost:
        return (
            f"{where} is not finite in scene {scenes[read.lost[0]]!r}; give a number at every step."
        )
    return ""


def _far(source: Source, low: float, high: float) -> Iterator[str]:
    """Name a source whose numbers are far from the magnitude that it declares."""
    most = max(abs(low), abs(high))
    if source.scale is None or not 0.0 < most < float("inf"):
        return
    if not source.scale / _FAR <= most <= source.scale * _FAR:
        yield (
            f"Source '{source.name}' declares a typical magnitude of {source.scale:g} "
            f"{source.unit}, but its largest reading is {most:.3g}; give it in {source.unit}, or "
            "mend the declared unit or scale."
        )
