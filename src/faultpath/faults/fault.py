"""A fault: a channel, who gets it, which of all interventions, and when."""

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
"""Every reader of the channel: the fault is shared."""


class Fault(Frozen):
    """One intervention on one channel, at some or all of its readers, for some time.

    `isolated` and `shared` are the same fault with two values of `readers`. During recovery the
    value returns linearly to the reading, number by number.
    """

    kind: Literal["fault"] = "fault"
    """Stored with trials, whose identity it is part of."""
    channel: str
    intervention: AnyIntervention
    readers: tuple[str, ...] = Field(default=(ALL,), min_length=1)
    """Readers (`module.place`), whole modules, or `*` for everyone who reads the channel."""
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
        """The cause that addresses the random numbers."""
        return self.cause or f"{self.channel}:{self.intervention.kind}"

    def draws(self, scenes: tuple[str, ...], seed: int) -> Draws:
        """Return the random numbers of the fault, which all of its readers share."""
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
        """Return whether nothing is in force any more."""
        return step >= self._end + self.recovery_steps

    def weight(self, step: int) -> float:
        """Return the share of the fault in the value: 1 in the window, 0 outside, between after it.

        In recovery step k = 1 … n it is 1 - k / (n + 1), so the reading is clean again in step
        n + 1.
        """
        if step < self.onset_step:
            return 0.0
        left = (self.recovery_steps - (step - self._end)) / (self.recovery_steps + 1)
        return min(max(left, 0.0), 1.0)

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
    """Return faults in a few words each."""
    return "; ".join(fault.describe() for fault in faults)


def at_readers(faults: Iterable[Fault], names: Collection[str]) -> tuple[Fault, ...]:
    """Return resolved faults at those of their readers that are named, as places or by modules;
    without the faults that then reach nobody."""
    narrowed: list[Fault] = []
    for fault in faults:
        readers = tuple(c for c in fault.readers if c in names or module_of(c) in names)
        if readers:
            narrowed.append(fault.aimed_at(*readers))
    return tuple(narrowed)


def reaching(faults: Iterable[Fault], present: Collection[str]) -> tuple[Fault, ...]:
    """Return resolved faults at the readers that are present; `UserError` where none of them is."""
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
    """Return faults that act together as `Taps` takes them: with every reader spelled out, and
    defaults filled in.

    A reader that they name needs to read only one of their channels. Readers that are not `present`
    in a variant are left out, see `reaching`. Raises `UserError` for a fault that cannot act on
    `interface`.
    """
    faults = tuple(faults)
    channels = [interface.channel(fault.channel) for fault in faults]
    resolved: list[Fault] = []
    for fault, channel in zip(faults, channels, strict=True):
        _check_readers(fault.readers, channels, interface)
        wrong = fault.intervention.misfit(interface.source(channel.sources[0]).shape)
        if wrong:
            kind = fault.intervention.kind
            lead = "" if wrong.startswith(f"{kind} ") else f"{kind} does not fit: "
            raise UserError(f"channel '{fault.channel}': {lead}{wrong}")
        update = {
            "readers": channel.readers,
            "intervention": fault.intervention.resolved(channel),
            "cause": fault.drawn_from,
        }
        names = channel.readers if ALL in fault.readers else fault.readers
        resolved += at_readers((fault.model_copy(update=update),), names)
    return tuple(resolved) if present is None else reaching(resolved, present)


def _check_readers(names: Iterable[str], channels: Iterable[Channel], interface: Interface) -> None:
    """Raise `UserError` for a name of nobody who reads one of the channels."""
    readers = {reader for channel in channels for reader in channel.readers}
    known = readers | {module_of(reader) for reader in readers}
    for name in names:
        if name == ALL or name in known:
            continue
        what = " and ".join(f"channel '{channel.name}'" for channel in channels)
        everyone = {reader for channel in interface.channels for reader in channel.readers}
        if name in everyone or name in modules(interface):
            problem = f"'{name}' does not read it; its readers: {listed(known)}"
        else:
            problem = unknown("reader", name, known)
        raise UserError(f"{what}: {problem}")
