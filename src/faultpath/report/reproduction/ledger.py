"""Claims as the page's rows: words, and a small picture of each interval."""

from dataclasses import dataclass

from markupsafe import Markup

from faultpath.record.claim import ClaimVerdict, Ledger, Part
from faultpath.report.reproduction import words
from faultpath.report.reproduction.intervals import interval_plot, plot_axis, scale_plot
from faultpath.report.scale import Axis

_SHARED = "pp"
"""The unit whose plots stand on one axis, so that they can be compared by eye."""


@dataclass(frozen=True)
class PartRow:
    """One part of a claim."""

    part: Part
    figure: str
    interval: str
    plot: Markup | None
    evidence: tuple[str, ...]


@dataclass(frozen=True)
class ClaimRow:
    """One claim with its parts."""

    claim: ClaimVerdict
    figure: str
    interval: str
    least_detectable: str
    plot: Markup | None
    parts: tuple[PartRow, ...]


@dataclass(frozen=True)
class LedgerRows:
    """All claims, and the scale over their plots."""

    scale: Markup | None
    rows: tuple[ClaimRow, ...]


def ledger_rows(ledger: Ledger) -> LedgerRows:
    """Return the rows of the ledger; all plots in percentage points share one axis."""
    measured = [*ledger.claims, *(part for claim in ledger.claims for part in claim.parts)]
    ends = [end for of in measured for end in _extent(of)]
    axis = plot_axis(ends) if ends else None
    scale = None if axis is None else Markup(scale_plot(axis, "Scale in percentage points"))
    return LedgerRows(scale, tuple(_row(claim, axis) for claim in ledger.claims))


def _extent(of: ClaimVerdict | Part) -> tuple[float, ...]:
    if of.unit != _SHARED or of.estimate is None or of.interval is None:
        return ()
    return (of.estimate, *of.interval)


def _row(claim: ClaimVerdict, axis: Axis | None) -> ClaimRow:
    return ClaimRow(
        claim=claim,
        figure="" if claim.estimate is None else words.figure(claim.estimate, claim.unit),
        interval=words.interval(claim.interval, claim.unit),
        least_detectable=words.least_detectable(claim),
        plot=_plot(claim, claim.id, axis),
        parts=tuple(
            _part(part, f"{claim.id}, part {number}", axis)
            for number, part in enumerate(claim.parts, 1)
        ),
    )


def _part(part: Part, name: str, axis: Axis | None) -> PartRow:
    return PartRow(
        part=part,
        figure="" if part.estimate is None else words.figure(part.estimate, part.unit),
        interval=words.interval(part.interval, part.unit),
        plot=_plot(part, name, axis),
        evidence=words.evidence(part),
    )


def _plot(of: ClaimVerdict | Part, name: str, axis: Axis | None) -> Markup | None:
    if of.estimate is None or of.interval is None:
        return None
    shared = axis if of.unit == _SHARED else None
    title = f"{name}: {words.estimate(of)}"
    return Markup(interval_plot(title, of.estimate, of.interval, of.mde, shared))
