"""What faults and readings have to be before a tap delivers."""

from collections.abc import Sequence
from itertools import combinations
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import (
    Array,
    HostArray,
    device_kind,
    differs,
    is_array,
    namespace,
    to_numpy,
)
from faultpath.core.errors import UserError
from faultpath.faults import Fault
from faultpath.loop.taps.reading import MalformedReading, NotFinite
from faultpath.loop.taps.tap import Tap


def check_draws(faults: Sequence[Fault]) -> None:
    """Raise `UserError` for two faults whose own random numbers are the same."""
    apart = [fault for fault in faults if abs(fault.loading) < 1]
    for one, other in combinations(apart, 2):
        if [one.drawn_from, one.channel, one.intervention.kind] == [
            other.drawn_from,
            other.channel,
            other.intervention.kind,
        ]:
            raise UserError(
                f"faults '{one.describe()}' and '{other.describe()}' have a loading and draw the "
                "same numbers nevertheless: give them different causes"
            )


def check_first(tap: Tap, value: Any, scenes: tuple[str, ...]) -> None:
    """Check the first value at a tap: an array of real numbers, as declared, all of them finite.

    Raises `MalformedReading`, and `NotFinite` at once where the value is on the host; on an
    accelerator that waits for `check_finite`, so that no delivery waits for the device.
    """
    if not is_array(value):
        raise MalformedReading(
            f"tap {tap}: the reading's value is a {type(value).__name__}: give an array with one "
            "row a scene"
        )
    check_shape(tap, value)
    if not _real(value):
        raise MalformedReading(
            f"tap {tap}: the reading is of {value.dtype}; a source gives real numbers or truths"
        )
    if namespace(value).isdtype(value.dtype, "real floating"):
        tap.finite = namespace(value).isfinite(value)
        if device_kind(value) == "cpu":
            check_finite(tap, scenes)


def check_shape(tap: Tap, value: Array) -> None:
    """Raise `MalformedReading` for another shape than declared."""
    shape, wanted = list(getattr(value, "shape", ())), list(tap.shape)
    if shape == wanted:
        return
    if shape[:1] != wanted[:1]:
        rows = str(shape[0]) if shape else "no"
        raise MalformedReading(f"tap {tap}: the reading has {rows} rows for {wanted[0]} scenes")
    raise MalformedReading(
        f"tap {tap}: the reading of one scene has the shape {shape[1:]}, but source "
        f"'{tap.source}' is declared with {wanted[1:]}; mend one of the two"
    )


def check_finite(tap: Tap, scenes: tuple[str, ...]) -> None:
    """Raise `NotFinite` when the first value at a tap was not; this waits for the device."""
    if tap.finite is None:
        return
    finite, tap.finite = to_numpy(tap.finite), None
    lost = np.flatnonzero(~finite.reshape(len(scenes), -1).all(axis=1))
    if lost.size:
        raise NotFinite(
            f"tap {tap}: the first reading is not finite in {lost.size} of {len(scenes)} scenes, "
            f"'{scenes[lost[0]]}' for one"
        )


def check_same(tap: Tap, value: Any, step: int) -> None:
    """Raise `MalformedReading` when a second delivery in a step brings another reading.

    On an accelerator the two are not compared, because no delivery waits for it.
    """
    if step < 0:
        raise MalformedReading(f"tap {tap}: step {step} is before the first, which is 0")
    if not is_array(value) or tuple(value.shape) != tap.shape:
        raise _two_readings(tap, step)
    if device_kind(value) == device_kind(tap.given) == "cpu" and bool(
        to_numpy(differs(value, tap.given)).any()
    ):
        raise _two_readings(tap, step)


def _two_readings(tap: Tap, step: int) -> MalformedReading:
    return MalformedReading(
        f"tap {tap}: step {step} brings two different readings, but a channel has one in a step; "
        "deliver it once, or declare a channel for each"
    )


def _real(value: Array) -> bool:
    if isinstance(value, np.ndarray):
        return cast(HostArray, value).dtype.kind in "biuf"
    return bool(namespace(value).isdtype(value.dtype, ("bool", "integral", "real floating")))
