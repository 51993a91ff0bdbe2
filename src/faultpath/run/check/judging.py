"""Judgement of a system from the runs of a check: eight checks, each with its sentences."""

import math
from collections.abc import Callable, Sequence

from faultpath.core.text import capital
from faultpath.run.check.blocks import MISTAKES, TRIALS, coarsest, gap_of
from faultpath.run.check.delivery import HELD, MOVED, delivery
from faultpath.run.check.remarks import diverged, other_names, successes, without_room
from faultpath.run.check.seen import UNDER, Check, Seen
from faultpath.run.deliveries import unproven, unread
from faultpath.run.findings import Unpaired
from faultpath.run.pairing import unlike

_SEVERAL = 10.0
"""A difference up to this multiple of what a last digit of the readings does may be rounding."""
_FAR = 100.0
"""A reading beyond this multiple of the typical magnitude is in another unit."""
_CAUSES = {
    # Whether two new processes differ, and whether the second run in one of them does.
    (
        True,
        True,
    ): "every run differs: draw from the `rng` of `step` or from faultpath.generator, not from "
    "np.random, and look for clocks and threads.",
    (
        False,
        True,
    ): "the second run in a process differs: keep what a module remembers in its `memory`, or in "
    "variables of run(), and nothing in globals or attributes, such as a counter, a cache or a "
    "generator made once.",
    (
        True,
        False,
    ): "processes differ: look for hash(), id(), the order of a set and the environment.",
    (False, False): "new processes repeat it: look for what other runs leave behind, and threads.",
}


def judged(seen: Seen) -> tuple[Check, ...]:
    """Judge all that was seen."""
    count = sum(len(run.outcomes) for _, run in seen.firsts())
    judges: dict[str, Callable[[str, Seen], Check]] = {
        "determinism": _determinism,
        "scene independence": _independence,
        "pairing": _pairing,
        "declared reads": _reads,
        "fault delivery": delivery,
        "shape and unit": _readings,
        "data files": lambda name, _: Check(name=name, says="Python opened only declared files"),
    }
    ends = {name: run.outcomes for name, run in seen.firsts()}
    trials = sum(len(run.outcomes) for _, run in seen.under())
    says = successes(ends) + (f"; {trials} trials ended under the fault" if trials else "")
    checks = [Check(name=TRIALS, says=says, remarks=without_room(ends))]
    for name, judge in judges.items():
        none = Check(name=name, says="no variant ran to its end", judged=False)
        checks.append(judge(name, seen) if count else none)
    for at, check in enumerate(checks):
        # Backwards: of several runs with the same error the first one names it.
        stopped = {
            run.error: f"'{variant}'{f', {why}' if why.startswith(UNDER) else ''}"
            for (variant, why, _), run in reversed(seen.runs.items())
            if run.fails == check.name and why not in ("tap", HELD, MOVED)
        }
        errors = tuple(
            f"Variant {name}: {error}{'' if check.name in MISTAKES else remedy(error)}."
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
    failures = list[str]()
    for variant in seen.unsteady():
        cause = (
            "draw from the `rng` of `step` or from faultpath.generator, not from np.random, and "
            "keep what a module remembers in its `memory`, or in variables of run(), not in "
            "globals or attributes; in worker processes, a check can tell the two apart."
        )
        if seen.apart:
            between = bool(seen.differs(variant, "anew", "alone"))
            cause = _CAUSES[between, bool(seen.differs(variant, "repeated", "anew"))]
        differs = seen.differs(variant, "again")
        failures.append(f"Variant '{variant}' run twice over the same scenes {differs}; {cause}")
    where = "in two processes and twice in one" if seen.apart else "twice in one process"
    says = f"run {where}, {'other' if failures else 'the same'} bits"
    return Check(name=name, says=says, failures=tuple(failures))


def _independence(name: str, seen: Seen) -> Check:
    """Check that a scene's result depends neither on the others nor on their order."""
    if seen.unsteady():
        return Check(name=name, says="results do not repeat in any order", judged=False)
    if len(seen.scenes) < 2:
        return Check(name=name, says="one scene has no others beside it", judged=False)
    failures, remarks, open_ended = list[str](), list[str](), False
    for variant, first in seen.firsts():
        if not (differs := seen.differs(variant, "part")):
            continue
        lead = f"Variant '{variant}' run in another order, without some of the scenes beside it,"
        gap, rounding = (gap_of(first, seen.of(variant, why)) for why in ("part", "rounded"))
        if gap > _SEVERAL * max(rounding, coarsest(first)):
            failures.append(
                f"{lead} {differs}; let nothing that scenes of one call of run() share decide a "
                "result, draw by scene, and wrap a torch module in faultpath.system.row_wise."
            )
        elif math.isinf(gap):
            open_ended = True
            remarks.append(
                f"{lead} {differs}; but so it does where readings change in their last digits, and "
                "rounding cannot be told from dependence: use faultpath.system.row_wise."
            )
        else:
            size = f"by at most {gap:.1g} of a value" if gap else "in digits that no sum shows"
            remarks.append(
                f"{lead} differs by rounding alone, {size}, as it does where readings change in "
                "their last digits: only with blocks of the same scenes does an audit repeat to "
                "the bit."
            )
    bits = "other bits" if failures else "the same to rounding" if remarks else "the same bits"
    says = f"in another order and without some others, {bits}"
    if open_ended and not failures:
        says = "a last digit decides how scenes end"
    sentences = {"failures": tuple(failures), "remarks": tuple(remarks)}
    return Check(name=name, says=says, judged=not open_ended, **sentences)


def _pairing(name: str, seen: Seen) -> Check:
    """Check that two treatments meet the same conditions in each scene."""
    if seen.unsteady():
        return Check(name=name, says="results do not repeat, so no two are a pair", judged=False)
    firsts = list(seen.firsts())
    groups = [((variant, "correct inputs"), run) for variant, run in firsts]
    faulted = ((variant, seen.of(variant, "faulted")) for variant, _ in firsts)
    groups += [((variant, "a fault"), run) for variant, run in faulted if run.outcomes]
    (one, base), *others = groups
    unpaired = [
        Unpaired(first=one, second=two, scene=a.scene, seed=seen.seed, differences=causes)
        for two, run in others
        for a, b in zip(base.outcomes, run.outcomes, strict=True)
        if (causes := unlike(a, b))
    ]
    remedy = "draw what a scene meets by scene and seed, whatever the variant and the fault."
    failures = [
        f"{capital(str(found)).rstrip('.')}; {remedy}" for found in Unpaired.first_of(unpaired)
    ]
    met = (o.met for _, run in firsts for o in run.outcomes if not o.failed)
    failures += map(str, unproven(met))
    says = f"in {len(groups)} runs of a scene"
    if not failures:
        says = f"the same initial states, disturbances and planner noise {says}"
    return Check(name=name, says=says, failures=tuple(failures))


def _reads(name: str, seen: Seen) -> Check:
    """Check that what is declared to be read is read."""
    counts = ((variant, count) for variant, run in seen.firsts() for count in run.counts)
    failures = tuple(map(str, unread(counts)))
    taps = sum(len({read.tap for read in run.reads}) for _, run in seen.firsts())
    remarks = other_names(seen.system, [variant for variant, _ in seen.firsts()])
    says = f"{taps} injection points declared and read"
    return Check(name=name, says=says, failures=failures, remarks=remarks)


def _readings(name: str, seen: Seen) -> Check:
    """Check that sources give finite numbers of their unit; taps refuse other shapes themselves."""
    failures: dict[str, str] = {}
    spans: dict[str, tuple[float, float]] = {}
    firsts = [(f"Variant '{variant}'", run) for variant, run in seen.firsts()]
    for label, read in (
        (label, read) for label, run in (*firsts, *seen.under()) for read in run.reads
    ):
        if read.lost:
            failures.setdefault(
                read.source,
                f"{label}: source '{read.source}' at step {read.step}, read by {read.reader}, "
                f"is not finite in scene {read.lost!r}; give a number at every step.",
            )
    kinds: dict[str, set[str]] = {}
    for read in (read for _, run in firsts for read in run.reads):
        low, high = spans.get(read.source, (read.low, read.high))
        spans[read.source] = min(low, read.low), max(high, read.high)
        if read.valid_step >= 0:  # `before`, its value before the first step, is always a float
            kinds.setdefault(read.source, set()).add(read.dtype)
    shown: list[str] = []
    for source in seen.system.interface.sources:
        low, high = spans.get(source.name, (math.inf, -math.inf))
        if low > high:
            continue
        shown.append(f"{source.name} {low:.3g} to {high:.3g} {source.unit}".removesuffix(" 1"))
        whole = sorted(kind for kind in kinds.get(source.name, ()) if "int" in kind)
        if whole and (source.unit != "1" or any("float" in kind for kind in kinds[source.name])):
            failures[f"{source.name} whole"] = (
                f"Source '{source.name}' gives whole numbers ({whole[0]}) of unit {source.unit}: "
                "what is put into such an array loses its fraction, and no fault can scale or "
                "shift it; give floats, or the unit '1' where it counts something."
            )
        most = max(abs(low), abs(high))
        if source.scale and most and not 1 / _FAR <= most / source.scale <= _FAR:
            failures[f"{source.name} far"] = (
                f"Source '{source.name}' declares a typical magnitude of {source.scale:g} "
                f"{source.unit}, but its largest reading is {most:.3g}; give it in {source.unit}, "
                "or correct the declared unit or scale."
            )
    wrong, says = tuple(failures.values()), ", ".join(shown)
    return Check(name=name, says=says, failures=wrong, remarks=diverged(spans))
