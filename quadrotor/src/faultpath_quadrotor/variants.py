"""The ways to wire the quadrotor: which predictor plans, and what feeds its wind input.

A variant is named by its wind input (`zero-wind`, `gru`, `dob`, `true-wind`), by its predictor
(`wm-a+dcc`), or by both (`wm-a-wind/gru`). The parts that it names are loaded with the seed of the
treatment as their training seed; a variant that names no predictor has that of the options. The
user's own parts come beside the shipped ones, under the names that the user gave them; a planner
makes a variant with the predictor of the options.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import torch

from faultpath.loop import Module
from faultpath_quadrotor.choices import (
    ESTIMATORS,
    INERTIAL,
    PREDICTORS,
    RECONSTRUCTIONS,
    ClearanceName,
)
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.estimators import Estimator, ExactEstimator
from faultpath_quadrotor.models import estimator, predictor, reconstruction
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import Planner
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.module import HistoryEncoder, PredictorModule
from faultpath_quadrotor.reconstruction import Reconstruction
from faultpath_quadrotor.reconstruction.base import WindModule
from faultpath_quadrotor.user_parts import UserPart

ZERO_WIND = "zero-wind"
TRUE_WIND = "true-wind"

_FIXED = {
    ZERO_WIND: ("zero_wind", "taken for zero"),
    TRUE_WIND: ("true_wind", "that of the simulator, as a reference"),
}
"""Source of the wind channel and its description, where no reconstruction supplies it."""


@dataclass(frozen=True)
class VariantParts:
    """Names of the parts that a variant flies with, and how each is loaded."""

    name: str
    predictor: str
    predictor_seed: int | None
    """`None`: the seed of the treatment."""
    wind: str | None
    """`None` for a predictor without a wind input."""
    planner: str | None = None
    """One of the user's; `None` for that of the options."""
    estimator: str | None = None
    """A filter that ships or one of the user's; `None` for the exact one."""
    user_parts: Mapping[str, UserPart] = field(default_factory=dict[str, UserPart])

    @property
    def uses(self) -> set[str | None]:
        """Names of the parts that it flies with."""
        return {self.predictor, self.wind, self.planner, self.estimator}

    def load_predictor(self, seed: int | None, device: torch.device = CPU) -> Predictor:
        """Return the predictor for a treatment of this seed; blank for `None`."""
        fixed = self.predictor_seed is not None and seed is not None
        trained = self.predictor_seed if fixed else seed
        own = self.user_parts.get(self.predictor)
        return own.load(trained, device) if own else predictor(self.predictor, trained, device)

    def load_reconstruction(
        self, seed: int | None, device: torch.device = CPU
    ) -> Reconstruction | None:
        """Return the wind reconstruction for a treatment of this seed, if the variant has one."""
        if self.wind is None or self.wind in _FIXED:
            return None
        own = self.user_parts.get(self.wind)
        return own.load(seed, device) if own else reconstruction(self.wind, seed, device)

    def load_planner(self, seed: int | None, options: QuadrotorOptions) -> Planner:
        """Return the planner for a treatment of this seed."""
        if self.planner is None:
            return options.build_planner()
        return self.user_parts[self.planner].load(seed, options.place)

    def load_estimator(self, seed: int | None, options: QuadrotorOptions) -> Estimator | None:
        """Return the estimator for a treatment of this seed; `None` for the exact one."""
        if self.estimator is None:
            return None
        if self.estimator in ESTIMATORS:
            return estimator(self.estimator, options.fixes, options.place)
        return self.user_parts[self.estimator].load(seed, options.place)

    def bindings(self, options: QuadrotorOptions) -> Mapping[str, str]:
        """Return the sources of clearance and wind."""
        estimated = options.clearance is not ClearanceName.TRUE
        wind, _ = _FIXED.get(self.wind or ZERO_WIND, ("reconstructed_wind", ""))
        return {
            "clearance": "estimated_clearance" if estimated else "true_clearance",
            "wind": wind,
        }

    @property
    def description(self) -> str:
        """The variant in words, as audits show it."""
        own = {name: part.description for name, part in self.user_parts.items()}
        fixed = {name: words for name, (_, words) in _FIXED.items()}
        known = {**PREDICTORS, **RECONSTRUCTIONS, **ESTIMATORS, **own, **fixed}
        words = f"Prediction: {known[self.predictor]}"
        if self.wind is not None:
            words = f"{words}. Wind: {known[self.wind]}"
        if self.planner is not None:
            words = f"{words}. Planning: {known[self.planner]}"
        if self.estimator is not None:
            words = f"{words}. Estimating: {known[self.estimator]}"
        return f"{words}."


def variants(
    options: QuadrotorOptions, user_parts: Mapping[str, UserPart] | None = None
) -> Iterator[VariantParts]:
    """Yield every variant of the quadrotor under these options, with the user's own parts.

    First come the few that together fly with the predictor of the options and every user part: a
    check of the system that names no variants takes the first ones, and has to meet every part.
    """
    every = list(_every(options, user_parts or {}))
    first: dict[str, VariantParts] = {}
    named = {options.predictor, *(user_parts or {})}
    for part in (options.predictor, *(user_parts or {})):
        if not any(part in variant.uses for variant in first.values()):
            using = (variant for variant in every if part in variant.uses)
            best = max(using, key=lambda variant: len(variant.uses & named), default=None)
            first |= {} if best is None else {best.name: best}
    yield from first.values()
    yield from (variant for variant in every if variant.name not in first)


def _every(options: QuadrotorOptions, user_parts: Mapping[str, UserPart]) -> Iterator[VariantParts]:
    chosen, seed = options.predictor, options.predictor_seed
    shipped = [name for name in RECONSTRUCTIONS if options.filtered or name != INERTIAL]
    winds = (ZERO_WIND, *shipped, *_of(Reconstruction, user_parts), TRUE_WIND)
    base = VariantParts(
        chosen,
        chosen,
        seed,
        None,
        planner=options.planner if options.planner in user_parts else None,
        estimator=None if options.estimator == "exact" else options.estimator,
        user_parts=user_parts,
    )
    if _has_wind(chosen, user_parts):
        for wind in winds:
            yield replace(base, name=wind, wind=wind)
    named = [
        replace(base, name=name, predictor=name, predictor_seed=None)
        for name in (*PREDICTORS, *_of(Predictor, user_parts))
    ]
    named += [replace(base, name=name, planner=name) for name in _of(Planner, user_parts)]
    estimators = (*(ESTIMATORS if options.filtered else ()), *_of(Estimator, user_parts))
    named += [replace(base, name=name, estimator=name) for name in estimators]
    for variant in named:
        windy = _has_wind(variant.predictor, user_parts)
        yield replace(variant, wind=ZERO_WIND if windy else None)
        for wind in winds if windy else ():
            yield replace(variant, name=f"{variant.name}/{wind}", wind=wind)


def _of(kind: type, user_parts: Mapping[str, UserPart]) -> Iterator[str]:
    return (name for name, part in user_parts.items() if isinstance(part.blank, kind))


def _has_wind(name: str, user_parts: Mapping[str, UserPart]) -> bool:
    reads = user_parts[name].reads if name in user_parts else predictor(name, None).reads
    return "wind_map" in reads


def modelled(
    predictor: Predictor,
    reconstruction: Reconstruction | None,
    device: torch.device,
    estimator: Estimator | None = None,
) -> list[Module]:
    """Return the estimators and the modules of a predictor and a wind reconstruction, if any.

    A flight has them before its planner, a recorded window before what was executed.
    """
    modules: list[Module] = [] if estimator is None else [estimator]
    modules += [
        ExactEstimator(estimator.writes if estimator else ()),
        PredictorModule(predictor, device),
    ]
    if reconstruction is not None:
        modules.append(WindModule(reconstruction, device))
    if "history" in predictor.reads:
        modules.append(HistoryEncoder(predictor, device))
    return modules
