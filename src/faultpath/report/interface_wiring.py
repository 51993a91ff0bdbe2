"""What the interface drawing marks: how both variants are wired, and where the fault was in force.

Both come from the record of the run: the wiring from the variants that were flown, the struck taps
from receipts. Nothing is read out of the fault's words, which say what was meant.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import Enum

from faultpath.interface import Channel, module_of
from faultpath.record import wording
from faultpath.record.model import DecisionRecord, StruckTap
from faultpath.report.interface_layout import Tap
from faultpath.trials.shown import VariantShown


class Who(Enum):
    """Which of the two variants something is true of; the value is its mark in the drawing."""

    BOTH = ""
    BASELINE = "b"
    REPAIR = "r"
    NEITHER = "-"

    @property
    def words(self) -> str:
        """Say it behind a name: nothing where it is true of both."""
        alone = {Who.BASELINE: "baseline alone", Who.REPAIR: "repair alone"}
        return "" if self is Who.BOTH else f" ({alone.get(self, 'neither variant')})"


def who(baseline: bool, repair: bool) -> Who:
    """Return which of the two."""
    if baseline and repair:
        return Who.BOTH
    if baseline:
        return Who.BASELINE
    return Who.REPAIR if repair else Who.NEITHER


@dataclass(frozen=True)
class Wiring:
    """How baseline and repair are wired; without them, how the interface declares it."""

    variants: tuple[VariantShown, ...] = ()
    """Baseline and repair, one variant alone, as it ran, or none."""

    def words(self, by: Who) -> str:
        """Say behind a name whom it concerns; see `Who.words`."""
        return " (not read)" if by is Who.NEITHER and len(self.variants) == 1 else by.words

    def tap(self, tap: Tap) -> Who:
        """Return who reads at a tap."""
        return self._who(lambda variant: tap[1] in variant.consumers)

    def lacking(self, tap: Tap) -> tuple[str, str]:
        """Say why baseline and repair have no such tap; empty for one that has it.

        A variant lacks a tap because its whole module is not at work, or because the module does
        not read there.
        """
        module = module_of(tap[1])
        said: list[str] = []
        for variant in (self.variants[0], self.variants[-1]):
            if tap[1] in variant.consumers:
                said.append("")
            elif module in map(module_of, variant.consumers):
                said.append("not read")
            else:
                said.append("no module")
        return said[0], said[1]

    def module(self, name: str) -> Who:
        """Return who has a module at work: one whose taps are read."""
        return self._who(lambda variant: name in map(module_of, variant.consumers))

    def feeds(self, channel: Channel, source: str) -> Who:
        """Return in whom a source feeds a channel that is read."""
        first = channel.sources[0]
        if not self.variants:
            return Who.BOTH if source == first else Who.NEITHER
        return self._who(
            lambda variant: (
                variant.bindings.get(channel.name, first) == source
                and not set(variant.consumers).isdisjoint(channel.consumers)
            )
        )

    def _who(self, holds: Callable[[VariantShown], bool]) -> Who:
        held = tuple(map(holds, self.variants))
        return who(held[0], held[-1]) if held else Who.BOTH


@dataclass(frozen=True)
class StruckPath:
    """One path of a fault and the taps at which it was in force."""

    title: str
    baseline: frozenset[Tap]
    repair: frozenset[Tap]

    @property
    def taps(self) -> frozenset[Tap]:
        """The taps struck in either variant."""
        return self.baseline | self.repair

    def who(self, tap: Tap) -> Who:
        """Return in whom the tap was struck."""
        return who(tap in self.baseline, tap in self.repair)

    @property
    def words(self) -> str:
        """Say how many taps were struck, and in which variant."""
        parts = [
            f"{wording.counted(len(taps), 'tap')} in {where}"
            for taps, where in (
                (self.baseline & self.repair, "both variants"),
                (self.baseline - self.repair, "the baseline alone"),
                (self.repair - self.baseline, "the repair alone"),
            )
            if taps
        ]
        return f"{self.title}: struck {', '.join(parts) if parts else 'nothing'}"


def struck_paths(record: DecisionRecord) -> tuple[StruckPath, ...]:
    """Return the paths on which a fault was meant to strike, with the taps that receipts name."""
    return tuple(
        StruckPath(path.title, _taps(path.baseline_struck), _taps(path.struck))
        for path in record.paths
        if path.consumers or path.baseline_consumers
    )


def hits(tap: Tap, struck: Sequence[StruckPath]) -> list[tuple[int, Who]]:
    """Return the numbers of the paths that strike a tap, and in whom."""
    return [(n, path.who(tap)) for n, path in enumerate(struck, 1) if tap in path.taps]


def _taps(struck: Iterable[StruckTap]) -> frozenset[Tap]:
    return frozenset((tap.channel, tap.consumer) for tap in struck)
