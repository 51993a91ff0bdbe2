"""A fault: a channel, the consumers that get it, what is done to them, and when."""

from collections.abc import Collection
from math import inf
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from faultpath.core.errors import UserError
from faultpath.core.frozen import Frozen
from faultpath.core.text import listed, unknown
from faultpath.faults.draws import Draws
from faultpath.faults.registry import AnyIntervention
from faultpath.interface import Interface, module_of, modules

ALL = "*"
"""Every consumer of the channel: the fault is shared."""


class Fault(Frozen):
    """One intervention on one channel, at some or all of its consumers, for some time.

    `isolated` and `shared` are the same fault with two values of `consumers`. During recovery the
    value returns linearly to the reading, number by number.
    """

    kind: Literal["fault"] = "fault"
    channel: str
    intervention: AnyIntervention
    consumers: tuple[str, ...] = Field(default=(ALL,), min_length=1)
    """Consumers (`module.place`), whole modules, or `*` for everyone who reads the channel."""
    onset_step: int = Field(default=0, ge=0)
    """First step in force."""
    duration_steps: int | None = Field(default=None, ge=1)
    """Steps in force; `None`: until the end."""
    recovery_steps: int = Field(default=0, ge=0)
    """Steps of linear return to the clean reading after `duration_steps`."""
    intermittence: None = None
    """A key of stored faults; always `null`."""
    cause: str | None = None
    """Faults of one cause draw the same random numbers; `None`: the channel and the kind."""
    loading: float = Field(default=1.0, ge=-1, le=1)
    """Share of the cause in the random numbers: two faults of one cause with the loadings a and b
    have errors of correlation a * b."""
    own_cause: None = None
    """A key of stored faults; always `null`."""

    @model_validator(mode="after")
    def _recovers_from_an_end(self) -> Self:
        if self.recovery_steps and self.duration_steps is None:
            raise ValueError("recovery_steps needs an end to recover from; give duration_steps")
        return self

    @model_validator(mode="after")
    def _loads_on_draws(self) -> Self:
        if self.loading != 1.0 and not self.intervention.is_random():
            raise ValueError(f"{self.intervention.kind} takes no loading; leave it out")
        return self

    @property
    def drawn_from(self) -> str:
        """The cause that addresses the random numbers."""
        return self.cause or f"{self.channel}:{self.intervention.kind}"

    def draws(self, scenes: tuple[str, ...], seed: int) -> Draws:
        """Return the random numbers of the fault, which all of its consumers share."""
        if self.loading == 1.0:
            return Draws(scenes, seed, self.drawn_from)
        own = f"{self.drawn_from}/own/{self.channel}:{self.intervention.kind}"
        return Draws(scenes, seed, self.drawn_from, self.loading, Draws(scenes, seed, own))

    def aimed_at(self, *names: str) -> Self:
        """Return the same fault at other consumers: `module.place`, modules, or `*`."""
        return self.model_copy(update={"consumers": names or (ALL,)})

    def validate_against(self, interface: Interface) -> None:
        """Raise `UserError` unless the fault can act on `interface`."""
        channel = interface.channel(self.channel)
        for name in self.consumers:
            if not _matching(name, channel.consumers):
                raise UserError(_no_reader(interface, (self.channel,), name))
        shape = interface.source(channel.sources[0]).shape
        wrong = self.intervention.misfit(shape)
        if wrong:
            raise UserError(
                f"channel '{self.channel}': {self.intervention.kind} does not fit: {wrong}"
            )

    def resolved(
        self, interface: Interface, present: Collection[str] | None = None
    ) -> tuple["Fault", ...]:
        """Return the fault with every consumer spelled out and defaults filled in.

        Consumers that are not `present` in a variant are left out; the result is empty when none is
        left, that is, when the fault cannot reach the variant. Raises `UserError` as
        `validate_against`.
        """
        self.validate_against(interface)
        return self._resolved(interface, present)

    def _resolved(
        self, interface: Interface, present: Collection[str] | None
    ) -> tuple["Fault", ...]:
        channel = interface.channel(self.channel)
        reached = tuple(
            consumer
            for consumer in channel.consumers
            if any(_matching(name, (consumer,)) for name in self.consumers)
            and (present is None or consumer in present)
        )
        intervention = self.intervention.resolved(channel)
        update = {"consumers": reached, "intervention": intervention, "cause": self.drawn_from}
        return (self.model_copy(update=update),) if reached else ()

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
        return f"{self.channel} {self.intervention.words()} at {_at(self.consumers)}{self._when()}"

    def _when(self) -> str:
        words = f" from step {self.onset_step}" if self.onset_step else ""
        if self.duration_steps is not None:
            words += f" for {self.duration_steps} steps"
        if self.recovery_steps:
            words += f", recovering over {self.recovery_steps}"
        return words


class Coupled(Frozen):
    """Faults on several channels with one cause, for instance a calibration error.

    They draw the same random numbers. A name in `consumers` needs to read only one of the channels.
    """

    kind: Literal["coupled"] = "coupled"
    name: str
    faults: tuple[Fault, ...] = Field(min_length=1)

    def aimed_at(self, *names: str) -> Self:
        """Return the same faults at other consumers: `module.place`, modules, or `*`."""
        return self.model_copy(update={"faults": tuple(f.aimed_at(*names) for f in self.faults)})

    def validate_against(self, interface: Interface) -> None:
        """Raise `UserError` unless the faults can act on `interface`."""
        readers = {c for f in self.faults for c in interface.channel(f.channel).consumers}
        for fault in self.faults:
            for name in fault.consumers:
                if not _matching(name, readers):
                    channels = tuple(f.channel for f in self.faults)
                    raise UserError(_no_reader(interface, channels, name))
            fault.aimed_at(ALL).validate_against(interface)

    def resolved(
        self, interface: Interface, present: Collection[str] | None = None
    ) -> tuple[Fault, ...]:
        """Return the faults as `Fault.resolved` does, without those that reach nobody."""
        self.validate_against(interface)
        shared = (f.model_copy(update={"cause": f.cause or self.name}) for f in self.faults)
        # The parts were validated together above: a consumer may read only one of the channels.
        return tuple(found for f in shared for found in f._resolved(interface, present))  # pyright: ignore[reportPrivateUsage]

    def describe(self) -> str:
        """Return the faults in a few words."""
        return f"{self.name}: " + "; ".join(fault.describe() for fault in self.faults)


AnyFault: TypeAlias = Annotated[Fault | Coupled, Field(discriminator="kind")]
"""A fault as arms carry it; its `kind` says in JSON which."""


def _matching(name: str, consumers: Collection[str]) -> bool:
    return any(name in (ALL, consumer, module_of(consumer)) for consumer in consumers)


def _at(consumers: tuple[str, ...]) -> str:
    return "every consumer" if ALL in consumers else ", ".join(consumers)


def _no_reader(interface: Interface, channels: tuple[str, ...], name: str) -> str:
    readers = {c for channel in channels for c in interface.channel(channel).consumers}
    everyone = {c for channel in interface.channels for c in channel.consumers}
    known = readers | {module_of(reader) for reader in readers}
    what = " and ".join(f"channel '{channel}'" for channel in channels)
    if name in everyone or name in modules(interface):
        return f"{what}: '{name}' does not read it; its readers: {listed(known)}"
    return f"{what}: {unknown('consumer', name, known)}"
