"""The audits that are set side by side, and how each is called."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from faultpath.record.family import CORRECT, SHARED
from faultpath.record.model import DecisionRecord, Effect
from faultpath.record.provenance import RunProvenance
from faultpath.record.question import Question
from faultpath.statistics import Sign


@dataclass(frozen=True, eq=False)
class Compared:
    """A finished audit beside others."""

    number: int
    """Its place among them, from 1."""
    folder: str
    record: DecisionRecord
    provenance: RunProvenance
    family: Mapping[str, tuple[Sign, float]] | None = None
    """Of a sweep over sizes: for each path the side that is decided over all of them together, and
    the adjusted p. `None` where every audit stands by itself."""

    @property
    def asked(self) -> Question:
        """What it asked."""
        return self.record.question

    def effect(self, path: str) -> Effect | None:
        """Return its effect on a path, as decided beside the others; `None` where it has none."""
        found = next((each for each in self.record.effects if each.path == path), None)
        if found is None or self.family is None or path not in self.family:
            return found
        sign, p = self.family[path]
        return found.model_copy(update={"sign": sign, "adjusted_p_value": p})

    @property
    def headline(self) -> str:
        """Its own headline, qualified where not all that it decided stands over all sizes."""
        own = self.record.verdict.headline
        fallen = any(
            effect.sign and not self.family[effect.path][0]
            for effect in (self.record.effects if self.family else ())
            if self.family and effect.path in self.family
        )
        return f"By itself, and not over all sizes: {own}" if fallen else own

    def absent(self, path: str) -> str:
        """Say why it has no effect on a path."""
        there = any(each.name == path for each in self.record.paths)
        return "every pair void" if there else "no such path"


def titles(runs: Sequence[Compared]) -> dict[str, str]:
    """Return the paths of all runs by name, with titles that say which is primary in all of them.

    Correct inputs stand first and the shared fault last, as in every audit.
    """
    found = {path.name: path.title for run in reversed(runs) for path in run.record.paths}
    order = {path.name: None for run in runs for path in run.record.paths}
    primaries = {run.asked.primary for run in runs}
    return {
        path: f"{found[path]} (primary)" if primaries == {path} else found[path]
        for path in sorted(order, key=lambda path: {CORRECT: 0, SHARED: 2}.get(path, 1))
    }


def numbers(runs: Sequence[Compared]) -> str:
    """Return `1`, `1 and 3` or `1, 2 and 3`."""
    return joined([str(run.number) for run in runs])


def joined(words: Sequence[str]) -> str:
    """Return words as a list in a sentence."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
