"""The ways to wire the quadrotor: which predictor plans, and what feeds its wind input.

A variant is named by its wind input (`zero-wind`, `gru`, `dob`, `true-wind`), by its predictor
(`wm-a+dcc`), or by both (`wm-a-wind/gru`). What a variant names takes the seed of its arm as the
seed of its training; a predictor that it does not name is that of the options.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import torch

from faultpath.interface import Interface
from faultpath.quadrotor.choices import ClearanceName
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.models import PREDICTORS, RECONSTRUCTIONS, predictor, reconstruction
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.trials import Variant

ZERO_WIND = "zero-wind"
TRUE_WIND = "true-wind"

_WINDS = {
    ZERO_WIND: ("zero_wind", "the wind input is held at zero"),
    **{
        name: ("reconstructed_wind", f"{kind.description} supplies the wind")
        for name, kind in RECONSTRUCTIONS.items()
    },
    TRUE_WIND: ("true_wind", "the simulator's wind at this moment is supplied: a reference"),
}
"""Source of the wind channel and its description, by name of the wind input."""


@dataclass(frozen=True)
class Wiring:
    """What a variant puts where."""

    name: str
    predictor: str
    predictor_seed: int | None
    """`None`: the seed of the arm."""
    wind: str | None
    """`None` for a predictor without a wind input."""

    def load_predictor(self, seed: int, device: torch.device = CPU) -> Predictor:
        """Return the predictor for an arm of this seed."""
        trained = seed if self.predictor_seed is None else self.predictor_seed
        return predictor(self.predictor, trained, device)

    def load_reconstruction(self, seed: int, device: torch.device = CPU) -> Reconstruction | None:
        """Return the wind reconstruction for an arm of this seed, if the variant has one."""
        if self.wind is None or self.wind not in RECONSTRUCTIONS:
            return None
        return reconstruction(self.wind, seed, device)


def wirings(options: QuadrotorOptions) -> Iterator[Wiring]:
    """Yield every way to wire the quadrotor under these options."""
    if _has_wind(options.predictor):
        for wind in _WINDS:
            yield Wiring(wind, options.predictor, options.predictor_seed, wind)
    for name in PREDICTORS:
        if not _has_wind(name):
            yield Wiring(name, name, None, None)
            continue
        yield Wiring(name, name, None, ZERO_WIND)
        for wind in _WINDS:
            yield Wiring(f"{name}/{wind}", name, None, wind)


def variant(wiring: Wiring, interface: Interface, options: QuadrotorOptions) -> Variant:
    """Describe a wiring to the audit: what it reads, from where, and with which privileges."""
    consumers = {"planner.goal_cost", "planner.risk_cost", "vehicle.actuators"}
    consumers |= {f"predictor.{place}" for place in predictor(wiring.predictor, None).reads}
    bindings = {"clearance": "estimated_clearance", "wind": "zero_wind"}
    if options.clearance is ClearanceName.TRUE:
        bindings["clearance"] = "true_clearance"
    else:
        consumers |= {"perception.encoder", "perception.capture_frame"}
    words = PREDICTORS[wiring.predictor].description
    if wiring.wind is not None:
        bindings["wind"], described = _WINDS[wiring.wind]
        words = f"{words}; {described}"
    if wiring.wind is not None and wiring.wind in RECONSTRUCTIONS:
        consumers |= reconstruction(wiring.wind, None).consumers()
    return Variant(
        name=wiring.name,
        description=f"{words[0].upper()}{words[1:]}.",
        consumers=frozenset(consumers),
        bindings=bindings,
        privileged=_privileged(interface, consumers, bindings),
    )


def _has_wind(name: str) -> bool:
    return "wind_map" in predictor(name, None).reads


def _privileged(
    interface: Interface, consumers: set[str], bindings: dict[str, str]
) -> frozenset[str]:
    """Return the privileged sources that the variant reads: it says so by being named so."""
    bound = {
        bindings.get(channel.name, channel.sources[0])
        for channel in interface.channels
        if consumers & set(channel.consumers)
    }
    return frozenset(name for name in bound if interface.source(name).provenance == "privileged")
