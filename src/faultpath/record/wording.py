"""How numbers are written. Pictures, tables and pages all use these, so they agree to the digit."""

import re

from faultpath.record.breakeven_words import first, last
from faultpath.record.model import Effect
from faultpath.record.question import Question
from faultpath.statistics import BreakEven, Estimate

MINUS = "−"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_HYPHEN_FOR_MINUS = re.compile(r"(?<![\w.)\]])-(?=\d)")


def signed(value: float, digits: int = 1) -> str:
    """Return `+6.7`, `−9.7` or `0.0`: a difference always shows its sign, zero has none."""
    text = f"{value:+.{digits}f}"
    if float(text) == 0.0:
        return text[1:]
    return text.replace("-", MINUS)


def plain(value: float, digits: int = 1) -> str:
    """Return the number with a real minus sign."""
    text = f"{value:.{digits}f}"
    return (text.removeprefix("-") if float(text) == 0.0 else text).replace("-", MINUS)


def interval(estimate: Estimate, digits: int = 1) -> str:
    """Return `[−16.0, −4.0]`, or nothing where no interval exists."""
    if estimate.low is None or estimate.high is None:
        return ""
    return f"[{plain(estimate.low, digits)}, {plain(estimate.high, digits)}]"


def with_interval(estimate: Estimate | None, digits: int = 1) -> str:
    """Return `−9.7 [−16.0, −4.0]`; a dash for an estimate that does not exist."""
    if estimate is None:
        return "–"
    return f"{signed(estimate.value, digits)} {interval(estimate, digits)}".rstrip()


def wins_losses(wins: tuple[int, ...], losses: tuple[int, ...]) -> str:
    """Return `2:15/2:11/2:9`, one pair of counts a seed."""
    return "/".join(f"{w}:{lost}" for w, lost in zip(wins, losses, strict=True))


def p_value(value: float) -> str:
    """Return `0.032`, or `< 0.001`; a digit more where `0.050` would hide the side of 0.05."""
    if value < 0.001:
        return "< 0.001"
    text = f"{value:.3f}"
    return f"{value:.4f}" if text == "0.050" and value != 0.05 else text


def break_even(result: BreakEven) -> str:
    """Return the frequencies at which nobody is decided to be ahead, in percent.

    `59 % [33, 80]` with the estimate in front where there is one; `[0, 12] and [80, 100]` for two
    pieces; `none` where one arm is ahead throughout; `any` where at no frequency it is decided who
    is. Ends are rounded outwards.
    """
    if result.kind == "empty":
        return "none"
    if result.kind == "whole":
        return "any"
    pieces = " and ".join(f"[{last(low)}, {first(high)}]" for low, high in result.pieces)
    return pieces if result.p_star is None else f"{100.0 * result.p_star:.0f} % {pieces}"


def percent(fraction: float) -> str:
    """Return a fraction as whole percent, without the sign."""
    return f"{100.0 * fraction:.0f}"


def adjusted(effect: Effect) -> str:
    """Return an effect's p-value within its family; a dash where it is in none."""
    return "–" if effect.adjusted_p_value is None else p_value(effect.adjusted_p_value)


def reservation(effect: Effect) -> str:
    """Return why an effect makes no headline: the fault never acted, floor, ceiling, failures."""
    if not effect.acted:
        return "fault never acted"
    return effect.extreme or ("failed trials" if effect.uneven or effect.unsettled else "")


def ended(question: Question, status: str) -> str:
    """Return what the system calls the way in which a trial ended."""
    return question.ends.get(status, status)


def typeset(text: str) -> str:
    """Return a record's sentence with real minus signs before its numbers."""
    return _HYPHEN_FOR_MINUS.sub(MINUS, text)


def unit(name: str) -> str:
    """Return a unit with its exponents raised: `m/s²` for `m/s^2`."""
    return re.sub(r"\^(-?\d)", lambda found: found[1].translate(_RAISED), name)


def sentence(words: str) -> str:
    """Return words with a capital letter in front and a full stop behind."""
    return f"{words[:1].upper()}{words[1:].removesuffix('.')}."


def seeds(values: tuple[int, ...]) -> str:
    """Return `seed 0` or `seeds 0, 1, 2`."""
    return f"seed{'s' if len(values) > 1 else ''} {', '.join(map(str, values))}"


def counted(count: int, noun: str) -> str:
    """Return `1 pair` or `2 pairs`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
