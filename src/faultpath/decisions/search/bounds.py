"""Within which faults a search looks: `bounds.yaml`, and the fault at each point of it."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.core.files.plain import Misread, read_yaml
from faultpath.core.results import Frozen
from faultpath.decisions.fault_groups import JOINED
from faultpath.faults import FaultText
from faultpath.faults.parse import KINDS
from faultpath.trials import System

_DIGITS = 3
"""Digits of a size, counted from the width of its range, so that it can be typed."""


def _ascending(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] > ends[1]:
        raise ValueError(f"goes from {ends[0]:g} down to {ends[1]:g}: give the lower end first")
    if max(map(abs, ends)) > 1e12:  # sums and roundings of the largest numbers are none
        raise ValueError(f"reaches {max(ends, key=abs):g}: give ends within 1e12")
    return ends


Range = Annotated[tuple[float, float], AfterValidator(_ascending)]
Steps = Annotated[tuple[Annotated[int, Field(ge=0)], int], AfterValidator(_ascending)]
"""Control steps, both ends included."""


class BoundedFault(Frozen, allow_inf_nan=False):
    """A fault without its size, and between which sizes it is looked for."""

    fault: str
    """`gain:scale`, `velocity:noise,relative`, or a preset."""
    size: Range | None = None
    """By default as the interface declares the uncertainty of the source."""

    @property
    def text(self) -> FaultText:
        """The fault, taken apart."""
        return FaultText.read(self.fault)


class Bounds(Frozen, allow_inf_nan=False):
    """Bounds of a search: the faults listed act together, each with a size of its own."""

    isolated: str
    """The module that alone gets the fault in the isolated audit."""
    faults: tuple[BoundedFault, ...] = Field(min_length=1, max_length=8)
    onset: Steps | None = None
    duration: Steps | None = None
    """By default until the end."""
    correlation: Range | None = None
    """Correlation of the errors of faults that draw theirs; independent by default."""

    def ranges(self) -> list[tuple[float, float, bool]]:
        """Return both ends of each number that a fault is made of, and whether it is whole."""
        sizes = [(*fault.size, _whole(fault.text)) for fault in self.faults if fault.size]
        times = [(*ends, True) for ends in (self.onset, self.duration) if ends]
        return [*sizes, *times, *([(*self.correlation, False)] if self.correlation else [])]

    def fault(self, point: Iterable[float]) -> str:
        """Return the fault at a point of the unit cube, which has a dimension for each range."""
        spread = zip(self.ranges(), point, strict=True)
        numbers = [_between(*ends, share) for ends, share in spread]
        texts = [fault.text for fault in self.faults]
        sizes, others = numbers[: len(texts)], iter(numbers[len(texts) :])
        when = {"onset": next(others)} if self.onset else {}
        when |= {"for": next(others)} if self.duration else {}
        # Errors of one cause with the loadings a and b have the correlation a * b.
        correlation, drawn = next(others, 0.0), [text for text in texts if is_drawn(text)]
        parts: list[str] = []
        for text, size in zip(texts, sizes, strict=True):
            options = {**text.options, **{key: f"{steps:g}" for key, steps in when.items()}}
            if len(drawn) > 1 and text in drawn:
                side = math.copysign(1.0, correlation) if text is drawn[-1] else 1.0
                options["loading"] = f"{side * math.sqrt(abs(correlation)):.4g}"
            parts.append(str(replace(text, sizes=(f"{size:.10g}",), options=options)))
        return JOINED.join(parts)


def read_bounds(path: Path, system: System) -> Bounds:
    """Read a file of bounds, with every size that it leaves to the interface.

    `UserError` for one that cannot be read, or holds what cannot be searched.
    """
    try:
        bounds = read_yaml(contents(path)).fill(Bounds)
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}): give a file.") from None
    except Misread as error:
        raise UserError(f"{error.at(path)}.") from None
    try:
        bounds = bounds.model_copy(
            update={"faults": tuple(_spelt(system, fault, bounds) for fault in bounds.faults)}
        )
        _check(bounds)
    except UserError as error:
        raise UserError(f"{path}: {error}") from None
    return bounds


def _spelt(system: System, fault: BoundedFault, bounds: Bounds) -> BoundedFault:
    """Return a fault with its kind and sizes; `UserError` for one that has none."""
    text, label = fault.text, f"fault '{fault.fault}'"
    if text.sizes or text.consumers:
        raise UserError(f"{label}: the search sets size and place: leave '=' and '@' out.")
    for key, ends in (("onset", bounds.onset), ("for", bounds.duration)):
        if ends is not None and {key, f"{key}_s"} & set(text.options):
            raise UserError(f"{label}: '{key}' has a range already; drop one.")
    if text.kind is None and text.name not in system.fault_presets:
        text = replace(text, kind="scale")
    if text.kind in KINDS and not KINDS[text.kind].value_field:
        raise UserError(f"{label}: {text.kind} has no size that could be searched.")
    size = fault.size or _declared(system, text)
    for end in size:
        system.fault(
            str(text.at(f"{_between(end, end, text.kind in KINDS and _whole(text), 0.0):.10g}"))
        )
    return BoundedFault(fault=str(text), size=size)


def _declared(system: System, text: FaultText) -> tuple[float, float]:
    """Return the sizes within the uncertainty that the interface declares: its half-range, or two
    standard deviations to either side."""
    sided, drawn = text.kind in (None, "scale", "offset"), text.kind in ("noise", "bias")
    relative = text.kind in (None, "scale", "uniform_scale") or "relative" in text.options
    most = 0.0
    if sided or drawn or text.kind == "uniform_scale":
        for part in system.fault(str(text.at("0.1"))).resolved(system.interface):
            source = system.interface.source(system.interface.channel(part.channel).sources[0])
            known = source.uncertainty
            if known and known.relative is relative:
                most = max(
                    most,
                    known.expected_std if drawn else known.half_range or 2 * known.expected_std,
                )
    if not most:
        raise UserError(
            f"fault '{text}': the interface declares no uncertainty that gives its sizes; state "
            "them, as in size: [0.8, 1.2]."
        )
    middle = 1.0 if text.kind == "scale" else 0.0
    return (middle - most if sided else 0.0), middle + most


def _check(bounds: Bounds) -> None:
    drawn = sum(is_drawn(fault.text) for fault in bounds.faults)
    if ends := bounds.correlation:
        least = -1.0 if drawn == 2 else 0.0
        if drawn < 2:
            raise UserError(
                "correlation is of errors that are drawn, as noise and bias are, and fewer than "
                "two faults draw theirs: drop it."
            )
        if ends[0] < least or ends[1] > 1.0:
            raise UserError(f"correlation: of {drawn} errors it lies between {least:g} and 1.")
    if all(low == high for low, high, _ in bounds.ranges()):
        raise UserError("nothing is left to search: give a range with two different ends.")


def is_drawn(text: FaultText) -> bool:
    """Return whether the errors of a fault are random."""
    return text.kind is not None and KINDS[text.kind].random


def _whole(text: FaultText) -> bool:
    kind = KINDS.get(text.kind or "")
    return kind is not None and kind.model_fields[kind.value_field or ""].annotation is int


def _between(low: float, high: float, whole: bool, share: float) -> float:
    value = low + (high - low) * float(share)
    if whole:
        return float(round(value))
    digits = _DIGITS - 1 - math.floor(math.log10(high - low)) if high > low else 12
    return min(max(round(value, digits), low), high) + 0.0
