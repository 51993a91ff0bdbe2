"""Small pictures of the intervals of claims and of their parts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from faultpath.record.reproduction import ClaimVerdict, Ledger, Part
from faultpath.report.reproduction import words
from faultpath.report.reproduction.intervals import Scale, Shown, interval_plot, scale_plot

_HEADED = "pp"
"""The unit whose scale stands over the plots; of others it stands below each."""

Limits = Mapping[str, Sequence[Sequence[float]]]
"""By claim and part: what the statement is decided at, in its unit."""
_Drawn = tuple[str, Shown, ClaimVerdict | Part]


@dataclass(frozen=True)
class Plots:
    """The pictures, and the scale over those that share it."""

    scale: Markup | None
    named: dict[str, Markup]
    """Of `C01` and `C01, part 1`; what has no interval has none."""


def ledger_plots(ledger: Ledger, limits: Limits, beside: Sequence[Ledger]) -> Plots:
    """Return a picture of every interval; all of one unit share an axis.

    Beside each stands that of the same statement on the first other platform.
    """
    other = {name: of for ledger in beside[:1] for name, of in _statements(ledger)}
    drawn = [
        (name, _shown(name, of, ledger, limits, other.get(name)), of)
        for name, of in _statements(ledger)
        if of.estimate is not None and of.interval is not None
    ]
    scales = {unit: _scale(unit, drawn) for unit in dict.fromkeys(of.unit for *_, of in drawn)}
    plots = {
        name: Markup(
            interval_plot(
                f"{name}: {words.estimate(of)}",
                shown,
                scales[of.unit],
                None if of.unit == _HEADED else words.behind(of.unit),
            )
        )
        for name, shown, of in drawn
    }
    headed = scales.get(_HEADED)
    scale = (
        None
        if headed is None
        else Markup(scale_plot(headed, "Scale in percentage points", words.behind(_HEADED)))
    )
    return Plots(scale, plots)


def _scale(unit: str, drawn: Sequence[_Drawn]) -> Scale:
    return Scale.of(unit, (end for _, shown, of in drawn if of.unit == unit for end in shown.ends))


def _statements(ledger: Ledger) -> Iterator[tuple[str, ClaimVerdict | Part]]:
    for claim in ledger.claims:
        yield claim.id, claim
        yield from ((f"{claim.id}, part {i}", part) for i, part in enumerate(claim.parts, 1))


def _shown(
    name: str,
    of: ClaimVerdict | Part,
    ledger: Ledger,
    limits: Limits,
    other: ClaimVerdict | Part | None,
) -> Shown:
    claim = next(each for each in ledger.claims if each.id == name.partition(",")[0])
    part = _deciding(claim) if isinstance(of, ClaimVerdict) else of
    decided = limits.get(claim.id, ())
    at = claim.parts.index(part)
    theirs = other and _deciding(other) if isinstance(other, ClaimVerdict) else other
    same = theirs is not None and theirs.words == part.words and theirs.unit == part.unit
    there = (theirs.estimate, *theirs.interval) if same and theirs and theirs.interval else ()
    assert of.estimate is not None
    assert of.interval is not None
    return Shown(
        value=of.estimate,
        interval=of.interval,
        least=of.mde,
        papers=() if part.paper is None else (part.paper, *(part.paper_interval or ())),
        limits=decided[at] if at < len(decided) else (),
        other=tuple(value for value in there if value is not None),
    )


def _deciding(claim: ClaimVerdict) -> Part:
    return next(part for part in claim.parts if part.answer == claim.verdict)
