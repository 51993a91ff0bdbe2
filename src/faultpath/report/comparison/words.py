"""What may be said of several audits, and what setting them side by side does not show."""

from collections.abc import Iterator, Sequence

from faultpath.record import wording
from faultpath.record.model import Effect
from faultpath.report.comparison import sweep
from faultpath.report.comparison.runs import Compared, joined, numbers, titles

_NO_TEST = (
    "etting verdicts side by side is no test between the audits: where one detects a difference "
    "and another does not, the two are not shown to differ."
)
CAVEAT = f"Each audit was decided by itself, and s{_NO_TEST}"
"""Of audits that are no sizes of one fault."""


def headline(runs: Sequence[Compared]) -> str:
    """Return how many audits there are, and where they are decided in opposite directions."""
    where = [title for path, title in titles(runs).items() if list(_opposite(runs, path))]
    found = sweep.swept(runs)
    count = f"{len(runs)} {f'sizes of {found.name}' if found else 'audits'} side by side"
    return f"{count}: decided in opposite directions on {joined(where)}" if where else count


def same(runs: Sequence[Compared]) -> str:
    """Return what to say of runs between which nothing differs."""
    alike = len({run.provenance.outcomes_sha256 for run in runs}) == 1
    outcomes = "and so are the outcomes, bit for bit" if alike else "and yet outcomes differ"
    return f"Question, code, data files, packages and machine are the same, {outcomes}."


def sentences(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return the caveat, where audits are decided in opposite directions, and what qualifies it.

    Audits of other arms ask something else, and are not held against each other.
    """
    told = [
        f"{title}: decided {sides}."
        for path, title in titles(runs).items()
        for sides in _opposite(runs, path)
    ]
    if not told and len({_arms(run) for run in runs}) == len(runs):
        told = ["No two of these audits compare the same arms, so none can contradict another."]
    none = ["No two audits of the same arms are decided in opposite directions on any path."]
    caveat = f"S{_NO_TEST}" if sweep.swept(runs) else CAVEAT
    return (caveat, *sweep.sentences(runs), *(told or none), *_qualified(runs))


def _opposite(runs: Sequence[Compared], path: str) -> Iterator[str]:
    """Yield which runs are decided for which arm, for arms that win in some runs and lose in
    others: `for a (baseline) in 1, for b (repair) in 2 and 3`."""
    decided = [(run, effect) for run in runs if (effect := run.effect(path)) and effect.sign]
    for arms in dict.fromkeys(_arms(run) for run, _ in decided):
        there = [(run, effect) for run, effect in decided if _arms(run) == arms]
        if len({_winner(*each) for each in there}) < 2:
            continue
        sides: dict[str, list[str]] = {}
        for run, effect in there:
            side = f"{_winner(run, effect)} ({'repair' if effect.sign > 0 else 'baseline'})"
            aside = wording.reservation(effect)
            told = f"{run.number} (at the {aside})" if aside else f"{run.number}"
            sides.setdefault(side, []).append(told)
        yield ", ".join(f"for {side} in {joined(said)}" for side, said in sides.items())


def _qualified(runs: Sequence[Compared]) -> Iterator[str]:
    for arms in dict.fromkeys(map(_arms, runs)):
        of: dict[str, list[Compared]] = {}
        for run in runs:
            if _arms(run) == arms:
                of.setdefault(run.asked.baseline, []).append(run)
        if len(of) > 1:
            said = (f"{name} in {numbers(having)}" for name, having in of.items())
            yield (
                f"The baseline is {joined(list(said))}: between these, the same arm is ahead where "
                "the signs are opposite."
            )
    if len({run.asked.system for run in runs}) > 1:
        yield (
            "The runs are of different systems: arms, modules and paths of the same name need not "
            "be the same."
        )


def _arms(run: Compared) -> frozenset[str]:
    return frozenset((run.asked.baseline, run.asked.repair))


def _winner(run: Compared, effect: Effect) -> str:
    return run.asked.repair if effect.sign > 0 else run.asked.baseline
