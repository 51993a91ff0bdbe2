"""One consumer's end of one channel: the faults that act there, and what is counted."""

from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import (
    Array,
    HostArray,
    copy,
    device_kind,
    differs,
    is_array,
    namespace,
    place,
    to_numpy,
    together,
)
from faultpath.core.errors import UserError
from faultpath.faults import Draws, Fault, Moment
from faultpath.faults.base import Memory
from faultpath.loop.reading import MalformedReading, NotFinite
from faultpath.loop.receipts import CorruptionReceipt, Receipt


class Tally:
    """Steps at which something held in a scene.

    Counts stay on the device of the masks, so that counting costs no host wait. Several taps may
    report the same step; it counts once.
    """

    __slots__ = ("_done", "_pending", "_step")

    def __init__(self) -> None:
        self._done: Any = 0
        self._pending: Any = False
        self._step = -1

    def note(self, step: int, held: Any) -> None:
        """Report that the bool or boolean array `[B]` `held` at `step`."""
        if step != self._step:
            self._done, self._pending, self._step = self._total(), held, step
        elif self._pending is False:
            self._pending = held
        elif held is not False:
            one, other = together(self._pending, held)
            self._pending = one | other

    def _total(self) -> Any:
        if self._pending is False:
            return self._done
        done, pending = together(self._done, self._pending)
        return done + pending

    def counts(self, n_scenes: int) -> NDArray[np.int64]:
        """Return the counts `[B]`; this waits for the device."""
        total = to_numpy(self._total()).astype(np.int64)
        return np.broadcast_to(total, (n_scenes,)).copy()


class Running:
    """Which scenes are still running, at hand on the device of any reading."""

    __slots__ = ("_mask", "_placed")

    def __init__(self, mask: Array | None) -> None:
        self._mask = mask
        self._placed: Array = mask

    def among(self, held: Any, reading: Array) -> Any:
        """Return `held`, a bool or boolean array `[B]`, where the scene runs."""
        if self._mask is None or held is False:
            return held
        placed = self._placed
        if namespace(placed) is not namespace(reading) or placed.device != reading.device:
            placed = self._placed = place(to_numpy(self._mask), reading)
        return placed if held is True else held & placed


class Guard:
    """Hands out copies of a tap's values and sees whether somebody wrote into them.

    NumPy arrays are read-only views and need none of this. A tensor tells by its version counter;
    one that keeps none (inference mode) is compared with what it was.
    """

    __slots__ = ("_given", "_mark", "_written")

    def __init__(self) -> None:
        self._given: Array = None
        self._mark: Any = None
        self._written: Any = False

    def hand_out(self, value: Array) -> Array:
        """Return a copy for the consumer, after a look at the last one."""
        self._look()
        self._given = copy(value)
        try:
            self._mark = int(self._given._version)
        except (AttributeError, RuntimeError):
            self._mark = copy(self._given)
        return self._given

    def written(self) -> bool:
        """Return whether a consumer wrote; this waits for the device."""
        self._look()
        return bool(to_numpy(self._written))

    def _look(self) -> None:
        if self._given is None:
            return
        if isinstance(self._mark, int):
            changed = bool(self._given._version != self._mark)
        else:
            unequal = differs(self._given, self._mark)
            changed = namespace(unequal).any(unequal)
        self._written = self._written | changed


class Corruption:
    """A resolved fault as it acts on the deliveries of one tap."""

    __slots__ = ("_draws", "_dt_s", "_memories", "fault", "in_force")

    def __init__(self, fault: Fault, draws: Draws, dt_s: float) -> None:
        self.fault = fault
        self.in_force = Tally()
        self._draws = draws
        self._dt_s = dt_s
        self._memories: dict[int, Memory] = {}
        """By ask within a step; a reading that is no query is ask 0."""

    def act(self, reading: Array, step: int, ask: int = 0) -> tuple[Array, bool]:
        """Return the value and whether the fault is in force.

        Raises `UserError` where the intervention cannot act on such a reading.
        """
        fault, doing = self.fault, self.fault.intervention
        if fault.over(step):
            self._memories.clear()
            return reading, False
        draws = self._draws.beside(f"?{ask}") if ask else self._draws
        at = Moment(step, step - fault.onset_step, self._dt_s, draws)
        if ask not in self._memories:
            self._memories[ask] = doing.begin(reading, at)
        value, self._memories[ask] = doing.apply(reading, self._memories[ask], at)
        refused = f"fault on channel '{fault.channel}': {doing.kind}"
        if value is not reading and (value.dtype != reading.dtype or value.shape != reading.shape):
            raise UserError(
                f"{refused} turns {reading.dtype} {list(reading.shape)} into {value.dtype} "
                f"{list(value.shape)}; choose one that keeps them"
            )
        weight = fault.weight(step)
        if weight in (0.0, 1.0):
            return (value, True) if weight else (reading, False)
        if not namespace(reading).isdtype(reading.dtype, "real floating"):
            raise UserError(
                f"{refused} cannot recover step by step in {reading.dtype}; leave recovery out"
            )
        return reading + (value - reading) * weight, True


@dataclass(slots=True, eq=False)
class Tap:
    """One consumer's end of one channel."""

    channel: str
    consumer: str
    source: str
    legal: bool
    shape: tuple[int, ...]
    """Of every reading, scenes first."""
    corruptions: tuple[Corruption, ...] = ()
    deliveries: int = 0
    asks: int = 0
    """Answers of a query, over all steps."""
    asked: int = 0
    """Those of the last step."""
    last_step: int = -1
    given: Array = None
    """The value of the step's reading."""
    cached: Array = None
    """What the consumer got of it."""
    finite: Array = None
    """Where the first reading was finite, until that has been looked at."""
    guard: Guard | None = None
    faulted: Tally = field(default_factory=Tally)
    altered: Tally = field(default_factory=Tally)

    def __str__(self) -> str:
        return f"{self.channel} -> {self.consumer}"

    def add(self, corruption: Corruption) -> None:
        """Let a fault act here; a fault that is alone counts for the whole tap."""
        self.corruptions = (*self.corruptions, corruption)
        self.faulted = corruption.in_force if len(self.corruptions) == 1 else Tally()

    def receipt(self, n_scenes: int) -> Receipt:
        """Return what passed here so far; this waits for the device that holds the counts."""
        return Receipt(
            channel=self.channel,
            consumer=self.consumer,
            source=self.source,
            deliveries=self.deliveries,
            asks=self.asks,
            corruptions=tuple(
                CorruptionReceipt(
                    each.fault.describe(), each.fault.onset_step, each.in_force.counts(n_scenes)
                )
                for each in self.corruptions
            ),
            steps_faulted=self.faulted.counts(n_scenes),
            steps_altered=self.altered.counts(n_scenes),
        )

    def check_first(self, value: Any, scenes: tuple[str, ...]) -> None:
        """Check the first value: an array of real numbers, as declared, all of them finite.

        Raises `MalformedReading`, and `NotFinite` at once where the value is on the host; on an
        accelerator that waits for `check_finite`, so that no delivery waits for the device.
        """
        if not is_array(value):
            raise MalformedReading(
                f"tap {self}: the reading's value is a {type(value).__name__}: give an array with "
                "one row a scene"
            )
        self.check_shape(value)
        if not _real(value):
            raise MalformedReading(
                f"tap {self}: the reading is of {value.dtype}; a source gives real numbers or "
                "truths"
            )
        if namespace(value).isdtype(value.dtype, "real floating"):
            self.finite = namespace(value).isfinite(value)
            if device_kind(value) == "cpu":
                self.check_finite(scenes)

    def check_shape(self, value: Array) -> None:
        """Raise `MalformedReading` for another shape than declared."""
        shape, wanted = list(getattr(value, "shape", ())), list(self.shape)
        if shape == wanted:
            return
        if shape[:1] != wanted[:1]:
            rows = str(shape[0]) if shape else "no"
            raise MalformedReading(
                f"tap {self}: the reading has {rows} rows for {wanted[0]} scenes"
            )
        raise MalformedReading(
            f"tap {self}: the reading of one scene has the shape {shape[1:]}, but source "
            f"'{self.source}' is declared with {wanted[1:]}; mend one of the two"
        )

    def check_finite(self, scenes: tuple[str, ...]) -> None:
        """Raise `NotFinite` when the first value was not; this waits for the device."""
        if self.finite is None:
            return
        finite, self.finite = to_numpy(self.finite), None
        lost = np.flatnonzero(~finite.reshape(len(scenes), -1).all(axis=1))
        if lost.size:
            raise NotFinite(
                f"tap {self}: the first reading is not finite in {lost.size} of {len(scenes)} "
                f"scenes, '{scenes[lost[0]]}' for one"
            )

    def check_same(self, value: Any, step: int) -> None:
        """Raise `MalformedReading` when a second delivery in a step brings another reading.

        On an accelerator the two are not compared, because no delivery waits for it.
        """
        if step < 0:
            raise MalformedReading(f"tap {self}: step {step} is before the first, which is 0")
        alike = is_array(value) and tuple(value.shape) == self.shape
        if alike and device_kind(value) == device_kind(self.given) == "cpu":
            alike = not to_numpy(differs(value, self.given)).any()
        if not alike:
            raise MalformedReading(
                f"tap {self}: step {step} brings two different readings, but a channel has one in "
                "a step; deliver it once, or declare a channel for each"
            )


def _real(value: Array) -> bool:
    if isinstance(value, np.ndarray):
        return cast(HostArray, value).dtype.kind in "biuf"
    return bool(namespace(value).isdtype(value.dtype, ("bool", "integral", "real floating")))
