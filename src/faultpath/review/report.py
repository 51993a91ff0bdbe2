"""What came of a check: verdicts as data."""

from typing import Literal

from faultpath.results import Result

Status = Literal["passed", "failed", "not judged"]


class Check(Result):
    """One thing that was looked at."""

    name: str
    says: str
    """What was seen, or why nothing could be, in a line."""
    failures: tuple[str, ...] = ()
    """A sentence each: what is wrong, where, and what to do."""
    remarks: tuple[str, ...] = ()
    """What may be a mistake and may be none."""
    judged: bool = True

    @property
    def status(self) -> Status:
        """How it ended."""
        if self.failures:
            return "failed"
        return "passed" if self.judged else "not judged"


class Struck(Result):
    """A tap that was struck by itself."""

    variant: str
    channel: str
    consumer: str
    trials: int
    readings: int
    """Readings that a trial got there while the fault was in force, summed over the trials."""
    altered: int
    """Those of them that differed from what the source held."""


class Report(Result):
    """A check of a system; what `faultpath check --json` prints."""

    format: Literal[1] = 1
    system: str
    options: dict[str, str]
    variants: tuple[str, ...]
    library: str
    scenes: tuple[str, ...]
    seed: int
    checks: tuple[Check, ...]
    struck: tuple[Struck, ...] = ()

    @property
    def failures(self) -> tuple[str, ...]:
        """The sentences of all checks that failed."""
        return tuple(said for check in self.checks for said in check.failures)
