"""What the flights of a check say of a system: seven checks, each a verdict and its sentences."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from faultpath.core.results import Result
from faultpath.systems.checks.flights import MISTAKES, TRIALS, Flight, Flown
from faultpath.trials import Outcome, System, Variant
from faultpath.trials.attempt import Done
from faultpath.trials.deliveries import unproven, unread
from faultpath.trials.execution.again import difference
from faultpath.trials.pairing import Mismatch, Side, mismatch_words, unlike

_FEW = 1e-12
"""Of a number in double precision: what other orders of a sum leave after some steps."""
_FAR = 100.0
"""So many times the typical magnitude is another unit."""
_NOTHING = "no variant ran to its end"


class Check(Result):
    """One thing that was looked at."""

    name: str
    says: str
    """What was seen, or why nothing could be, in a line."""
    failures: tuple[str, ...] = ()
    """A sentence each: what is wrong, where, and what to do."""
    remarks: tuple[str, ...] = ()
    """What may be a mistake and may be none."""
    judged: bool = True

    @property
    def status(self) -> Literal["passed", "failed", "not judged"]:
        """How it ended."""
        if self.failures:
            return "failed"
        return "passed" if self.judged else "not judged"


@dataclass
class Seen:
    """The flights of a check, by variant, why they were flown, and the tap that was struck."""

    system: System
    variants: tuple[Variant, ...]
    scenes: tuple[str, ...]
    seed: int
    apart: bool
    """Whether flights were repeated in processes of their own."""
    flights: dict[tuple[str, str, tuple[str, str]], tuple[Flight, Flown]] = field(
        default_factory=dict[tuple[str, str, tuple[str, str]], tuple[Flight, Flown]]
    )

    def of(self, variant: str, why: str) -> Flown:
        """Return what was seen of a flight; nothing where there was none."""
        return self.flights.get((variant, why, ("", "")), (None, Flown()))[1]

    def firsts(self) -> Iterator[tuple[str, Flown]]:
        """Yield the first flight, under correct inputs, of each variant that ran to its end."""
        for variant in self.variants:
            flown = self.of(variant.name, "first")
            if flown.outcomes and not flown.error:
                yield variant.name, flown

    def errors(self, check: str) -> list[str]:
        """Return what stopped flights that were not struck, as far as `check` reports it."""
        found = {
            flown.error: variant
            for (variant, why, _), (_, flown) in reversed(self.flights.items())
            if flown.blames == check and why != "struck"
        }
        return [f"Variant '{variant}': {error}" for error, variant in found.items()]


def checks(seen: Seen) -> tuple[Check, ...]:
    """Judge all that was seen."""
    flew = any(True for _ in seen.firsts())
    asked: dict[str, Callable[[Seen], Check]] = {
        "determinism": _determinism,
        "scene independence": _independence,
        "pairing": _pairing,
        "declared reads": _reads,
        "fault delivery": _delivery,
        "shape and unit": _readings,
    }
    found = [_trials(seen)]
    for name, judge in asked.items():
        errors = tuple(f"{said}." for said in seen.errors(name)) if name in MISTAKES else ()
        made = judge(seen) if flew else Check(name=name, says=_NOTHING, judged=False)
        found.append(made.model_copy(update={"failures": (*errors, *made.failures)}))
    return tuple(found)


def _trials(seen: Seen) -> Check:
    """Every trial ends in an outcome."""
    failures = [
        f"{said}; let every trial end in an outcome, see it with `faultpath audit --workers 0`."
        for said in seen.errors(TRIALS)
    ]
    count = sum(len(flown.outcomes) for _, flown in seen.firsts())
    return Check(name=TRIALS, says=f"{count} under correct inputs", failures=tuple(failures))


def _determinism(seen: Seen) -> Check:
    """The same scenes twice give the same bits."""
    failures = tuple(
        f"Variant '{name}' flown twice over the same scenes {differs}; take random numbers from "
        "faultpath.generator, and look for threads, hash(), clocks and what is kept between calls."
        for name, _ in seen.firsts()
        if (differs := _differs(seen, name, "again"))
    )
    where = "in two processes" if seen.apart else "in one process"
    return Check(name="determinism", says=f"flown twice {where}, the same bits", failures=failures)


def _independence(seen: Seen) -> Check:
    """A scene's result depends neither on the others nor on their order."""
    name = "scene independence"
    if _determinism(seen).failures:
        return Check(name=name, says="results do not repeat in any order", judged=False)
    if len(seen.scenes) < 2:
        return Check(name=name, says="one scene has no others beside it", judged=False)
    kinds = {read.dtype for _, first in seen.firsts() for read in first.reads}
    coarsest = max((float(np.finfo(k).eps) for k in kinds if k.startswith("float")), default=0.0)
    failures, remarks = list[str](), list[str]()
    for variant, first in seen.firsts():
        if not (differs := _differs(seen, variant, "part")):
            continue
        gap = _gap(first.outcomes, seen.of(variant, "part").outcomes)
        flown = f"Variant '{variant}' flown in another order, without some of the scenes beside it,"
        if gap <= max(_FEW, 4 * coarsest):
            remarks.append(
                f"{flown} differs by rounding alone, at most {gap:.1g} of a number's size: only "
                "with blocks of the same scenes does an audit repeat to the bit."
            )
        else:
            failures.append(
                f"{flown} {differs}; let nothing that scenes of one call of run() share decide a "
                "result, and draw by scene."
            )
    bits = "to rounding" if remarks else "bits"
    says = f"in another order and without some others, the same {bits}"
    return Check(name=name, says=says, failures=tuple(failures), remarks=tuple(remarks))


def _differs(seen: Seen, variant: str, why: str) -> str:
    """Say how a second flight of a variant differs from the first; empty where it does not."""
    first, again = seen.of(variant, "first"), seen.of(variant, why)
    if again.error:
        return f"fails where the first did not ({again.error})"
    if not again.outcomes:
        return ""
    dt_s = seen.system.control_dt_s
    then, now = first.readings(dt_s), again.readings(dt_s)
    unlike = [key for key, digest in now.items() if then.get(key, digest) != digest]
    by_scene = {outcome.scene: outcome for outcome in first.outcomes}
    before = [by_scene[outcome.scene] for outcome in again.outcomes]
    differs = difference(before, Done(again.outcomes, (), 0.0))
    if not differs and not unlike:
        return ""
    said = differs or "differs in its readings alone"
    if unlike:
        scene, step, channel, consumer = min(unlike, key=lambda key: key[1])
        said += f", first at step {step} in tap {channel} -> {consumer}, scene {scene!r}"
    return said


def _gap(first: Sequence[Outcome], again: Sequence[Outcome]) -> float:
    """Return by how much of their size numbers differ at most; infinite for another end."""
    by_scene, worst = {outcome.scene: outcome for outcome in first}, 0.0 if again else math.inf
    for b in again:
        a = by_scene[b.scene]
        ends = [
            (o.status, o.initial_hash, o.disturbance_hash, o.planner_noise_hash) for o in (a, b)
        ]
        if ends[0] != ends[1] or set(a.metrics) != set(b.metrics):
            return math.inf
        numbers = [(a.time_s, b.time_s, a.time_s)]
        for name, value in a.metrics.items():
            whole = max(abs(each.metrics[name] or 0.0) for each in first)
            numbers.append((value or 0.0, b.metrics[name] or 0.0, whole))
        worst = max(worst, *(abs(x - y) / whole if x != y else 0.0 for x, y, whole in numbers))
    return worst


def _pairing(seen: Seen) -> Check:
    """Two arms meet the same conditions in each scene."""
    flown = list(seen.firsts())
    sides = [(Side(name, "correct inputs"), each) for name, each in flown]
    faulted = ((name, seen.of(name, "faulted")) for name, _ in flown)
    sides += [(Side(name, "a fault"), each) for name, each in faulted if each.outcomes]
    (one, base), *others = sides
    mismatches = [
        Mismatch(one, two, a.scene, seen.seed, found)
        for two, each in others
        for a, b in zip(base.outcomes, each.outcomes, strict=True)
        if (found := unlike(a, b))
    ]
    remedy = "draw what a scene meets by scene and seed, whatever the variant and the fault."
    failures = [
        f"{said[0].upper()}{said[1:].rstrip('.')}; {remedy}" for said in mismatch_words(mismatches)
    ]
    failures += unproven([outcome for _, each in flown for outcome in each.outcomes])
    says = f"{len(sides)} arms, the same initial states, disturbances and planner noise"
    return Check(name="pairing", says=says, failures=tuple(failures))


def _reads(seen: Seen) -> Check:
    """What is declared to be read is read."""
    failures = tuple(unread((name, each) for name, flown in seen.firsts() for each in flown.counts))
    count = sum(len({read.tap for read in flown.reads}) for _, flown in seen.firsts())
    return Check(name="declared reads", says=f"{count} taps declared and read", failures=failures)


def _delivery(seen: Seen) -> Check:
    """A fault at a tap alters what its consumer gets, and has an effect."""
    failures, remarks, altered, taps = list[str](), list[str](), 0, 0
    for (variant, why, tap), (flight, flown) in seen.flights.items():
        if why != "struck":
            continue
        taps += 1
        named = f"Tap {tap[0]} -> {tap[1]} of variant '{variant}', struck in {len(flight.scenes)} "
        named += "trials,"
        here = [read for read in flown.reads if read.tap == tap]
        count = sum(read.given[scene] != read.got[scene] for read in here for scene in read.given)
        altered += count
        if flown.blames == "fault delivery":
            failures.append(f"{named} is not reached: {flown.error}.")
        elif not here:
            failures.append(
                f"{named} delivered nothing, though it did without the fault; deliver at every "
                "step that reads, and keep nothing from one call of run() to the next."
            )
        elif not count:
            failures.append(
                f"{named} altered none of its readings; let the source hold numbers that a fault "
                "can change."
            )
        elif not flown.error and not _effective(seen, variant, flown):
            remarks.append(
                f"{named} changed nothing else, in no outcome and at no other tap; a consumer that "
                "is indifferent to it in these scenes looks like this, and so does one that uses "
                "something else than deliver() returned."
            )
    says = f"{taps} taps, each struck by itself: {altered} readings altered, at no other tap"
    return Check(name="fault delivery", says=says, failures=tuple(failures), remarks=tuple(remarks))


def _effective(seen: Seen, variant: str, flown: Flown) -> bool:
    """Return whether a fault at a tap changed anything but what came there."""
    first, dt_s = seen.of(variant, "first"), seen.system.control_dt_s
    then, now = first.readings(dt_s), flown.readings(dt_s)
    if any(then.get(key) != digest for key, digest in now.items() if key in then):
        return True
    ends = tuple(replace(each, struck_steps=0, altered_steps=0) for each in flown.outcomes)
    return bool(ends) and bool(difference(first.outcomes, Done(ends, (), 0.0)))


def _readings(seen: Seen) -> Check:
    """Each source gives what it is declared to give."""
    failures: dict[str, str] = {}
    spans: dict[str, tuple[float, float]] = {}
    sources = {source.name: source for source in seen.system.interface.sources}
    for variant, flown in seen.firsts():
        for read in flown.reads:
            source = sources[read.source]
            where = f"Variant '{variant}': source '{source.name}' at step {read.step}, read by "
            where += f"{read.consumer},"
            if read.given and read.shape != source.shape:
                failures.setdefault(
                    source.name,
                    f"{where} has the shape {list(read.shape)} and is declared with "
                    f"{list(source.shape)}; mend one of the two.",
                )
            elif read.lost:
                failures.setdefault(
                    source.name,
                    f"{where} is not finite in scene {read.lost!r}; give a number at every step.",
                )
            low, high = spans.get(read.source, (read.low, read.high))
            spans[read.source] = min(low, read.low), max(high, read.high)
    shown: list[str] = []
    for name, (low, high) in spans.items():
        source, most = sources[name], max(abs(low), abs(high))
        if low <= high:
            shown.append(f"{name} {low:.3g} to {high:.3g} {source.unit}".removesuffix(" 1"))
        if source.scale is None or not 0.0 < most < math.inf:
            continue
        if not source.scale / _FAR <= most <= source.scale * _FAR:
            failures[f"{name} far"] = (
                f"Source '{name}' declares a typical magnitude of {source.scale:g} {source.unit}, "
                f"but its largest reading is {most:.3g}; give it in {source.unit}, or mend the "
                "declared unit or scale."
            )
    return Check(name="shape and unit", says=", ".join(shown), failures=tuple(failures.values()))
