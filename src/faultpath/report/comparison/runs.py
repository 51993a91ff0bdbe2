"""The audits that are set side by side, and how each is called."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.record.model import DecisionRecord, Effect, Question
from faultpath.record.provenance import RunProvenance


@dataclass(frozen=True, eq=False)
class Compared:
    """A finished audit beside others."""

    number: int
    """Its place among them, from 1."""
    folder: str
    record: DecisionRecord
    provenance: RunProvenance

    @property
    def asked(self) -> Question:
        """What it asked."""
        return self.record.question

    def effect(self, path: str) -> Effect | None:
        """Return its effect on a path; `None` where it has none."""
        return next((each for each in self.record.effects if each.path == path), None)


def titles(runs: Sequence[Compared]) -> dict[str, str]:
    """Return the paths of all runs by name, in the order in which they come, with titles.

    Correct inputs stand first and the shared fault last, as in every audit.
    """
    found: dict[str, str] = {}
    for run in runs:
        named = {path.name: path.title for path in run.record.paths}
        for effect in run.record.effects:
            found.setdefault(effect.path, named.get(effect.path, effect.path))
    return {name: found[name] for name in sorted(found, key=_place)}


def _place(path: str) -> int:
    return {"correct": 0, "shared": 2}.get(path, 1)


def numbers(runs: Sequence[Compared]) -> str:
    """Return `1`, `1 and 3` or `1, 2 and 3`."""
    return joined([str(run.number) for run in runs])


def joined(words: Sequence[str]) -> str:
    """Return words as a list in a sentence."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
