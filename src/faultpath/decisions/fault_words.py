"""What a fault does to each reading, in numbers and units."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from faultpath.decisions.question import Question
from faultpath.decisions.wording import MINUS, capital
from faultpath.faults import Fault
from faultpath.faults.base import number as plain_number
from faultpath.interface import Interface


@dataclass(frozen=True)
class _Reading:
    """What a sentence on one channel needs of its declaration."""

    unit: str
    shape: tuple[int, ...]
    dt_s: float

    def amount(self, value: Any) -> str:
        """Return `0.5 kg`; without the unit where it is 1, in brackets where numbers differ."""
        if self.unit == "1":
            return number(value)
        return (
            f"{number(value)} ({self.unit})" if "," in self.unit else f"{number(value)} {self.unit}"
        )

    def steps(self, count: int) -> str:
        """Return `5 steps (0.25 s)`."""
        return f"{count} step{'' if count == 1 else 's'} ({count * self.dt_s:g} s)"

    def deviation(self, what: Any) -> str:
        """Return the standard deviation of an error."""
        if not what.relative:
            return f"standard deviation {self.amount(what.std)}"
        of = (
            f"{_percent(what.std)} of"
            if isinstance(what.std, float)
            else number(what.std) + " times"
        )
        return f"standard deviation {of} the reading"


def number(value: Any) -> str:
    """Return a number, or nested numbers, with real minus signs."""
    return plain_number(value).replace("-", MINUS)


def fault_words(question: Question, interface: Interface, dt_s: float) -> str:
    """Return what the fault of an audit does, channel by channel; nothing without any.

    `dt_s` is the length of a control step.
    """
    faults = question.faults
    if not faults:
        return ""
    times = [_when(fault, dt_s) for fault in faults]
    alike = len(set(times)) == 1
    clauses = [
        f"{fault.channel.replace('_', ' ')} is {_done(fault, interface, dt_s)}"
        + ("" if alike or not time else f", {time}")
        for fault, time in zip(faults, times, strict=True)
    ]
    said = [capital("; ".join(clauses)), _together(faults), capital(times[0]) if alike else ""]
    return " ".join(f"{each}." for each in said if each)


def _done(fault: Fault, interface: Interface, dt_s: float) -> str:
    source = interface.source(interface.channel(fault.channel).sources[0])
    return _said(fault.intervention, _Reading(source.unit, source.shape, dt_s))


def _together(faults: Sequence[Fault]) -> str:
    """Say that several errors have one cause, or how their draws go together."""
    if len(faults) < 2 or len({fault.cause for fault in faults}) > 1:
        return ""
    loadings = {fault.loading for fault in faults}
    if loadings == {1.0}:
        return "These errors have one cause"
    if len(loadings) > 1:
        return "The errors are drawn partly in common"
    return f"The errors have a correlation of {loadings.pop() ** 2:.3g}"


def _when(fault: Fault, dt_s: float) -> str:
    """Say when the fault is in force; nothing where it is so throughout."""
    at = _Reading("1", (), dt_s)
    parts: list[str] = []
    if fault.onset_step:
        parts.append(f"from step {fault.onset_step} ({fault.onset_step * dt_s:g} s)")
    if fault.duration_steps is not None:
        parts.append(f"for {at.steps(fault.duration_steps)}")
    if fault.recovery_steps:
        parts.append(f"then back to the reading over {at.steps(fault.recovery_steps)}")
    if fault.intermittence:
        parts.append(fault.intermittence.words())
    return f"in force {', '.join(parts)}" if parts else ""


def _said(what: Any, of: _Reading) -> str:
    return _WORDS[what.kind](what, of)


def _percent(share: float) -> str:
    return f"{100 * share:.4g} %"


def _scaled(what: Any, of: _Reading) -> str:
    factor = what.factor
    times = f"times {number(factor)}"
    if not isinstance(factor, float) or not 0 < factor < 2:
        return f"supplied {times}"
    if factor == 1.0:
        return f"supplied as it is ({times})"
    # A vector has no high and low; of a number that may be negative the factor tells the truth.
    more, less = ("too large", "too small") if of.shape else ("too high", "too low")
    return f"supplied {_percent(abs(factor - 1))} {more if factor > 1 else less} ({times})"


def _shifted(what: Any, of: _Reading) -> str:
    by = what.by
    if not isinstance(by, float):
        return f"shifted by {of.amount(by)}"
    if by == 0.0:
        return f"supplied as it is (shifted by {of.amount(by)})"
    each = ", each of its numbers," if of.shape else ""
    return f"supplied{each} {of.amount(abs(by))} {'too high' if by > 0 else 'too low'}"


def _drifting(what: Any, of: _Reading) -> str:
    walk = f"a random walk of standard deviation {of.amount(what.walk_per_sqrt_s)} after a second"
    if what.rate_per_s == 0:
        return f"supplied with {walk}"
    ramp = f"supplied with an error that grows by {of.amount(what.rate_per_s)} a second"
    return f"{ramp}, and {walk}" if what.walk_per_sqrt_s else ramp


def _biased(what: Any, of: _Reading) -> str:
    if what.time_constant_s is None:
        return f"supplied with an error drawn once a scene, {of.deviation(what)}"
    return (
        f"supplied with a wandering error, {of.deviation(what)}, time constant "
        f"{what.time_constant_s:g} s"
    )


def _erased(what: Any, of: _Reading) -> str:
    value = "a default" if what.default is None else of.amount(what.default)
    return f"replaced by {value}, which carries no information"


def _lost(what: Any, of: _Reading) -> str:
    instead = (
        "and the last that arrived stands in"
        if what.substitute is None
        else f"and then {_erased(what.substitute, of)}"
    )
    return f"lost at each step with probability {_percent(what.probability)}, {instead}"


_WORDS: Mapping[str, Callable[[Any, _Reading], str]] = {
    "scale": _scaled,
    "uniform_scale": lambda what, of: (
        f"supplied times a factor drawn once a scene between {1 - what.half_range:g} and "
        f"{1 + what.half_range:g}"
    ),
    "offset": _shifted,
    "quantise": lambda what, of: f"rounded to multiples of {of.amount(what.step_size)}",
    "erase": _erased,
    "noise": lambda what, of: f"supplied with noise drawn at each step, {of.deviation(what)}",
    "drift": _drifting,
    "bias": _biased,
    "delay": lambda what, of: f"delivered {of.steps(what.steps)} late",
    "hold": lambda what, of: f"refreshed only every {of.steps(what.every)}",
    "freeze": lambda what, of: "frozen at what it shows when the fault begins",
    "dropout": _lost,
    "replace": lambda what, of: f"replaced by {of.amount(what.value)}",
    "shuffle": lambda what, of: f"shuffled along axis {what.axis}",
    "sequence": lambda what, of: ", then ".join(_said(part, of) for part in what.parts),
}
