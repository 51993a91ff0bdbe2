"""All kinds of intervention, by their names in fault text and in JSON.

Installed packages add kinds by entry points in the group `faultpath.faults`. Such a package is
imported only when a fault of its kind is read.
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


class Sequence(Intervention):
    """Apply interventions in turn: each acts on the value of the one before.

    All parts begin at the onset, so a delay after a scale still delivers unscaled readings at
    first, as two faults with one window would. Parts draw independently of each other.
    Interventions that follow each other in time are several faults, each with its own window.
    """

    kind: Literal["sequence"] = "sequence"
    parts: "tuple[AnyIntervention, ...]" = Field(min_length=1)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the last part's value. The memory holds one entry a part."""
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
        """Return the reason of the first part that does not fit."""
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
"""Every kind of faultpath's own. Text, JSON and API find a kind here; `faultpath.faults` names it
too."""


@cache
def installed_kinds() -> Mapping[str, str]:
    """Return the classes of installed packages, `module:Class`, by kind."""
    return {point.name: point.value for point in entry_points(group="faultpath.faults")}


def intervention_of(kind: str) -> type[Intervention]:
    """Return the class of a kind, ours or an installed package's; `KeyError` for an unknown kind.

    Raises `SystemMistake` where a package's class is not of the kind it is declared as.
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


def _read(value: Any, validate_listed: ValidatorFunctionWrapHandler) -> Intervention:
    kind = getattr(value, "kind", None)
    if isinstance(value, Mapping):
        kind = cast("Mapping[str, Any]", value).get("kind")
    if not isinstance(kind, str) or kind in INTERVENTIONS or kind not in installed_kinds():
        return validate_listed(value)
    return intervention_of(kind).model_validate(value)


AnyIntervention: TypeAlias = Annotated[
    SerializeAsAny[Annotated[Listed, Discriminator("kind")]], WrapValidator(_read)
]
"""Any intervention; in JSON its `kind` tells which."""

Sequence.model_rebuild()

INTERVENTIONS: dict[str, type[Intervention]] = {
    intervention.model_fields["kind"].default: intervention for intervention in get_args(Listed)
}
"""Those of `Listed`, by kind."""
