"""A comparison: a name, and what is measured under it. What runs against what is a table."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from benchmarks.measure import ROUNDS, NotMeasured, Rates, Work, interleaved
from benchmarks.results import Curve, Record, Target, record, unmeasured

Found = Record | Curve


@dataclass(frozen=True)
class Effort:
    """How much is measured: everything, or just enough to see that it can be."""

    share: float = 1.0

    def of(self, full: int, least: int = 1) -> int:
        """Return how many rounds, scenes or repetitions to take of `full`."""
        return max(least, round(self.share * full))


Case = Callable[[Effort], Iterable[Found]]


@dataclass(frozen=True)
class Comparison:
    """A named measurement of one or several cases, each by its words."""

    name: str
    cases: Mapping[str, Case]
    edition: int = 1
    """Raised when what is measured changes, so that older numbers are known as such."""
    changed: str = ""
    """What the last edition changed; the page says it beside numbers of an earlier one."""

    def take(self, effort: Effort) -> Iterator[Found]:
        """Measure; a case that fails says why and does not lose the others."""
        for words, case in self.cases.items():
            try:
                yield from case(effort)
            except NotMeasured as reason:
                yield unmeasured(words, str(reason))
            except Exception as error:
                yield unmeasured(words, f"{type(error).__name__}: {error}")


@dataclass(frozen=True)
class Row:
    """Two sides of a contest, by their names there, and the target of their ratio."""

    name: str
    ours: str
    peer: str
    target: Target | None = None
    unit: str = ""
    """Where it is not the contest's."""
    scale: Callable[[], float] | None = None
    """What a unit of our work counts in `unit`."""

    def record(self, rates: Rates, unit: str) -> Record:
        """Return our rate against that of the peer, or our time where `unit` is milliseconds.

        The ratio is that of the rates either way: how many times as fast ours is.
        """
        said = {"ours_name": self.ours, "peer_name": self.peer, "target": self.target}
        for side in (self.ours, self.peer):
            if side in rates.missing:
                return unmeasured(self.name, f"{side}: {rates.missing[side]}", unit=unit, **said)
        scale = self.scale() if self.scale else 1.0
        one = [scale * rate for rate in rates.rounds[self.ours]]
        other = rates.rounds[self.peer]
        ratios = [a / b for a, b in zip(one, other, strict=True)]
        if unit == "ms":
            one, other = ([1e3 / rate for rate in side] for side in (one, other))
        return record(self.name, unit, one, other, ratios, **said)


@dataclass(frozen=True)
class Contest:
    """Sides that take turns, and the rows that come of their rates; a case of a comparison."""

    unit: str
    sides: Mapping[str, Work]
    rows: tuple[Row, ...]
    same: Mapping[str, str] = field(default_factory=dict)
    """Which side must give the numbers of which other, within `tolerance`."""
    tolerance: float = 1e-3

    def __call__(self, effort: Effort) -> Iterator[Record]:
        """Let the sides take turns and return the rows."""
        rates = interleaved(self.sides, effort.of(ROUNDS), self.same, self.tolerance)
        for row in self.rows:
            yield row.record(rates, row.unit or self.unit)
