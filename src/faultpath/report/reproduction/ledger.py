"""Small pictures of the intervals of claims and of their parts."""

from collections.abc import Iterator
from dataclasses import dataclass

from markupsafe import Markup

from faultpath.record.reproduction import ClaimVerdict, Ledger, Part
from faultpath.report.reproduction import words
from faultpath.report.reproduction.intervals import interval_plot, plot_axis, scale_plot

_SHARED = "pp"
"""The unit whose plots stand on one axis, so that they can be compared by eye."""


@dataclass(frozen=True)
class Plots:
    """The pictures, and the scale over those that share it."""

    scale: Markup | None
    named: dict[str, Markup]
    """Of `C01` and `C01, part 1`; what has no interval has none."""


def ledger_plots(ledger: Ledger) -> Plots:
    """Return a picture of every interval; all in percentage points share one axis."""
    drawn = dict(_measured(ledger))
    ends = [end for value, of in drawn.values() if of.unit == _SHARED for end in value]
    ends += [end for _, of in drawn.values() if of.unit == _SHARED for end in _papers(of)]
    axis = plot_axis(ends) if ends else None
    plots: dict[str, Markup] = {}
    for name, ((value, *interval), of) in drawn.items():
        shared = axis if of.unit == _SHARED else None
        title = f"{name}: {words.estimate(of)}"
        plots[name] = Markup(interval_plot(title, value, interval, of.mde, shared, _papers(of)))
    scale = None if axis is None else Markup(scale_plot(axis, "Scale in percentage points"))
    return Plots(scale, plots)


def _papers(of: ClaimVerdict | Part) -> tuple[float, ...]:
    """Return the paper's figure and the ends of its interval, as far as it prints them."""
    shown = _deciding(of) if isinstance(of, ClaimVerdict) else of
    return () if shown.paper is None else (shown.paper, *(shown.paper_interval or ()))


def _deciding(claim: ClaimVerdict) -> Part:
    """Return the part whose estimate is the claim's."""
    return next(part for part in claim.parts if part.answer == claim.verdict)


def _measured(
    ledger: Ledger,
) -> Iterator[tuple[str, tuple[tuple[float, float, float], ClaimVerdict | Part]]]:
    """Yield the name of each claim and part that has an interval, with estimate and ends."""
    for claim in ledger.claims:
        parts = ((f"{claim.id}, part {number}", part) for number, part in enumerate(claim.parts, 1))
        for name, of in ((claim.id, claim), *parts):
            if of.estimate is not None and of.interval is not None:
                yield name, ((of.estimate, *of.interval), of)
