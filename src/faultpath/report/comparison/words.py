"""What may be said of several audits, and what setting them side by side does not show."""

from collections.abc import Iterator, Sequence
from itertools import combinations

from faultpath.report import wording
from faultpath.report.comparison.runs import Compared, joined, numbers, titles

CAVEAT = (
    "Each audit was decided by itself. Setting verdicts side by side is no test between the audits: "
    "where one detects a difference and another does not, this does not show that they differ."
)


def headline(runs: Sequence[Compared]) -> str:
    """Return how many audits there are, and where they are decided in opposite directions."""
    where = [title for path, title in titles(runs).items() if _disagree(runs, path)]
    count = f"{len(runs)} audits side by side"
    return f"{count}: decided in opposite directions on {joined(where)}" if where else count


def same(runs: Sequence[Compared]) -> str:
    """Return what to say of runs between which nothing differs."""
    alike = len({run.provenance.outcomes_sha256 for run in runs}) == 1
    outcomes = "and so are the outcomes, bit for bit" if alike else "and yet outcomes differ"
    return f"Question, code, data files, packages and machine are the same, {outcomes}."


def sentences(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return the caveat, where audits are decided in opposite directions, and what qualifies it."""
    told = [_opposite(runs, path, title) for path, title in titles(runs).items()]
    found = tuple(filter(None, told)) or ("On no path are two audits decided in opposite ways.",)
    return (CAVEAT, *found, *_qualified(runs))


def _qualified(runs: Sequence[Compared]) -> Iterator[str]:
    pairs = [pair for pair in combinations(runs, 2) if _exchanged(*pair)]
    if pairs:
        exchanged = [run for run in runs if any(run in pair for pair in pairs)]
        yield (
            f"Among runs {numbers(exchanged)}, baseline and repair are exchanged: there the same "
            "arm is ahead where the signs are opposite."
        )
    if len({run.asked.system for run in runs}) > 1:
        yield (
            "The runs are of different systems: a module of the same name need not be the same, "
            "nor is a path of the same title."
        )


def _opposite(runs: Sequence[Compared], path: str, title: str) -> str:
    """Tell which runs are decided for which arm; empty where no two disagree."""
    if not _disagree(runs, path):
        return ""
    sides: dict[str, list[str]] = {}
    for run, sign in _decided(runs, path):
        role = "repair" if sign > 0 else "baseline"
        effect = run.effect(path)
        aside = wording.reservation(effect) if effect else ""
        told = f"{run.number} ({aside})" if aside else str(run.number)
        sides.setdefault(f"{_winner(run, sign)} (the {role})", []).append(told)
    said = (f"for {side} in {joined(there)}" for side, there in sides.items())
    return f"{title}: decided {', '.join(said)}."


def _decided(runs: Sequence[Compared], path: str) -> list[tuple[Compared, int]]:
    """Return the runs that are decided on a path, each with the side."""
    effects = ((run, run.effect(path)) for run in runs)
    return [(run, effect.sign) for run, effect in effects if effect is not None and effect.sign]


def _disagree(runs: Sequence[Compared], path: str) -> bool:
    """Return whether two runs are decided in opposite directions on a path.

    Those of the same two arms are where different arms win, whatever their roles; others where the
    repair wins in one and loses in the other.
    """
    return any(
        _winner(one, first) != _winner(two, second) if _arms(one) == _arms(two) else first != second
        for (one, first), (two, second) in combinations(_decided(runs, path), 2)
    )


def _exchanged(one: Compared, two: Compared) -> bool:
    return _arms(one) == _arms(two) and one.asked.repair != two.asked.repair


def _arms(run: Compared) -> frozenset[str]:
    return frozenset((run.asked.baseline, run.asked.repair))


def _winner(run: Compared, sign: int) -> str:
    return run.asked.repair if sign > 0 else run.asked.baseline
