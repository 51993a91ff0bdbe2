"""Conclusions of a reproduction: claims, tables and figures, from which its pages are made."""

from pathlib import Path
from typing import Literal

from pydantic import ConfigDict

from faultpath.core.results import Shown
from faultpath.report.tables import Table

Answer = Literal["confirmed", "refuted", "undecided"]
Size = Literal["compatible", "right sign, other size", "other size", "other sign", "not comparable"]
"""An effect beside the paper's figure; `other size` where a sign is not decided, or there is none.

`docs/design/claims.md` defines them.
"""


class _PlainFrozen(Shown):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class StatementPart(_PlainFrozen):
    """One of the statements that a claim is made of."""

    words: str
    """The statement, such as `WM-A+DCC minus WM-A at e = +0.1 is above 0`."""
    answer: Answer
    estimate: float | None = None
    interval: tuple[float, float] | None = None
    """Interval by the paper's method: a percentile bootstrap of scenes."""
    score: tuple[float, float] | None = None
    """Our score interval, where there is one; no answer depends on it."""
    unit: str = ""
    p_value: float | None = None
    test: str = ""
    mde: float | None = None
    """Least effect that could have been detected, in `unit`."""
    counts: str = ""
    """Discordant scenes, first:second, seed by seed."""
    reason: str = ""
    """Why it is undecided, where the numbers do not say it."""
    not_run: bool = False
    """Whether it is undecided because the run lacks its trials or measurements."""
    paper: float | None = None
    """The paper's figure in `unit`, where it prints one, or the two that it follows from."""
    paper_interval: tuple[float, float] | None = None
    size: Size = "not comparable"
    """How the estimate compares with that figure; no answer depends on it."""


class ClaimVerdict(_PlainFrozen):
    """A claim and the run's answer to it; confirmed when every part is."""

    id: str
    kind: Literal["platform", "finding"]
    verdict: Answer
    estimate: float | None
    """Estimate of the deciding part: the first that fails to hold, or else the first."""
    interval: tuple[float, float] | None
    mde: float | None
    unit: str
    paper: str
    """Result that the paper reports."""
    claim: str
    parts: tuple[StatementPart, ...]


class Ledger(_PlainFrozen):
    """Claims over one run."""

    library: str
    library_hash: str
    scenes: int
    seeds: tuple[int, ...]
    claims: tuple[ClaimVerdict, ...]
    left_out: int = 0
    """Number of claims that the run is not about."""

    def count(self, answer: Answer) -> int:
        """Return how many claims got this answer."""
        return sum(claim.verdict == answer for claim in self.claims)


class Point(_PlainFrozen):
    """One point of a series, with its interval."""

    x: float
    y: float
    low: float | None = None
    high: float | None = None


class Series(_PlainFrozen):
    """One line of a figure."""

    label: str
    points: tuple[Point, ...]


class Sweep(_PlainFrozen):
    """A figure of lines."""

    name: str
    title: str
    x_title: str
    y_title: str
    series: tuple[Series, ...]
    published: str
    """Values that the paper gives for its figure."""
    notes: tuple[str, ...] = ()


class Reproduction(_PlainFrozen):
    """Ledger, tables and figures of one run, in the order in which they are read."""

    profile: str
    ledger: Ledger
    tables: tuple[Table, ...]
    figures: tuple[Sweep, ...]
    trials: int
    failed_trials: int


RUN = Path(__file__).parent / "data" / "run"


def shipped_ledger() -> Ledger:
    """Return what the run answered; a test holds it to what the code answers from its tables."""
    return Reproduction.model_validate_json((RUN / "reproduction.json").read_bytes()).ledger
