"""A fault: a channel, the consumers that get it, which of all interventions, and when."""

from collections.abc import Collection, Iterable
from dataclasses import replace
from math import inf
from typing import Annotated, Literal, Self, TypeAlias, get_args

from pydantic import Discriminator, Field, model_validator

from faultpath.core.arrays import Array
from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.text import listed, unknown
from faultpath.faults.base import Draws, Intervention, Memory, Moment
from faultpath.faults.drawn import Bias, Drift, Dropout, Noise, Shuffle, UniformScale
from faultpath.faults.recorded import Recorded
from faultpath.faults.values import Delay, Erase, Freeze, Hold, Offset, Quantise, Rotate, Scale
from faultpath.interface import Channel, Interface, module_of, modules


class Sequence(Intervention):
    """Apply interventions in turn: each acts on what the one before delivers.

    Each part begins at the onset, so a delay after a scale still delivers what came unscaled
    before it, just as two faults with one window do. Parts draw independently of each other.
    Interventions that follow each other in time are several faults, each with its window.
    """

    kind: Literal["sequence"] = "sequence"
    parts: "tuple[AnyIntervention, ...]" = Field(min_length=1)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the last part's value; the memory holds one entry a part."""
        value, carried = reading, ()
        for index, part in enumerate(self.parts):
            here = replace(at, draws=at.draws.beside(f"/{index}"))
            past = part.begin(value, here) if memory is None else memory[index]
            changed, past = part.apply(value, past, here)
            value = changed if at.elapsed >= 0 else value
            carried = (*carried, past)
        return value, carried

    def is_random(self) -> bool:
        """Return whether any part draws errors."""
        return any(part.is_random() for part in self.parts)

    def words(self) -> str:
        """Return the parts' words in turn."""
        return ", then ".join(part.words() for part in self.parts)

    def resolved(self, channel: Channel) -> Self:
        """Resolve every part."""
        parts = tuple(part.resolved(channel) for part in self.parts)
        return self.model_copy(update={"parts": parts})

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Return what the first part that does not fit says."""
        return next(filter(None, (part.misfit(shape) for part in self.parts)), None)


Listed: TypeAlias = (
    Scale
    | UniformScale
    | Offset
    | Rotate
    | Quantise
    | Erase
    | Noise
    | Drift
    | Bias
    | Delay
    | Hold
    | Freeze
    | Dropout
    | Shuffle
    | Recorded
    | Sequence
)
AnyIntervention: TypeAlias = Annotated[Listed, Discriminator("kind")]
"""Any intervention; its `kind` says in JSON which."""

Sequence.model_rebuild()

INTERVENTIONS: dict[str, type[Intervention]] = {
    intervention.model_fields["kind"].default: intervention for intervention in get_args(Listed)
}
"""By kind."""

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
        """Return the random numbers of the fault, which all of its consumers share."""
        if self.loading == 1.0:
            return Draws(scenes, seed, self.drawn_from)
        own = f"{self.drawn_from}/own/{self.channel}:{self.intervention.kind}"
        return Draws(scenes, seed, self.drawn_from, self.loading, Draws(scenes, seed, own))

    def aimed_at(self, *names: str) -> Self:
        """Return the same fault at other consumers: `module.place`, modules, or `*`."""
        return self.model_copy(update={"consumers": names or (ALL,)})

    def resolved(
        self, interface: Interface, present: Collection[str] | None = None
    ) -> tuple["Fault", ...]:
        """Return the fault with every consumer spelled out and defaults filled in.

        Consumers that are not `present` in a variant are left out; the result is empty when none is
        left, that is, when the fault cannot reach the variant. Raises `UserError` where the fault
        cannot act on `interface`.
        """
        return _resolved((self,), interface, present)

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
        at = "every consumer" if ALL in self.consumers else ", ".join(self.consumers)
        words = f"{self.channel} {self.intervention.words()} at {at}"
        words += f" from step {self.onset_step}" if self.onset_step else ""
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

    def resolved(
        self, interface: Interface, present: Collection[str] | None = None
    ) -> tuple[Fault, ...]:
        """Return the faults as `Fault.resolved` does, without those that reach no consumer."""
        shared = (f.model_copy(update={"cause": f.cause or self.name}) for f in self.faults)
        return _resolved(tuple(shared), interface, present)

    def describe(self) -> str:
        """Return the faults in a few words."""
        return f"{self.name}: " + "; ".join(fault.describe() for fault in self.faults)


AnyFault: TypeAlias = Annotated[Fault | Coupled, Field(discriminator="kind")]
"""A fault as it is declared; its `kind` says in JSON which."""


def resolve(
    faults: Iterable[AnyFault], interface: Interface, present: Collection[str] | None = None
) -> tuple[Fault, ...]:
    """Return faults as `Taps` takes them: `Fault.resolved` of each, in turn.

    Raises `UserError` for a fault that cannot act on `interface`, or reaches no consumer that is
    `present`.
    """
    resolved: list[Fault] = []
    for fault in faults:
        parts = fault.resolved(interface, present)
        if not parts:
            names = {c for part in fault.resolved(interface) for c in part.consumers}
            raise UserError(
                f"fault '{fault.describe()}' reaches no consumer in this variant, "
                f"which has no {listed(names)}; leave the fault out or name other consumers"
            )
        resolved += parts
    return tuple(resolved)


def _resolved(
    faults: tuple[Fault, ...], interface: Interface, present: Collection[str] | None
) -> tuple[Fault, ...]:
    """Resolve faults that act together: a consumer needs to read only one of their channels."""
    channels = [interface.channel(fault.channel) for fault in faults]
    readers = {consumer for channel in channels for consumer in channel.consumers}
    known = readers | {module_of(reader) for reader in readers}
    resolved: list[Fault] = []
    for fault, channel in zip(faults, channels, strict=True):
        for name in fault.consumers:
            if name == ALL or name in known:
                continue
            what = " and ".join(f"channel '{other.channel}'" for other in faults)
            everyone = {c for other in interface.channels for c in other.consumers}
            if name in everyone or name in modules(interface):
                problem = f"'{name}' does not read it; its readers: {listed(known)}"
            else:
                problem = unknown("consumer", name, known)
            raise UserError(f"{what}: {problem}")
        wrong = fault.intervention.misfit(interface.source(channel.sources[0]).shape)
        if wrong:
            raise UserError(
                f"channel '{fault.channel}': {fault.intervention.kind} does not fit: {wrong}"
            )
        reached = tuple(
            consumer
            for consumer in channel.consumers
            if not {ALL, consumer, module_of(consumer)}.isdisjoint(fault.consumers)
            and (present is None or consumer in present)
        )
        update = {
            "consumers": reached,
            "intervention": fault.intervention.resolved(channel),
            "cause": fault.drawn_from,
        }
        if reached:
            resolved.append(fault.model_copy(update=update))
    return tuple(resolved)
