"""Results of a check or a trace as data, each kind with its numbers.

`faultpath.report.sentences.checks` says them.
"""

from dataclasses import dataclass
from typing import Generic, Literal, TypeAlias, TypeVar

from faultpath.core.results import Result
from faultpath.run.findings import Deviation, Unpaired, Unproven, Unread

_Told = TypeVar("_Told")
Tap: TypeAlias = tuple[str, str]
"""Channel and reader."""
Delivery: TypeAlias = tuple[str, int, str, str]
"""Scene, control step, channel and reader."""


@dataclass(frozen=True)
class Difference:
    """Difference of a run of a variant from another over the same scenes."""

    error: str = ""
    """Error of one of them; then nothing is compared."""
    outcomes: Deviation | None = None
    reading: Delivery | None = None
    """First reading that differs."""


@dataclass(frozen=True)
class Stopped:
    """An error that ended runs of a variant."""

    variant: str
    condition: str
    """Of the user's fault; empty for runs without it."""
    error: str
    in_trial: bool
    """Whether it came from within a trial, and breaks no rule that a check is named after."""


@dataclass(frozen=True)
class NoneEnded:
    """No trial of any variant ended."""

    see: tuple[str, ...]
    """The checks that failed."""


@dataclass(frozen=True)
class NoRoom:
    """Variants whose trials all succeed, or all do not, under correct inputs."""

    variants: tuple[str, ...]
    succeed: bool
    scenes: int


@dataclass(frozen=True)
class Unsteady:
    """A variant that differs when it runs again."""

    variant: str
    difference: Difference
    cause: tuple[bool, bool] | None
    """Whether two new processes differ, and whether the second run in one of them does; `None`
    where all ran in one."""


@dataclass(frozen=True)
class OrderMatters:
    """A variant that differs in another order of scenes, without some of them."""

    variant: str
    difference: Difference
    gap: float
    """Largest difference of a value, as a part of its size."""
    cause: Literal["dependence", "last digit", "rounding"]


@dataclass(frozen=True)
class TwoNames:
    """Modules of two variants that stand for each other under two names."""

    first: tuple[str, str]
    """Module and variant."""
    second: tuple[str, str]
    reads: tuple[str, ...]
    writes: tuple[str, ...]


@dataclass(frozen=True)
class TapFault:
    """A fault at one tap alone, and what is wrong with it."""

    variant: str
    tap: Tap
    trials: int


@dataclass(frozen=True)
class AlteredElsewhere(TapFault):
    """It altered a reading at another tap too."""

    other: Tap


@dataclass(frozen=True)
class NotReached(TapFault):
    """An error says that it was not delivered."""

    error: str


@dataclass(frozen=True)
class NothingDelivered(TapFault):
    """The tap delivered nothing, though it did without the fault."""


@dataclass(frozen=True)
class NothingAltered(TapFault):
    """It altered no reading."""


@dataclass(frozen=True)
class ReadElsewhere(TapFault):
    """Its module wrote another value where all that it was handed was the same."""

    source: str
    step: int
    scene: str


@dataclass(frozen=True)
class NoEffect(TapFault):
    """It changed nothing but the reading."""

    outputs: tuple[str, ...]
    """Sources that its module writes, which never changed; empty where it writes none."""


@dataclass(frozen=True)
class NothingChanged:
    """The user's fault changed no reading of a variant under a condition."""

    variant: str
    condition: str


@dataclass(frozen=True)
class NotFinite:
    """A reading that is not finite."""

    variant: str
    condition: str
    """Of the user's fault; empty without it."""
    source: str
    step: int
    reader: str
    scene: str


@dataclass(frozen=True)
class WholeNumbers:
    """A source of a physical unit, or one that gives fractions too, that gives whole numbers."""

    source: str
    dtype: str
    unit: str


@dataclass(frozen=True)
class OtherMagnitude:
    """A source whose readings are far from their declared magnitude."""

    source: str
    unit: str
    declared: float
    largest: float


@dataclass(frozen=True)
class Diverged:
    """A source whose readings are larger than any quantity."""

    source: str
    largest: float


Problem: TypeAlias = (
    Stopped
    | NoneEnded
    | NoRoom
    | Unsteady
    | OrderMatters
    | TwoNames
    | AlteredElsewhere
    | NotReached
    | NothingDelivered
    | NothingAltered
    | ReadElsewhere
    | NoEffect
    | NothingChanged
    | NotFinite
    | WholeNumbers
    | OtherMagnitude
    | Diverged
    | Unpaired
    | Unproven
    | Unread
)
"""What is wrong, or may be."""


@dataclass(frozen=True)
class Unjudged:
    """Nothing could be judged."""

    why: Literal["none ended", "one scene", "order of unsteady", "pairs of unsteady"]


@dataclass(frozen=True)
class Ends:
    """Trials that came to their end."""

    successes: tuple[tuple[str, int, int], ...]
    """Variant, successes and trials, under correct inputs."""
    under_fault: int
    """Trials under the user's fault."""


@dataclass(frozen=True)
class Repeated:
    """The same scenes ran again."""

    processes: bool
    """In processes of their own."""


@dataclass(frozen=True)
class Reordered:
    """Scenes ran in another order, without some of the others."""


@dataclass(frozen=True)
class Compared:
    """Runs of each scene whose conditions were compared."""

    runs: int


@dataclass(frozen=True)
class Reads:
    """Taps that are declared and read."""

    taps: int


@dataclass(frozen=True)
class Faulted:
    """Taps that were faulted alone, and readings that were altered there and elsewhere."""

    taps: int
    altered: int
    elsewhere: int


@dataclass(frozen=True)
class Spans:
    """Least and greatest reading of each source, with its unit."""

    sources: tuple[tuple[str, float, float, str], ...]


@dataclass(frozen=True)
class FilesOpened:
    """Python opened files."""


Summary: TypeAlias = (
    Unjudged
    | NoneEnded
    | Ends
    | Repeated
    | Reordered
    | Compared
    | Reads
    | Faulted
    | Spans
    | FilesOpened
)
"""What the line of a check tells."""


@dataclass(frozen=True)
class Checked:
    """One check of a system."""

    name: str
    summary: Summary
    failures: tuple[Problem, ...] = ()
    remarks: tuple[Problem, ...] = ()
    """What may be a mistake and may be none."""
    judged: bool = True


class SystemCheck(Result, Generic[_Told]):
    """A check of a system, whose parts are data or words."""

    format: Literal[2] = 2
    system: str
    options: dict[str, str]
    variants: tuple[str, ...]
    library: str
    scenes: tuple[str, ...]
    of: int
    """Number of scenes of the library."""
    seed: int
    fault: str | None = None
    checks: tuple[_Told, ...]


class TracedRead(Result):
    """A delivery of one channel to one reader in one control step."""

    step: int
    reader: str
    channel: str
    source: str
    valid_step: int
    """Step of the reading, as that of `Read`."""
    asks: int = 0
    """Answers that the reader got of a query."""
    altered_by: tuple[str, ...] = ()
    """Faults at the tap, where what was delivered differs from the reading."""


@dataclass(frozen=True)
class NeverRead:
    """A reader that a variant declares, and that did not read in the steps of a trace."""

    variant: str
    channel: str
    reader: str
    steps: int


@dataclass(frozen=True)
class EndedEarly:
    """An error that ended a run before the steps of its trace."""

    error: str


@dataclass(frozen=True)
class PermittedRead:
    """A read of a privileged source, by permission of the variant."""

    reader: str
    source: str


@dataclass(frozen=True)
class TruthRead:
    """A module that takes a truth of the plant past all taps."""

    module: str
    truth: str


TraceFinding: TypeAlias = NeverRead | EndedEarly | PermittedRead | TruthRead


class Trace(Result, Generic[_Told]):
    """A trace of a variant, whose findings are data or words."""

    format: Literal[1] = 1
    system: str
    options: dict[str, str]
    variant: str
    library: str
    scene: str
    seed: int
    steps: int
    fault: str = ""
    reads: tuple[TracedRead, ...]
    """In the order in which they happened."""
    reconstructed: dict[str, tuple[str, tuple[str, ...]]]
    """Source to the module that reconstructs it and the channels that this one read."""
    privileged: tuple[_Told, ...] = ()
    """Reads of what deployment does not have, by permission of the variant or past all taps."""
    findings: tuple[_Told, ...] = ()
    """Differences from what is declared."""
