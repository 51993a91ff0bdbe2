"""A system as it was run, as data: what a report shows of it without running its code."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationError, model_validator

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.results import Frozen
from faultpath.core.validation_messages import misfit_of
from faultpath.interface import Interface
from faultpath.system.declared import FloorPlan, shown
from faultpath.system.system import System


class VariantShown(Frozen, allow_inf_nan=False):
    """How one of the two variants of an audit is wired."""

    name: str
    description: str = ""
    readers: tuple[str, ...]
    """The taps that it reads, sorted."""
    bindings: dict[str, str]
    """Channel to source, where it is not the channel's first source."""


class SystemShown(Frozen, allow_inf_nan=False):
    """Description of the system that a run keeps beside its trials; written as `system.json`.

    Raises `ValueError` for variants that do not fit the interface.
    """

    format: Literal[1] = 1
    control_dt_s: Annotated[float, Field(gt=0)]
    """Seconds between two rows of a trace."""
    interface: Interface
    variants: tuple[VariantShown, ...]
    plans: dict[str, FloorPlan]
    """By scene id; scenes without one are drawn without obstacles."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        sources = {channel.name: channel.sources for channel in self.interface.channels}
        known = {name for channel in self.interface.channels for name in channel.readers}
        for variant in self.variants:
            for name in set(variant.readers) - known:
                raise ValueError(f"variant '{variant.name}' reads at {name!r}: no such tap")
            for channel, source in variant.bindings.items():
                if source not in sources.get(channel, ()):
                    raise ValueError(
                        f"variant '{variant.name}' feeds {channel!r} from {source!r}, which the "
                        "interface does not offer"
                    )
        return self


def system_shown(system: System, variants: Iterable[str], scenes: Sequence[str]) -> SystemShown:
    """Return what a report shows of `system` with these variants in these scenes.

    Raises `UserError` where the system gives something that cannot be drawn, such as a floor plan
    with a coordinate that is not finite.
    """
    plans = {scene: plan for scene in scenes if (plan := system.floor_plan(scene)) is not None}
    for plan in plans.values():
        # A user's method returns what it likes.
        if not isinstance(plan, FloorPlan):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise SystemMistake(f"`floor_plan` returned {shown(plan)}: return a FloorPlan or None")
    try:
        return SystemShown.model_validate(
            {
                "control_dt_s": system.control_dt_s,
                "interface": system.interface,
                "variants": [
                    VariantShown(
                        name=variant.name,
                        description=variant.description,
                        readers=tuple(sorted(variant.readers)),
                        bindings=dict(variant.bindings),
                    )
                    for variant in (system.variants[name] for name in variants)
                ],
                # As plain data: what is a `FloorPlan` already would not be looked into.
                "plans": {scene: asdict(plan) for scene, plan in plans.items()},
            }
        )
    except ValidationError as error:
        raise UserError(
            f"the system cannot be shown in a report ({misfit_of(error)}): correct what it returns"
        ) from error
