"""Verdicts on a system from the runs of a check: eight checks, each with its sentences."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from faultpath.core.results import Result
from faultpath.systems.checks.blocks import MISTAKES, TRIALS, RecordedBlock, coarsest, gap_of
from faultpath.systems.checks.remarks import diverged, other_names, successes, without_room
from faultpath.trials import System, Variant
from faultpath.trials.attempt import Done
from faultpath.trials.execution.recheck import difference
from faultpath.trials.pairing import Mismatch, Side, mismatch_words, unlike
from faultpath.trials.table import unproven, unread

_SEVERAL = 10.0
"""A difference up to this multiple of what a last digit of the readings does may be rounding."""
_FAR = 100.0
"""A reading beyond this multiple of the typical magnitude is in another unit."""


class Check(Result):
    """One thing that was looked at."""

    name: str
    says: str
    """One line on what was seen, or on why nothing could be."""
    failures: tuple[str, ...] = ()
    """A sentence each: what is wrong, where, and what to do."""
    remarks: tuple[str, ...] = ()
    """Sentences on what may be a mistake and may be none."""
    judged: bool = True

    @property
    def status(self) -> Literal["passed", "failed", "not judged"]:
        """The verdict of the check."""
        if self.failures:
            return "failed"
        return "passed" if self.judged else "not judged"


@dataclass
class Seen:
    """The runs of a check."""

    system: System
    variants: tuple[Variant, ...]
    scenes: tuple[str, ...]
    seed: int
    apart: bool
    """Whether runs were repeated in processes of their own."""
    runs: dict[tuple[str, str, tuple[str, str]], RecordedBlock] = field(
        default_factory=dict[tuple[str, str, tuple[str, str]], RecordedBlock]
    )
    """By variant, why it was run, and the tap that was faulted alone."""

    def of(self, variant: str, why: str) -> RecordedBlock:
        """Return what was recorded of a run; nothing where there was none."""
        return self.runs.get((variant, why, ("", "")), RecordedBlock())

    def firsts(self) -> Iterator[tuple[str, RecordedBlock]]:
        """Yield the first run, under correct inputs, of each variant that came to its end."""
        for variant in self.variants:
            run = self.of(variant.name, "first")
            if run.outcomes:
                yield variant.name, run

    def differs(self, variant: str, why: str) -> str:
        """Say how a second run of a variant differs from the first; empty where it does not."""
        first, again = self.of(variant, "first"), self.of(variant, why)
        if again.error:
            return f"fails where the first did not ({again.error})"
        if not again.outcomes:
            return ""
        dt_s = self.system.control_dt_s
        then = first.readings(dt_s)
        odd = [key for key, digest in again.readings(dt_s).items() if then.get(key) != digest]
        by_scene = {outcome.scene: outcome for outcome in first.outcomes}
        before = [by_scene[outcome.scene] for outcome in again.outcomes]
        words = difference(before, Done(again.outcomes, ()))
        if odd:
            scene, step, channel, consumer = min(odd, key=lambda key: key[1])
            words = words or "differs in its readings alone"
            words += f", first at step {step} in {channel} -> {consumer}, scene {scene!r}"
        return words


def judged(seen: Seen) -> tuple[Check, ...]:
    """Judge all that was seen."""
    count = sum(len(run.outcomes) for _, run in seen.firsts())
    judges: dict[str, Callable[[str, Seen], Check]] = {
        "determinism": _determinism,
        "scene independence": _independence,
        "pairing": _pairing,
        "declared reads": _reads,
        "fault delivery": _delivery,
        "shape and unit": _readings,
        "data files": lambda name, _: Check(name=name, says="Python opened only declared files"),
    }
    ends = {name: run.outcomes for name, run in seen.firsts()}
    checks = [Check(name=TRIALS, says=successes(ends), remarks=without_room(ends))]
    for name, judge in judges.items():
        none = Check(name=name, says="no variant ran to its end", judged=False)
        checks.append(judge(name, seen) if count else none)
    for at, check in enumerate(checks):
        stopped = {
            run.error: variant
            for (variant, why, _), run in reversed(seen.runs.items())
            if run.fails == check.name and why != "tap"
        }
        errors = tuple(
            f"Variant '{name}': {error}{'' if check.name in MISTAKES else remedy(error)}."
            for error, name in stopped.items()
        )
        checks[at] = check.model_copy(update={"failures": (*errors, *check.failures)})
    if not count:
        checks[0] = _none_ended(checks[0], [check.name for check in checks[1:] if check.failures])
    return tuple(checks)


def _none_ended(trials: Check, failed: Sequence[str]) -> Check:
    """Return the check that trials end where none did, which names the failed checks to see."""
    see = " and ".join(f"*{name}*" for name in failed)
    says = f"none did; see {see}" if see else "none did"
    sentence = f"No trial of any variant ended: correct first what {see} says."
    failures = trials.failures or (sentence,)
    return trials.model_copy(update={"says": says, "failures": failures})


def remedy(error: str) -> str:
    """Return what to do about an error that kept a trial from its end."""
    if "truth value of an array" in error:
        return "; a reading has one value for each scene: take `np.where` in place of `if`"
    return "; correct the system: every trial must end in an outcome"


def _determinism(name: str, seen: Seen) -> Check:
    """Check that the same scenes twice give the same bits."""
    failures = tuple(
        f"Variant '{variant}' run twice over the same scenes {differs}; take random numbers from "
        "faultpath.generator, and look for threads, hash(), clocks and what is kept between calls."
        for variant, _ in seen.firsts()
        if (differs := seen.differs(variant, "again"))
    )
    where = f"in {'two processes' if seen.apart else 'one process'}"
    return Check(name=name, says=f"run twice {where}, the same bits", failures=failures)


def _independence(name: str, seen: Seen) -> Check:
    """Check that a scene's result depends neither on the others nor on their order."""
    if any(seen.differs(variant, "again") for variant, _ in seen.firsts()):
        return Check(name=name, says="results do not repeat in any order", judged=False)
    if len(seen.scenes) < 2:
        return Check(name=name, says="one scene has no others beside it", judged=False)
    failures, remarks, open_ended = list[str](), list[str](), False
    dt_s = seen.system.control_dt_s
    for variant, first in seen.firsts():
        if not (differs := seen.differs(variant, "part")):
            continue
        lead = f"Variant '{variant}' run in another order, without some of the scenes beside it,"
        gap, rounding = (gap_of(first, seen.of(variant, why), dt_s) for why in ("part", "rounded"))
        if gap > _SEVERAL * max(rounding, coarsest(first)):
            failures.append(
                f"{lead} {differs}; let nothing that scenes of one call of run() share decide a "
                "result, draw by scene, and wrap a torch module in faultpath.systems.row_wise."
            )
        elif math.isinf(gap):
            open_ended = True
            remarks.append(
                f"{lead} {differs}; but so it does where readings change in their last digits, and "
                "rounding cannot be told from dependence: use faultpath.systems.row_wise."
            )
        else:
            remarks.append(
                f"{lead} differs by rounding alone, at most {gap:.1g} of a number's size, as it "
                "does where readings change in their last digits: only with blocks of the same "
                "scenes does an audit repeat to the bit."
            )
    bits = "to rounding" if remarks else "bits"
    says = f"in another order and without some others, the same {bits}"
    if open_ended and not failures:
        says = "a last digit decides how scenes end"
    sentences = {"failures": tuple(failures), "remarks": tuple(remarks)}
    return Check(name=name, says=says, judged=not open_ended, **sentences)


def _pairing(name: str, seen: Seen) -> Check:
    """Check that two arms meet the same conditions in each scene."""
    firsts = list(seen.firsts())
    sides = [(Side(variant, "correct inputs"), run) for variant, run in firsts]
    faulted = ((variant, seen.of(variant, "faulted")) for variant, _ in firsts)
    sides += [(Side(variant, "a fault"), run) for variant, run in faulted if run.outcomes]
    (one, base), *others = sides
    mismatches = [
        Mismatch(one, two, a.scene, seen.seed, causes)
        for two, run in others
        for a, b in zip(base.outcomes, run.outcomes, strict=True)
        if (causes := unlike(a, b))
    ]
    remedy = "draw what a scene meets by scene and seed, whatever the variant and the fault."
    failures = [
        f"{text[0].upper()}{text[1:].rstrip('.')}; {remedy}" for text in mismatch_words(mismatches)
    ]
    failures += unproven([outcome for _, run in firsts for outcome in run.outcomes])
    says = (
        f"the same initial states, disturbances and planner noise in {len(sides)} runs of a scene"
    )
    return Check(name=name, says=says, failures=tuple(failures))


def _reads(name: str, seen: Seen) -> Check:
    """Check that what is declared to be read is read."""
    failures = tuple(unread((v, count) for v, run in seen.firsts() for count in run.counts))
    taps = sum(len({read.tap for read in run.reads}) for _, run in seen.firsts())
    remarks = other_names(seen.system, [variant for variant, _ in seen.firsts()])
    says = f"{taps} injection points declared and read"
    return Check(name=name, says=says, failures=failures, remarks=remarks)


def _delivery(name: str, seen: Seen) -> Check:
    """Check that a fault at a tap alters what its consumer gets, and has an effect."""
    failures, remarks, dt_s = list[str](), list[str](), seen.system.control_dt_s
    altered, elsewhere = 0, 0
    alone = {key: run for key, run in seen.runs.items() if key[1] == "tap"}
    for (variant, _, tap), run in alone.items():
        lead = f"Injection point {tap[0]} -> {tap[1]} of variant '{variant}', faulted in "
        lead += f"{len(seen.scenes)} trials,"
        here = [read for read in run.reads if read.tap == tap]
        count = sum(read.altered for read in here)
        altered += count
        others = [read for read in run.reads if read.tap != tap and read.altered]
        elsewhere += sum(read.altered for read in others)
        for channel, consumer in dict.fromkeys(read.tap for read in others):
            failures.append(
                f"{lead} altered a reading at {channel} -> {consumer} too, which "
                "the fault does not name; trust no result of this version of faultpath, and report "
                "it."
            )
        first = seen.of(variant, "first")
        clean = first.readings(dt_s)
        faulted = {key: value for key, value in run.readings(dt_s).items() if key in clean}
        ends = tuple(replace(outcome, faulted_steps=0, altered_steps=0) for outcome in run.outcomes)
        if run.fails == name:
            failures.append(f"{lead} is not reached: {run.error}.")
        elif not here:
            failures.append(
                f"{lead} delivered nothing, though it did without the fault; deliver at every "
                "step that reads, and keep nothing from one call of run() to the next."
            )
        elif not count:
            failures.append(
                f"{lead} altered none of its readings; let the source hold numbers that a fault "
                "can change."
            )
        elif (
            not run.error
            and all(clean[key] == value for key, value in faulted.items())
            and not (ends and difference(first.outcomes, Done(ends, ())))
        ):
            remarks.append(
                f"{lead} changed nothing else, in no outcome and at no other injection point, in "
                "the steps that were looked at; its module may use it later, or not at all, or may "
                "use something else than it was handed."
            )
    says = f"{len(alone)} injection points, each faulted alone: {altered} readings altered, "
    says += f"{elsewhere} elsewhere" if elsewhere else "none elsewhere"
    return Check(name=name, says=says, failures=tuple(failures), remarks=tuple(remarks))


def _readings(name: str, seen: Seen) -> Check:
    """Check that sources give finite numbers of their unit; taps refuse other shapes themselves."""
    failures: dict[str, str] = {}
    spans: dict[str, tuple[float, float]] = {}
    for variant, run in seen.firsts():
        for read in run.reads:
            if read.lost:
                failures.setdefault(
                    read.source,
                    f"Variant '{variant}': source '{read.source}' at step {read.step}, read by "
                    f"{read.consumer}, is not finite in scene {read.lost!r}; give a number at "
                    "every step.",
                )
            low, high = spans.get(read.source, (read.low, read.high))
            spans[read.source] = min(low, read.low), max(high, read.high)
    shown: list[str] = []
    for source in seen.system.interface.sources:
        low, high = spans.get(source.name, (math.inf, -math.inf))
        if low > high:
            continue
        shown.append(f"{source.name} {low:.3g} to {high:.3g} {source.unit}".removesuffix(" 1"))
        most = max(abs(low), abs(high))
        if source.scale and most and not 1 / _FAR <= most / source.scale <= _FAR:
            failures[f"{source.name} far"] = (
                f"Source '{source.name}' declares a typical magnitude of {source.scale:g} "
                f"{source.unit}, but its largest reading is {most:.3g}; give it in {source.unit}, "
                "or mend the declared unit or scale."
            )
    wrong, says = tuple(failures.values()), ", ".join(shown)
    return Check(name=name, says=says, failures=wrong, remarks=diverged(spans))
