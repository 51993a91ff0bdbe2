"""What is said of pairs that do not count, and of the trials whose failure voids them."""

from collections.abc import Sequence

from faultpath.record.model import Effect
from faultpath.record.words import About, capital, plain, points, where


def void_paths(paths: Sequence[str]) -> tuple[str, ...]:
    """Name the paths on which no pair of trials could be compared."""
    return tuple(f"{capital(no_pair(path))}: the table shows what failed." for path in paths)


def failed_trials(about: About, effects: Sequence[Effect]) -> tuple[str, ...]:
    """Say by arm and path how many trials failed, and what their outcomes could make of it."""
    said: list[str] = []
    for effect in effects:
        found = effect.failed
        if found is None or not (found.repair or found.baseline or found.unsettled):
            continue
        asked, every = about.question, found.as_failures
        ends = f"from {points(found.against_pp)} to {points(found.favour_pp)} pp"
        interval = ""
        if every.low is not None and every.high is not None:
            interval = f" [{plain(every.low)}, {plain(every.high)}]"
        said.append(
            f"{capital(where(effect.path))}, {found.repair} trials of {asked.repair} failed and "
            f"{found.baseline} of {asked.baseline}: counted as no success, the difference over all "
            f"scenes is {points(every.value)} pp{interval}; depending on how they would have "
            f"ended, it lies anywhere {ends}."
        )
    return tuple(said)


def no_pair(path: str) -> str:
    """Say that a path has no pair of trials to compare."""
    return f"{where(path)}, no pair of trials is left to compare and nothing is decided"
