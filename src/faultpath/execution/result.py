"""What comes of running a study."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from faultpath.code import Code
from faultpath.record.provenance import FlownAgain
from faultpath.store.tables import Trace, TrialAddress
from faultpath.trials.arm import Arm
from faultpath.trials.deliveries import Deliveries
from faultpath.trials.table import OutcomeTable


class Interrupted(Exception):
    """Ctrl-C stopped a run; everything finished is stored, and the same command resumes."""

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"interrupted with {done} of {total} blocks done")
        self.done = done
        self.total = total


@dataclass(frozen=True)
class Failure:
    """A trial in which the program raised an error or died."""

    arm: Arm
    scene: str
    error: str
    details: Path | None
    """The file with the traceback, when there is one."""


@dataclass(frozen=True)
class RunResult:
    """A finished run."""

    outcomes: OutcomeTable
    deliveries: Deliveries
    """What the taps did, row by row."""
    traces: Mapping[TrialAddress, Trace]
    """Position at each control step, `[T, 3]`, metres, world frame."""
    blocks_computed: int
    blocks_kept: int
    failures: tuple[Failure, ...]
    outcomes_sha256: str
    system_fingerprint: str
    """Of `code`, shortened; for several runs together, of all of them."""
    code: tuple[Code, ...]
    """What flew, of each run that this is made of."""
    library_hash: str
    flown_again: tuple[FlownAgain, ...] = ()
    """What was flown a second time, to see whether results repeat."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What the run found that a reader has to know: results that do not repeat or depend on
        their block, consumers that never read or that write, hashes that prove nothing."""
        return self.deliveries.findings
