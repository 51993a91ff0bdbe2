"""Findings of `check` and `trace` in words: what is wrong, where, and what to do."""

from faultpath.core.text import capital, counted, listed
from faultpath.interface import module_of
from faultpath.report.sentences import findings
from faultpath.run.check.results import (
    Checked,
    Compared,
    Difference,
    Diverged,
    Ends,
    Faulted,
    NoneEnded,
    NoRoom,
    NotFinite,
    NothingChanged,
    OrderMatters,
    OtherMagnitude,
    Problem,
    Reads,
    Repeated,
    Spans,
    Stopped,
    TapFault,
    TwoNames,
    Unsteady,
    WholeNumbers,
)
from faultpath.run.check.tracing import (
    EndedEarly,
    NeverRead,
    PermittedRead,
    TraceFinding,
    TruthRead,
)
from faultpath.run.findings import Unpaired, Unproven, Unread

_UNJUDGED = {
    "none ended": "no variant ran to its end",
    "one scene": "one scene has no others beside it",
    "last digit": "a last digit decides how scenes end",
    "order of unsteady": "results do not repeat in any order",
    "pairs of unsteady": "results do not repeat, so no two are a pair",
}
_NO_ROOM = {
    True: (
        "all",
        "an audit could show no repair of such a baseline to be better under correct inputs: "
        "choose a library of harder scenes, or a stricter rule of success",
    ),
    False: (
        "none",
        "an audit could show no fault and no repair to make such a baseline worse: choose a "
        "library of easier scenes, or a milder rule of success",
    ),
}
_CAUSES = {
    # Whether two new processes differ, and whether the second run in one of them does.
    (True, True): (
        "every run differs: draw from the `rng` of `step` or from faultpath.generator, not from "
        "np.random, and look for clocks and threads."
    ),
    (False, True): (
        "the second run in a process differs: keep what a module remembers in its `memory`, or in "
        "variables of run(), and nothing in globals or attributes, such as a counter, a cache or a "
        "generator made once."
    ),
    (True, False): (
        "processes differ: look for hash(), id(), the order of a set and the environment."
    ),
    (False, False): (
        "new processes repeat it: look for what other runs leave behind, and threads."
    ),
    None: (
        "draw from the `rng` of `step` or from faultpath.generator, not from np.random, and "
        "keep what a module remembers in its `memory`, or in variables of run(), not in "
        "globals or attributes; in worker processes, a check can tell the two apart."
    ),
}


def summary(check: Checked) -> str:
    """Return the line of a check: what was seen, or why nothing could be."""
    if check.unjudged and not (check.unjudged == "last digit" and check.failures):
        return _UNJUDGED[check.unjudged]
    match check.summary:
        case NoneEnded(see):
            return f"none did; see {_checks(see)}" if see else "none did"
        case Ends(successes, under_fault):
            trials = sum(total for _, _, total in successes)
            counts = ", ".join(f"{name} {count} of {total}" for name, count, total in successes)
            text = f"{trials} under correct inputs; successes: {counts}"
            under = f"; {counted(under_fault, 'trial')} ended under the fault"
            return text + (under if under_fault else "")
        case Repeated(processes):
            where = "in two processes and twice in one" if processes else "twice in one process"
            return f"run {where}, {'other' if check.failures else 'the same'} bits"
        case Compared(runs):
            same = "the same initial states, disturbances and planner noise "
            return f"{'' if check.failures else same}in {runs} runs of a scene"
        case Reads(taps):
            return f"{counted(taps, 'injection point')} declared and read"
        case Faulted(taps, altered, elsewhere):
            points, readings = counted(taps, "injection point"), counted(altered, "reading")
            return (
                f"{points}, each faulted alone: {readings} altered, {elsewhere or 'none'} elsewhere"
            )
        case Spans(sources):
            return ", ".join(
                f"{name} {low:.3g} to {high:.3g} {unit}".removesuffix(" 1")
                for name, low, high, unit in sources
            )
        case None if check.name == "data files":
            return "Python opened only declared files"
        case None:
            bits = "the same to rounding" if check.remarks else "the same bits"
            bits = "other bits" if check.failures else bits
            return f"in another order and without some others, {bits}"


def describe(problem: Problem) -> str:
    """Return what is wrong, or may be, as a sentence."""
    match problem:
        case Stopped():
            advice = remedy(problem.error) if problem.in_trial else ""
            return f"Variant {_under(problem.variant, problem.condition)}: {problem.error}{advice}."
        case NoneEnded(see):
            return f"No trial of any variant ended: correct first what {_checks(see)} says."
        case NoRoom(variants):
            how, therefore = _NO_ROOM[problem.succeed]
            names = ", ".join(f"'{name}'" for name in variants)
            who = f"Variants {names} succeed" if variants[1:] else f"Variant {names} succeeds"
            scenes = f"{problem.scenes} checked scenes without a fault"
            return f"{who} in {how} of {scenes}; {therefore}."
        case Unsteady():
            return (
                f"Variant '{problem.variant}' run twice over the same scenes "
                f"{_difference(problem.difference)}; {_CAUSES[problem.cause]}"
            )
        case OrderMatters():
            return _order(problem)
        case Unpaired():
            sentence = capital(findings.describe(problem)).rstrip(".")
            return (
                f"{sentence}; draw what a scene meets by scene and seed, whatever the variant and "
                "the fault."
            )
        case Unproven() | Unread():
            return findings.describe(problem)
        case TwoNames():
            (first, one), (second, other) = problem.first, problem.second
            return (
                f"Modules '{first}' of {one} and '{second}' of {other} read "
                f"{listed(problem.reads)} and write {listed(problem.writes)}; a fault at either "
                "one alone reaches one of the two variants. To fault both, give them one name: "
                f'@writes(..., name="{first}").'
            )
        case NothingChanged(variant, condition):
            return (
                f"Variant {_under(variant, condition)}: it changed no reading, so an audit would "
                "test nothing there."
            )
        case NotFinite():
            at = f"source '{problem.source}' at step {problem.step}, read by {problem.reader}"
            return (
                f"Variant {_under(problem.variant, problem.condition)}: {at}, is not finite in "
                f"scene {problem.scene!r}; give a number at every step."
            )
        case WholeNumbers():
            return (
                f"Source '{problem.source}' gives whole numbers ({problem.dtype}) of unit "
                f"{problem.unit}: what is put into such an array loses its fraction, and no fault "
                "can scale or shift it; give floats, or the unit '1' where it counts something."
            )
        case OtherMagnitude():
            return (
                f"Source '{problem.source}' declares a typical magnitude of {problem.declared:g} "
                f"{problem.unit}, but its largest reading is {problem.largest:.3g}; give it in "
                f"{problem.unit}, or correct the declared unit or scale."
            )
        case Diverged():
            return (
                f"Source '{problem.source}' gives readings of up to {problem.largest:.3g}: look "
                "for a loop that is unstable without any fault."
            )
        case TapFault():
            (channel, reader), trials = problem.tap, problem.trials
            point = f"Injection point {channel} -> {reader} of variant '{problem.variant}'"
            return f"{point}, faulted in {counted(trials, 'trial')}, {_tap_fault(problem)}"


def remedy(error: str) -> str:
    """Return what to do about an error that kept a trial from its end."""
    if "truth value of an array" in error:
        return "; a reading has one value for each scene: take `np.where` in place of `if`"
    return "; correct the system: every trial must end in an outcome"


def _checks(names: tuple[str, ...]) -> str:
    return " and ".join(f"*{name}*" for name in names)


def _under(variant: str, condition: str) -> str:
    return f"'{variant}', under the fault ({condition})" if condition else f"'{variant}'"


def _difference(difference: Difference) -> str:
    """Return how a run differs, to follow its subject."""
    if difference.error:
        return f"fails where the first did not ({difference.error})"
    text = str(difference.outcomes or "differs in its readings alone")
    if difference.reading:
        scene, step, channel, reader = difference.reading
        text += f", first at step {step} in {channel} -> {reader}, scene {scene!r}"
    return text


def _order(problem: OrderMatters) -> str:
    lead = f"Variant '{problem.variant}' run in another order, "
    lead += "without some of the scenes beside it,"
    differs, gap = _difference(problem.difference), problem.gap
    if problem.cause == "dependence":
        return (
            f"{lead} {differs}; let nothing that scenes of one call of run() share decide a "
            "result, draw by scene, and wrap a torch module in faultpath.system.row_wise."
        )
    if problem.cause == "last digit":
        return (
            f"{lead} {differs}; but so it does where readings change in their last digits, and "
            "rounding cannot be told from dependence: use faultpath.system.row_wise."
        )
    size = f"by at most {gap:.1g} of a value" if gap else "in digits that no sum shows"
    return (
        f"{lead} differs by rounding alone, {size}, as it does where readings change in "
        "their last digits: only with blocks of the same scenes does an audit repeat to "
        "the bit."
    )


def _tap_fault(fault: TapFault) -> str:
    module = module_of(fault.tap[1])
    match fault.wrong:
        case "alters another tap":
            channel, reader = fault.other
            return (
                f"altered a reading at {channel} -> {reader} too, which the fault does not name; "
                "trust no result of this version of faultpath, and report it."
            )
        case "not delivered":
            if fault.error:
                return f"is not reached: {fault.error}."
            return (
                "delivered nothing, though it did without the fault; deliver at every step that "
                "reads, and keep nothing from one call of run() to the next."
            )
        case "alters nothing":
            return (
                "altered none of its readings; let the source hold numbers that a fault can change."
            )
        case "reads elsewhere":
            return (
                f"had no effect, and '{module}' wrote another {fault.outputs[0]} at step "
                f"{fault.step} in scene {fault.scene!r} where all that it was handed was the same: "
                "it takes a value from elsewhere, past its injection points. Let it use what it is "
                "handed."
            )
        case "no effect" if fault.outputs:
            return (
                f"had no effect because the output of '{module}' never changed in any trial: "
                f"{listed(fault.outputs)} stayed what it is without the fault. Look whether it "
                "uses this reading, and choose scenes in which that matters."
            )
        case "no effect":
            return (
                "changed nothing else, in no outcome and at no other injection point, in the steps "
                "that were looked at; its module may use it later, or not at all, or may use "
                "something else than it was handed: a check can tell where the module writes a "
                "source."
            )


def describe_read(finding: TraceFinding) -> str:
    """Return a read that is privileged or not as declared, as a sentence."""
    match finding:
        case NeverRead():
            first = "step" if finding.steps == 1 else f"{finding.steps} steps"
            return (
                f"Variant '{finding.variant}' declares that {finding.reader} reads "
                f"'{finding.channel}', but in the first {first} it did not; trace more --steps, or "
                "take it out of the variant's readers."
            )
        case EndedEarly(error):
            return f"The run ended early: {error}."
        case PermittedRead(reader, source):
            return f"{reader} reads '{source}', which is privileged, by permission of the variant."
        case TruthRead(module, truth):
            return f"Module '{module}' takes the plant's truth '{truth}' past all taps."
