"""How numbers are written. Pictures, tables and pages all use these, so they agree to the digit."""

import re

from faultpath.statistics import BreakEven, Estimate

MINUS = "−"
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


def percent(fraction: float) -> str:
    """Return a fraction as whole percent, without the sign."""
    return f"{100.0 * fraction:.0f}"


def break_even(result: BreakEven) -> str:
    """Return `59 % [33, 80]`: where the estimates cross, and the frequencies not decided."""
    point = "no crossing" if result.p_star is None else f"{percent(result.p_star)} %"
    pieces = " or ".join(f"[{percent(low)}, {percent(high)}]" for low, high in result.pieces)
    return f"{point} {pieces}".rstrip()


def break_even_sentence(result: BreakEven) -> str:
    """Return what the break-even means, short enough to stand under a picture's title."""
    return f"repair {result.words}"


def typeset(text: str) -> str:
    """Return a record's sentence with real minus signs before its numbers."""
    return _HYPHEN_FOR_MINUS.sub(MINUS, text)


def sentence(words: str) -> str:
    """Return words with a capital letter in front and a full stop behind."""
    return f"{words[:1].upper()}{words[1:].removesuffix('.')}."


def seeds(values: tuple[int, ...]) -> str:
    """Return `seed 0` or `seeds 0, 1, 2`."""
    return f"seed{'s' if len(values) > 1 else ''} {', '.join(map(str, values))}"


def counted(count: int, noun: str) -> str:
    """Return `1 pair` or `2 pairs`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
