"""How numbers, lists and places are written: in sentences, tables and pictures alike."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Protocol

from faultpath.analyses.effects import Difference, Effect
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.shares import first, last
from faultpath.core.text import capital
from faultpath.stats.estimate import BreakEven, Estimate

MINUS = "−"
_ADDED = ("offset", "noise", "bias", "drift")
"""Kinds of fault whose sizes have the unit of the reading."""
_ROUNDING = 1e-9
"""Below this a metric and its interval may differ from 0 by rounding alone."""
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def signed(value: float, digits: int = 1) -> str:
    """Return `+6.7`, `−9.7` or `0.0`: a difference always shows its sign, zero has none."""
    text = f"{value:+.{digits}f}"
    if float(text) == 0.0:
        return text[1:]
    return text.replace("-", MINUS)


def plain(value: float, digits: int = 1) -> str:
    """Return the number with a real minus sign."""
    return signed(value, digits).removeprefix("+")


def bracket(ends: Sequence[float], digits: int = 1) -> str:
    """Return `[−16.0, −4.0]`."""
    low, high = ends
    return f"[{plain(low, digits)}, {plain(high, digits)}]"


class _Ends(Protocol):
    @property
    def low(self) -> float | None: ...
    @property
    def high(self) -> float | None: ...


def interval(estimate: _Ends, digits: int = 1) -> str:
    """Return both ends, or nothing where no interval exists."""
    if estimate.low is None or estimate.high is None:
        return ""
    return bracket((estimate.low, estimate.high), digits)


def with_interval(estimate: Estimate | Difference, digits: int = 1) -> str:
    """Return `−9.7 [−16.0, −4.0]`."""
    return f"{signed(estimate.value, digits)} {interval(estimate, digits)}".rstrip()


def digits_of(estimate: Estimate) -> int:
    """Return the decimals that give two digits to the width of its interval or, without one, to
    its value: a metric may be in metres or in thousandths."""
    width = (estimate.high or 0.0) - (estimate.low or 0.0)
    if width < _ROUNDING:
        width = abs(estimate.value)
    return max(0, 1 - math.floor(math.log10(width))) if width > _ROUNDING else 2


def detectable(effect: Effect) -> str:
    """Return the difference that 8 of 10 audits would find, in whole percentage points."""
    least = effect.least_pp
    return "–" if least is None else str(math.ceil(least))


def won(counts: Sequence[tuple[int, int]]) -> str:
    """Return `2:15/2:11/2:9`, one pair of counts a seed."""
    return "/".join(f"{won}:{lost}" for won, lost in counts)


def p_value(value: float) -> str:
    """Return `0.032`, or `< 0.001`; a digit more where `0.050` would hide the side of 0.05."""
    if value < 0.001:
        return "< 0.001"
    text = f"{value:.3f}"
    return f"{value:.4f}" if text == "0.050" and value != 0.05 else text


def p_equals(value: float) -> str:
    """Return `p = 0.032`, or `p < 0.001`."""
    p = p_value(value)
    return f"p {p}" if p.startswith("<") else f"p = {p}"


def break_even(result: BreakEven) -> str:
    """Return the frequencies at which nobody is significantly ahead, in percent.

    `59 [33, 80]` with the estimate in front where there is one; `[0, 12] and [80, 100]` for two
    pieces; `none` where one variant is ahead throughout; `any` where none is at any frequency.
    Ends are rounded outwards.
    """
    if result.kind == "empty":
        return "none"
    if result.kind == "whole":
        return "any"
    pieces = " and ".join(f"[{last(low)}, {first(high)}]" for low, high in result.pieces)
    return pieces if result.p_star is None else f"{100.0 * result.p_star:.0f} {pieces}"


def reservation(effect: Effect) -> str:
    """Return why an effect makes no headline: the fault never acted, floor, ceiling, failures."""
    if not effect.acted:
        return "fault never acted"
    return effect.extreme or (
        "failed trials" if effect.unsettled or (effect.sign and effect.uneven) else ""
    )


def ended(facts: ComparisonFacts, status: str) -> str:
    """Return what the system calls the way in which a trial ended."""
    return facts.ends.get(status, status)


def faults(facts: ComparisonFacts, units: Mapping[str, str] | None = None) -> str:
    """Return what the fault does to each channel, whoever gets it, with the unit of what it adds
    where `units` of channels are known; empty in results without it."""
    words: list[str] = []
    for fault in facts.faults:
        unit_name = (units or {}).get(fault.channel, "1")
        how = fault.intervention
        added = how.kind in _ADDED and not getattr(how, "relative", False)
        in_unit = f" ({unit(unit_name)})" if added and unit_name not in ("", "1") else ""
        words.append(fault.aimed_at("*").describe() + in_unit)
    # `describe` says at whom a fault aims, and an audit aims it at each in turn.
    return "; ".join(re.sub(" at every [a-z]+", "", text) for text in words)


def unit(name: str) -> str:
    """Return a unit with its exponents raised: `m/s²` for `m/s^2`."""
    return re.sub(r"\^(-?\d)", lambda match: match[1].translate(_RAISED), name)


def in_words(name: str) -> str:
    """Return the name of a module, a source or a signal as part of a sentence."""
    return name.replace("_", " ")


def sentence(words: str) -> str:
    """Return words with a capital letter in front and a full stop behind."""
    return f"{capital(words).removesuffix('.')}."


def seeds_run(facts: ComparisonFacts) -> str:
    """Return `, seeds 0, 1`; nothing for results of other tools that name no seed but 0, nor where
    seeds only number the trials of a task."""
    unnamed = facts.unit == "task" or (facts.judged and facts.seeds == (0,))
    return "" if unnamed else f", {seeds(facts.seeds)}"


def seeds(values: tuple[int, ...]) -> str:
    """Return `seed 0` or `seeds 0, 1, 2`."""
    return f"seed{'s' if len(values) > 1 else ''} {', '.join(map(str, values))}"
