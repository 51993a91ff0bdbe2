"""Findings in the trials of a result, in words: a reader has to know them."""

from collections.abc import Iterator

from faultpath.analyses.model import AuditResult, where
from faultpath.core.text import capital, counted, series
from faultpath.report.sentences import phrases
from faultpath.report.sentences.wording import signed
from faultpath.run.findings import (
    ExtraTrials,
    Finding,
    MissingTrials,
    NoneFailed,
    RaisedTogether,
    Recheck,
    SeveralTasks,
    Unpaired,
    Unproven,
    Unread,
    Unrecorded,
    Unrepeated,
)
from faultpath.run.trials import HASHES

_COUNTS = {"faulted_steps", "altered_steps"}


def of_audit(result: AuditResult) -> tuple[str, ...]:
    """Return all that was found: what puts all of it in doubt first, then what is missing."""
    return (
        *([phrases.earlier_analyses(result)] if result.earlier else ()),
        *map(describe, result.findings),
        *_without_pairs(result),
        *_failed_trials(result),
        *_partly_measured(result),
    )


def describe(finding: Finding) -> str:
    """Return a finding as a sentence or two."""
    match finding:
        case Unpaired():
            return _unpaired(finding)
        case Unproven():
            return (
                f"All {finding.scenes} scenes carry the same hashes of initial state, disturbance "
                f"and planner noise ({', '.join(map(repr, finding.hashes))}), so nothing proves "
                "that two trials met the same conditions: hash what each scene begins with and "
                "meets."
            )
        case Unread():
            return (
                f"Variant '{finding.variant}' declares that {finding.reader} reads "
                f"'{finding.channel}', but it never did: take it out of the variant's readers, or "
                "deliver the channel to it."
            )
        case Recheck():
            return _recheck(finding)
        case RaisedTogether():
            return (
                f"{finding.blocks} of {finding.of} blocks raised an error when their scenes ran "
                f"together, and none when each ran alone: {finding.error}. A reading holds a value "
                "for each scene of its block: `faultpath check` says what to fix."
            )
        case Unrecorded():
            return f"No signals were recorded: {finding.error}"
        case Unrepeated():
            return (
                f"{finding.trials} of {counted(finding.of, 'trial')} came out otherwise when they "
                "ran again to record signals, which are not kept: the first, "
                f"{finding.variant}, {finding.condition}, {finding.scene}, {finding.deviation}."
            )
        case MissingTrials():
            seed = "seed " if finding.unit == "scene" else ""
            which = f" ({seed}{finding.trial})" if finding.trial else ""
            return (
                f"{capital(where(finding.condition))}, {counted(finding.trials, 'trial')} of "
                f"{finding.variant} {'is' if finding.trials == 1 else 'are'} missing, for example "
                f"that in {finding.first}{which}: pairs that lack a trial do not count."
            )
        case ExtraTrials():
            return (
                f"{counted(finding.units, finding.unit)} {'has' if finding.units == 1 else 'have'} "
                f"more trials than the others, for example {finding.first}: the extra trials are "
                "left out."
            )
        case SeveralTasks():
            return (
                f"The scenes come from {finding.tasks} tasks and are taken as independent: what is "
                "significant need not hold for new tasks. --cluster task tests whether it does."
            )
        case NoneFailed():
            return (
                "No trial ended without success, and some say nothing: where `failed` or an empty "
                "cell means no success, write 0."
            )


def _unpaired(finding: Unpaired) -> str:
    one, two = (f"{variant} under {under}" for variant, under in (finding.first, finding.second))
    hashes = "; ".join(f"{name} {a[:8]!r} and {b[:8]!r}" for name, a, b in finding.differences)
    what = " and ".join(HASHES[name] for name, _, _ in finding.differences)
    others = f"; so do those of {counted(finding.others, 'other pair')}" if finding.others else ""
    return (
        f"{one} and {two} are no pair in scene {finding.scene!r} (seed {finding.seed}): their "
        f"{what} differ ({hashes}){others}."
    )


def _recheck(finding: Recheck) -> str:
    trials = f"'{finding.variant}' under {finding.faults}, seed {finding.seed}"
    if finding.wrote:
        return (
            f"A module writes into its reading, seen with {trials}: {finding.wrote}. "
            "Without a fault that changes what others read, and with one it does not."
        )
    how = (
        "alone, with a copy of every reading for each module"
        if finding.why == "guarded"
        else f"without the other scenes of its block of {finding.unit_scenes}"
    )
    again = (
        f"Results do not repeat: a second run of {counted(len(finding.scenes), 'scene')} of "
        f"{trials}, {how}, {finding.deviation}."
    )
    other = finding.deviation
    if other and other.gaps and not other.ended and {name for name, _ in other.gaps} <= _COUNTS:
        return (
            f"{again} Only what is counted differs: a loop that ends with the last of its scenes "
            "tells which still run, with taps.set_active(running) at each step."
        )
    return (
        f"{again} Effects may be chance: look for random numbers that are not of "
        "faultpath.generator, for threads, for what scenes of one call of run() share or one call "
        "leaves for the next, and for what is written into an array after it was delivered."
    )


def _without_pairs(result: AuditResult) -> Iterator[str]:
    for condition in result.titles:
        if result.effect(condition) is None:
            failed = series(
                [
                    f"{count.failed} of {counted(count.trials, 'trial')} of {count.variant}"
                    for count in result.counts
                    if count.condition == condition
                ]
            )
            missing = " or are missing" if result.facts.judged else ""
            yield f"{phrases.no_pair(condition)}: {failed} failed{missing}."


def _failed_trials(result: AuditResult) -> Iterator[str]:
    """Say by version and condition how many trials failed, and how far that could matter."""
    question = result.question
    for effect in result.effects:
        missing = effect.missing
        if missing is None or missing.against_pp is None or missing.favour_pp is None:
            continue
        if not (missing.repair or missing.baseline or missing.unsettled):
            continue
        lost = "failed"
        if result.facts.judged:
            lost += " or is missing" if missing.repair == 1 else " or are missing"
        yield (
            f"{capital(where(effect.condition))}, {counted(missing.repair, 'trial')} of "
            f"{question.repair} {lost}, {missing.baseline} of {question.baseline}: depending on "
            "how they would have ended, the difference over all scenes lies anywhere from "
            f"{signed(missing.against_pp)} to {signed(missing.favour_pp)} pp."
        )


def _partly_measured(result: AuditResult) -> Iterator[str]:
    """Say of which metrics not every trial has a value."""
    by_condition = {secondary.condition: secondary for secondary in result.secondary}
    for effect in result.effects:
        secondary = by_condition[effect.condition]
        for name in result.facts.metrics:
            whole = secondary.metrics[name].n_scenes if name in secondary.metrics else 0
            if whole < effect.scenes and (whole or result.facts.judged):
                scenes = f"{whole} of {counted(effect.scenes, result.facts.unit)}"
                yield (
                    f"{capital(where(effect.condition))}, {name} is compared in {scenes}: only "
                    "there does every trial have it."
                )
