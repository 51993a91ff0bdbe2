"""What a map asks: two modules of one source, how large errors may be, and how they are spread."""

import math
from dataclasses import dataclass, replace

from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.frozen import Frozen
from faultpath.decisions.wording import MINUS
from faultpath.faults import AnyFault, FaultText
from faultpath.interface import Interface, module_of
from faultpath.trials import System, Variant

_BOTH_SIGNS = ("scale", "offset")
"""Kinds of fault whose size has two signs."""


class MapQuestion(Frozen, allow_inf_nan=False):
    """The question of a map, as its record keeps it."""

    system: str
    options: dict[str, str]
    baseline: str
    repair: str
    fault: str
    """Without a size: `gain`, `gain:offset`, `calibration`."""
    against: tuple[str, str]
    """The modules at which the error acts: across and upward in the picture."""
    others: tuple[str, ...] = ()
    """Readers of the same source that get it without error."""
    up_to: float = Field(gt=0)
    """The largest error, of either sign."""
    relative: bool
    """Whether errors are fractions of the reading; else they are in `unit`."""
    unit: str
    means: tuple[float, float]
    spreads: tuple[float, float]
    """Standard deviations of the joint distribution."""
    correlation: float | None = Field(default=None, ge=-1, le=1)
    points: int
    """As many are flown before those that bisect."""
    library: str
    library_hash: str
    n_scenes: int
    seeds: tuple[int, ...]
    trained: bool = False

    def said(self, size: float) -> str:
        """Return a size in words: `+20 %`, or `+0.2 m`."""
        if self.relative:
            return f"{100 * size:+.3g} %".replace("-", MINUS) if size else "0 %"
        return f"{size:+.3g} {self.unit}".replace("-", MINUS).removesuffix(" 1")


@dataclass(frozen=True)
class SizedFault:
    """A fault whose size is left open."""

    system: System
    text: str
    relative: bool
    unit: str
    expected: float | None
    """Standard deviation of the error that the interface declares, if it does."""

    def at(self, size: float) -> AnyFault:
        """Return the fault of a size at every reader; `UserError` where it takes no such size."""
        asked = FaultText.read(self.text)
        if asked.kind is None and asked.name not in self.system.fault_presets:
            asked = replace(asked, kind="scale")
        value = 1.0 + size if asked.kind == "scale" else size
        return self.system.fault(str(asked.at(f"{value:.12g}")))


def sized_fault(system: System, text: str) -> SizedFault:
    """Read a fault without its size: a preset, or a channel with `scale` (default) or `offset`.

    `UserError` for a fault that states a size or consumers, or whose size has no two signs.
    """
    asked = FaultText.read(text)
    name, kind = asked.name, asked.kind
    if asked.sizes:
        raise UserError(
            f"fault '{text}': the map sets the size itself; leave '={asked.sizes[0]}' out and give "
            "the largest one with --up-to."
        )
    if asked.consumers:
        raise UserError(f"fault '{text}': name the modules with --against, without '@'.")
    preset = kind is None and name in system.fault_presets
    if not preset and kind not in (None, *_BOTH_SIGNS):
        raise UserError(
            f"fault '{text}': a map needs errors of both signs; use {name}:scale (relative, the "
            f"default) or {name}:offset, not '{kind}'."
        )
    relative = kind != "offset"
    made = SizedFault(system, text, relative, "", None)
    fault = made.at(0.1 if relative else 1.0)
    parts = fault.resolved(system.interface)
    sources = [
        system.interface.source(system.interface.channel(part.channel).sources[0]) for part in parts
    ]
    declared = [
        s.uncertainty for s in sources if s.uncertainty and s.uncertainty.relative == relative
    ]
    expected = max((each.expected_std for each in declared), default=None)
    return SizedFault(system, text, relative, sources[0].unit, expected)


def check_up_to(fault: SizedFault, up_to: float | None) -> float:
    """Return the largest error, by default three declared spreads; `UserError` for a wrong one."""
    if up_to is None:
        if fault.expected is None:
            raise UserError(
                "the interface declares no uncertainty of that source: say how large errors may "
                "be, for example --up-to 0.2 for 20 % to either side."
            )
        return float(f"{3.0 * fault.expected:.2g}")
    if not 0.0 < up_to < math.inf:
        raise UserError(f"--up-to {up_to:g} is no size: give a number above 0.")
    if fault.relative and up_to >= 1.0:
        raise UserError(
            f"--up-to {up_to:g} would take all of the reading away: errors are fractions of it, so "
            "give less than 1."
        )
    return up_to


def places(
    interface: Interface, fault: AnyFault, against: tuple[str, ...], variants: tuple[Variant, ...]
) -> tuple[tuple[str, str], tuple[str, ...]]:
    """Return the two modules, and the other readers of what the fault strikes.

    `UserError` unless they are two, read it in either variant, and share no place.
    """
    if len(against) != 2 or len(set(against)) < 2 or not all(against):
        raise UserError(
            "--against needs two modules that read the faulty source, as in "
            "--against reconstruction,predictor."
        )
    present = frozenset[str]().union(*(variant.consumers for variant in variants))
    reached: list[set[str]] = []
    for name in against:
        parts = fault.striking(name).resolved(interface, present)
        reached.append({consumer for part in parts for consumer in part.consumers})
        if not reached[-1]:
            both = " nor ".join(f"'{variant.name}'" for variant in variants)
            raise UserError(
                f"--against: neither {both} has '{name}' read what the fault ({fault.describe()}) "
                "strikes: name another module."
            )
    if both := reached[0] & reached[1]:
        raise UserError(f"--against: both names hold {min(both)}: name two that share no place.")
    every = {c for part in fault.resolved(interface, present) for c in part.consumers}
    others = tuple(sorted({module_of(c) for c in every - reached[0] - reached[1]}))
    return (against[0], against[1]), others
