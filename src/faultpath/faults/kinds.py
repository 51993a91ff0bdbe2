"""Every kind of intervention, by its name in fault text and in JSON.

Installed packages add kinds of their own by entry points in the group `faultpath.faults`. Nothing
of such a package is imported before a fault of its kind is met.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from typing import Annotated, Any, Literal, Self, TypeAlias, cast, get_args

from pydantic import (
    Discriminator,
    Field,
    SerializeAsAny,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from faultpath.core.arrays import Array
from faultpath.core.errors import SystemMistake
from faultpath.faults.base import Intervention, Memory, Moment
from faultpath.faults.drawn import Bias, Drift, Dropout, Noise, Shuffle, UniformScale
from faultpath.faults.recorded import Recorded
from faultpath.faults.values import Delay, Erase, Freeze, Hold, Offset, Quantise, Rotate, Scale
from faultpath.interface import Channel

__all__ = [
    "Bias",
    "Delay",
    "Drift",
    "Dropout",
    "Erase",
    "Freeze",
    "Hold",
    "Noise",
    "Offset",
    "Quantise",
    "Recorded",
    "Rotate",
    "Scale",
    "Sequence",
    "Shuffle",
    "UniformScale",
]
"""Every kind, for `faultpath.faults`."""


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


@cache
def installed_kinds() -> Mapping[str, str]:
    """Return the classes that installed packages declare, `module:Class`, by their kind."""
    return {point.name: point.value for point in entry_points(group="faultpath.faults")}


def intervention_of(kind: str) -> type[Intervention]:
    """Return the class of a kind, ours or an installed package's; `KeyError` where nobody has it.

    Raises `SystemMistake` where the package's class is none of that kind.
    """
    if kind in INTERVENTIONS:
        return INTERVENTIONS[kind]
    named = installed_kinds()[kind]
    module, _, name = named.partition(":")
    try:
        declared: Any = getattr(import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise SystemMistake(
            f"the kind of fault '{kind}' is declared as {named}, which cannot be imported "
            f"({error}): install that package again, or correct its entry point"
        ) from error
    if isinstance(declared, type) and issubclass(declared, Intervention):
        intervention: type[Intervention] = declared
        if intervention.model_fields["kind"].default == kind:
            return intervention
    raise SystemMistake(
        f"the kind of fault '{kind}' is declared as {named}, which is no Intervention of it: "
        f'derive it from faultpath.faults.Intervention, with `kind: Literal["{kind}"] = "{kind}"`'
    )


def _read(value: Any, of_ours: ValidatorFunctionWrapHandler) -> Intervention:
    kind = getattr(value, "kind", None)
    if isinstance(value, Mapping):
        kind = cast("Mapping[str, Any]", value).get("kind")
    if not isinstance(kind, str) or kind in INTERVENTIONS or kind not in installed_kinds():
        return of_ours(value)
    return intervention_of(kind).model_validate(value)


AnyIntervention: TypeAlias = Annotated[
    SerializeAsAny[Annotated[Listed, Discriminator("kind")]], WrapValidator(_read)
]
"""Any intervention; its `kind` says in JSON which."""

Sequence.model_rebuild()

INTERVENTIONS: dict[str, type[Intervention]] = {
    intervention.model_fields["kind"].default: intervention for intervention in get_args(Listed)
}
"""Ours, by kind."""
