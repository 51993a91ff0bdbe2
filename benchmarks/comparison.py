"""A comparison: what runs against what, and which records come of it."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.measure import Rates
from benchmarks.results import Curve, Record, Target


@dataclass(frozen=True)
class Outcome:
    """What one comparison found."""

    records: Sequence[Record]
    curves: Sequence[Curve] = ()


@dataclass(frozen=True)
class Comparison:
    """A named measurement; `run` takes it."""

    name: str
    run: Callable[[], Outcome]


def at_least(value: float, of: str = "ratio") -> Target:
    """Return a lower bound on the ratio, or on our own number."""
    return Target.model_validate({"of": of, "sense": "at least", "value": value})


def at_most(value: float, of: str = "ratio") -> Target:
    """Return an upper bound on the ratio, or on our own number."""
    return Target.model_validate({"of": of, "sense": "at most", "value": value})


_TIMES: Mapping[str, Callable[[float], float]] = {
    "s": lambda rate: 1 / rate,
    "ms": lambda rate: 1e3 / rate,
}


@dataclass(frozen=True)
class Writer:
    """Makes the records of one comparison from its rates."""

    comparison: str
    rates: Rates

    def versus(
        self,
        name: str,
        ours: str,
        peer: str,
        unit: str,
        target: Target | None = None,
        note: str = "",
    ) -> Record:
        """Return our rate against that of a peer, or our time where `unit` is one.

        The ratio is that of the rates either way: how many times as fast ours is.
        """
        blank = Record(
            name=name,
            comparison=self.comparison,
            unit=unit,
            ours_name=ours,
            peer_name=peer,
            target=target,
            note=note,
        )
        for side in (ours, peer):
            if side in self.rates.missing:
                reason = f"Not measured: {side}: {self.rates.missing[side]}"
                return blank.model_copy(update={"note": reason})
        one, other = self.rates.rounds[ours], self.rates.rounds[peer]
        ratios = [a / b for a, b in zip(one, other, strict=True)]
        shown = _TIMES.get(unit, lambda rate: rate)
        return judged(
            blank.model_copy(
                update={
                    "ours": shown(statistics.median(one)),
                    "peer": shown(statistics.median(other)),
                    "ratio": statistics.median(ratios),
                    "low": min(ratios),
                    "high": max(ratios),
                }
            )
        )


def absolute(
    comparison: str,
    name: str,
    values: Sequence[float],
    unit: str,
    target: Target | None = None,
    note: str = "",
) -> Record:
    """Return a number of ours that stands alone: the median of `values` and their range."""
    return judged(
        Record(
            name=name,
            comparison=comparison,
            unit=unit,
            ours=statistics.median(values),
            low=min(values),
            high=max(values),
            target=target,
            note=note,
        )
    )


def unmeasured(comparison: str, name: str, reason: str) -> Record:
    """Return a record without numbers that says why it has none."""
    return Record(name=name, comparison=comparison, unit="", note=f"Not measured: {reason}")


def judged(record: Record) -> Record:
    """Return the record with its target looked at."""
    if record.target is None:
        return record
    value = record.ratio if record.target.of == "ratio" else record.ours
    return record.model_copy(update={"met": None if value is None else record.target.met_by(value)})


def growth(curve: Curve, comparison: str, name: str, limit: float) -> Record:
    """Return whether the time grows no faster than the size, from the first point to the last."""
    (size, time), (size_end, time_end) = curve.points[0], curve.points[-1]
    linear = time * size_end / size
    return judged(
        Record(
            name=name,
            comparison=comparison,
            unit=curve.unit,
            ours=time_end,
            ours_name=f"{size_end:g} {curve.across}",
            peer=linear,
            peer_name=f"{size_end / size:g} times the time of {size:g}",
            ratio=time_end / linear,
            target=at_most(limit),
        )
    )
