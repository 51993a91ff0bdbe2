"""Findings in the trials of a run that a reader of its results has to know, as data.

`faultpath.report.sentences.findings` says them. A deviation, which errors of a run name too, has
its words here, as `str`.
"""

from collections.abc import Sequence
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from faultpath.core.results import Result
from faultpath.core.text import counted

Unit: TypeAlias = Literal["scene", "task"]
"""Unit that counts as one in results of other tools: a scene, or a task with all its scenes."""


class Deviation(Result):
    """Differences of a second run of some scenes from the first."""

    died: str = ""
    """How its worker ended; then no outcomes could be compared."""
    raised: str = ""
    """Error that it raised; likewise."""
    scenes: tuple[str, ...]
    """Scenes that differ."""
    of: int
    """Scenes that ran again."""
    ended: int = 0
    """Scenes that ended in another status."""
    gaps: tuple[tuple[str, float | None], ...] = ()
    """Parts of an outcome that differ, with the largest difference; `None` for no number."""

    def __str__(self) -> str:
        if self.died:
            return f"could not be run again ({self.died}), which differs"
        if self.raised:
            return f"failed the second time ({self.raised}), which differs"
        ended = f"{counted(self.ended, 'trial')} with another end"
        parts = [ended if self.ended else "every trial with the same end"]
        for name, gap in self.gaps:
            label = "readings" if name == "trajectory_hash" else name
            parts.append(f"other {label}" if gap is None else f"{label} by up to {gap:.3g}")
        if self.of == 1:
            return f"differs ({', '.join(parts)})"
        count = f"{len(self.scenes)} of {counted(self.of, 'scene')}"
        return f"differs in {count}, such as {self.scenes[0]!r} ({', '.join(parts)})"


class Recheck(Result):
    """Scenes of a finished unit that ran a second time, and what that showed."""

    kind: Literal["recheck"] = "recheck"
    why: Literal["sample", "guarded"]
    """A few scenes of the unit by themselves, or one alone with guarded readings."""
    unit: str
    """Key of the unit, which its shard is named after."""
    variant: str
    faults: str
    """In words."""
    seed: int
    scenes: tuple[str, ...]
    unit_scenes: int
    """How many scenes the unit has in all."""
    deviation: Deviation | None = None
    """From the outcomes of the run; `None` where they are the same to the bit."""
    wrote: str = ""
    """The reader that wrote into its reading, where the guard saw one."""


class Unpaired(Result):
    """Two trials of a scene that met different conditions and are no pair."""

    kind: Literal["unpaired"] = "unpaired"
    first: tuple[str, str]
    """Variant and condition."""
    second: tuple[str, str]
    scene: str
    seed: int
    differences: tuple[tuple[str, str, str], ...]
    """The name of each hash that differs, and both of its values."""
    others: int = 0
    """Further pairs that are none, for the same reason."""

    @classmethod
    def first_of(cls, pairs: Sequence["Unpaired"]) -> tuple["Unpaired", ...]:
        """Return one finding that counts all and shows the first; nothing without any."""
        return tuple(pair.model_copy(update={"others": len(pairs) - 1}) for pair in pairs[:1])


class Unproven(Result):
    """All scenes carry the same hashes, which so prove nothing about the pairs."""

    kind: Literal["unproven"] = "unproven"
    scenes: int
    hashes: tuple[str, ...]


class Unread(Result):
    """A reader that a variant declares, and that never read."""

    kind: Literal["unread"] = "unread"
    variant: str
    channel: str
    reader: str


class RaisedTogether(Result):
    """Blocks that raised an error when their scenes ran together, and none when each ran alone."""

    kind: Literal["raised-together"] = "raised-together"
    blocks: int
    of: int
    """Blocks of the run."""
    error: str
    """Error of the first."""


class Unrecorded(Result):
    """Trials that could not run again for their signals."""

    kind: Literal["unrecorded"] = "unrecorded"
    error: str


class Unrepeated(Result):
    """Trials that came out otherwise when their signals were recorded."""

    kind: Literal["unrepeated"] = "unrepeated"
    trials: int
    of: int
    """Trials that ran again."""
    variant: str
    """Variant of the first; so is all that follows."""
    condition: str
    scene: str
    deviation: Deviation


class MissingTrials(Result):
    """Trials that one version has and the other lacks, in results of other tools."""

    kind: Literal["missing-trials"] = "missing-trials"
    variant: str
    condition: str
    trials: int
    unit: Unit
    first: str
    """Scene or task of the first."""
    trial: str
    """Its seed in a scene, or what tells it apart in a task; empty where nothing does."""


class ExtraTrials(Result):
    """Scenes or tasks with more trials than the others; these are left out."""

    kind: Literal["extra-trials"] = "extra-trials"
    units: int
    unit: Unit
    first: str


class SeveralTasks(Result):
    """Scenes that count as independent, though they come from several tasks."""

    kind: Literal["several-tasks"] = "several-tasks"
    tasks: int


class NoneFailed(Result):
    """Results in which every trial has a success or no outcome at all."""

    kind: Literal["none-without-success"] = "none-without-success"


Finding: TypeAlias = Annotated[
    Recheck
    | Unpaired
    | Unproven
    | Unread
    | RaisedTogether
    | Unrecorded
    | Unrepeated
    | MissingTrials
    | ExtraTrials
    | SeveralTasks
    | NoneFailed,
    Field(discriminator="kind"),
]
