"""A fault: which channel, which readers, which intervention, and when."""

from collections.abc import Collection, Iterable
from math import inf
from typing import Literal, Self

from pydantic import Field, model_validator

from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.text import listed, unknown
from faultpath.faults.base import Draws
from faultpath.faults.kinds import AnyIntervention
from faultpath.interface import Channel, Interface, module_of, modules

ALL = "*"
"""All readers of the channel: the fault is shared."""


class Fault(Frozen):
    """One intervention on one channel, at some or all of its readers, for some time.

    An isolated and a shared fault differ in `readers` only. During recovery the value returns
    linearly to the reading, number by number.
    """

    kind: Literal["fault"] = "fault"
    """Part of the identity of stored trials."""
    channel: str
    intervention: AnyIntervention
    readers: tuple[str, ...] = Field(default=(ALL,), min_length=1)
    """Readers (`module.place`), whole modules, or `*` for all readers of the channel."""
    onset_step: int = Field(default=0, ge=0)
    """First step in force."""
    duration_steps: int | None = Field(default=None, ge=1)
    """Steps in force; `None`: until the end."""
    recovery_steps: int = Field(default=0, ge=0)
    """Steps of linear return to the clean reading after `duration_steps`."""
    cause: str | None = None
    """Faults of one cause draw the same random numbers; `None`: the channel and the kind."""
    loading: float = Field(default=1.0, ge=-1, le=1)
    """Share of the cause in the random numbers: two faults of one cause with the loadings a and b
    have errors of correlation a * b."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.recovery_steps and self.duration_steps is None:
            raise ValueError("recovery_steps needs an end to recover from; give duration_steps")
        if self.loading != 1.0 and not self.intervention.is_random():
            raise ValueError(f"{self.intervention.kind} takes no loading; leave it out")
        return self

    @property
    def drawn_from(self) -> str:
        """Cause that addresses the random numbers."""
        return self.cause or f"{self.channel}:{self.intervention.kind}"

    def draws(self, scenes: tuple[str, ...], seed: int) -> Draws:
        """Return the fault's random numbers, which all of its readers share."""
        if self.loading == 1.0:
            return Draws(scenes, seed, self.drawn_from)
        own = f"{self.drawn_from}/own/{self.channel}:{self.intervention.kind}"
        return Draws(scenes, seed, self.drawn_from, self.loading, Draws(scenes, seed, own))

    def aimed_at(self, *names: str) -> Self:
        """Return the same fault at other readers: `module.place`, modules, or `*`."""
        return self.model_copy(update={"readers": names or (ALL,)})

    @property
    def _end(self) -> float:
        return inf if self.duration_steps is None else self.onset_step + self.duration_steps

    def over(self, step: int) -> bool:
        """Return whether the fault and its recovery have ended."""
        return step >= self._end + self.recovery_steps

    def weight(self, step: int) -> float:
        """Return the fault's share of the value: 1 in the window, falling in recovery, else 0.

        In recovery step k = 1 … n it is 1 - k / (n + 1), so the reading is clean again in step
        n + 1.
        """
        if step < self.onset_step:
            return 0.0
        # This line through the recovery is above 1 in the window and below 0 afterwards.
        share = (self.recovery_steps - (step - self._end)) / (self.recovery_steps + 1)
        return min(max(share, 0.0), 1.0)

    def describe(self) -> str:
        """Return the fault in a few words."""
        at = "every reader" if ALL in self.readers else ", ".join(self.readers)
        words = f"{self.channel} {self.intervention.words()} at {at}"
        words += f" from step {self.onset_step}" if self.onset_step else ""
        if self.duration_steps is not None:
            words += f" for {self.duration_steps} steps"
        if self.recovery_steps:
            words += f", recovering over {self.recovery_steps}"
        return words


def describe(faults: Iterable[Fault]) -> str:
    """Return each fault in a few words."""
    return "; ".join(fault.describe() for fault in faults)


def at_readers(faults: Iterable[Fault], names: Collection[str]) -> tuple[Fault, ...]:
    """Return resolved faults at the named readers or modules only, dropping faults left without a
    reader."""
    narrowed: list[Fault] = []
    for fault in faults:
        readers = tuple(c for c in fault.readers if c in names or module_of(c) in names)
        if readers:
            narrowed.append(fault.aimed_at(*readers))
    return tuple(narrowed)


def reaching(faults: Iterable[Fault], present: Collection[str]) -> tuple[Fault, ...]:
    """Return resolved faults at the present readers only; `UserError` where that leaves none."""
    faults = tuple(faults)
    reached = at_readers(faults, present)
    if faults and not reached:
        raise UserError(
            f"fault '{describe(faults)}' reaches no reader: here are {listed(present)}; leave the "
            "fault out or name other readers"
        )
    return reached


def resolve(
    faults: Iterable[Fault], interface: Interface, present: Collection[str] | None = None
) -> tuple[Fault, ...]:
    """Return faults that act together with all readers spelled out and defaults filled in.

    `Taps` takes them in this form. A named reader has to read only one of the faults' channels.
    Readers that a variant does not have are left out: `present` lists those it has; see `reaching`.
    Raises `UserError` for a fault that cannot act on `interface`.
    """
    faults = tuple(faults)
    channels = [interface.channel(fault.channel) for fault in faults]
    resolved: list[Fault] = []
    for fault, channel in zip(faults, channels, strict=True):
        _check_readers(fault.readers, channels, interface)
        reason = fault.intervention.misfit(interface.source(channel.sources[0]).shape)
        if reason:
            kind = fault.intervention.kind
            lead = "" if reason.startswith(f"{kind} ") else f"{kind} does not fit: "
            raise UserError(f"channel '{fault.channel}': {lead}{reason}")
        update = {
            "readers": channel.readers,
            "intervention": fault.intervention.resolved(channel),
            "cause": fault.drawn_from,
        }
        names = channel.readers if ALL in fault.readers else fault.readers
        resolved += at_readers((fault.model_copy(update=update),), names)
    return tuple(resolved) if present is None else reaching(resolved, present)


def _check_readers(names: Iterable[str], channels: Iterable[Channel], interface: Interface) -> None:
    """Raise `UserError` for a name that is no reader of any of the channels."""
    readers = {reader for channel in channels for reader in channel.readers}
    known = readers | {module_of(reader) for reader in readers}
    for name in names:
        if name == ALL or name in known:
            continue
        what = " and ".join(f"channel '{channel.name}'" for channel in channels)
        all_readers = {reader for channel in interface.channels for reader in channel.readers}
        if name in all_readers or name in modules(interface):
            problem = f"'{name}' does not read it; its readers: {listed(known)}"
        else:
            problem = unknown("reader", name, known)
        raise UserError(f"{what}: {problem}")
