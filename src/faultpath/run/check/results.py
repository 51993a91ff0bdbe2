"""Results of a check as data, each kind with its numbers.

`faultpath.report.sentences.checks` says them.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from faultpath.run.findings import Deviation, Unpaired, Unproven, Unread

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
    """Condition of the user's fault; empty for runs without it."""
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
    wrong: Literal[
        "alters another tap", "not delivered", "alters nothing", "reads elsewhere", "no effect"
    ]
    """`reads elsewhere`: its module wrote another value where all that it was handed was the same;
    `no effect`: it changed nothing but the reading."""
    error: str = ""
    """Text that says that it was not delivered; empty where nothing was delivered at all."""
    other: Tap = ("", "")
    outputs: tuple[str, ...] = ()
    """Sources that its module writes: the one that changed, or all, of which none did; empty where
    no module reads one."""
    step: int = 0
    scene: str = ""


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
    """Condition of the user's fault; empty without it."""
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
    | TapFault
    | NothingChanged
    | NotFinite
    | WholeNumbers
    | OtherMagnitude
    | Diverged
    | Unpaired
    | Unproven
    | Unread
)
"""A kind of what is wrong, or may be."""


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


Summary: TypeAlias = NoneEnded | Ends | Repeated | Compared | Reads | Faulted | Spans
Unjudged: TypeAlias = Literal[
    "", "none ended", "one scene", "last digit", "order of unsteady", "pairs of unsteady"
]


@dataclass(frozen=True)
class Checked:
    """One check of a system."""

    name: str
    summary: Summary | None = None
    """Number that its line tells, where it tells one."""
    failures: tuple[Problem, ...] = ()
    remarks: tuple[Problem, ...] = ()
    """Possible mistakes, which may be none."""
    unjudged: Unjudged = ""
    """Why nothing could be judged."""
