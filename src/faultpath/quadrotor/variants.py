"""The ways to wire the quadrotor: which predictor plans, and what feeds its wind input.

A variant is named by its wind input (`zero-wind`, `gru`, `dob`, `true-wind`), by its predictor
(`wm-a+dcc`), or by both (`wm-a-wind/gru`). What a variant names takes the seed of its arm as the
seed of its training; a predictor that it does not name is that of the options.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import torch

from faultpath.quadrotor.choices import ClearanceName
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.models import PREDICTORS, RECONSTRUCTIONS, predictor, reconstruction
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.trials import Wiring

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
class Choice:
    """What a variant puts where."""

    name: str
    predictor: str
    predictor_seed: int | None
    """`None`: the seed of the arm."""
    wind: str | None
    """`None` for a predictor without a wind input."""

    def load_predictor(self, seed: int | None, device: torch.device = CPU) -> Predictor:
        """Return the predictor for an arm of this seed; blank for `None`."""
        fixed = self.predictor_seed is not None and seed is not None
        return predictor(self.predictor, self.predictor_seed if fixed else seed, device)

    def load_reconstruction(
        self, seed: int | None, device: torch.device = CPU
    ) -> Reconstruction | None:
        """Return the wind reconstruction for an arm of this seed, if the variant has one."""
        if self.wind is None or self.wind not in RECONSTRUCTIONS:
            return None
        return reconstruction(self.wind, seed, device)

    def wiring(self, options: QuadrotorOptions) -> Wiring:
        """Describe the choice to an audit: in words, and which sources it takes."""
        seen = options.clearance is not ClearanceName.TRUE
        bindings = {
            "clearance": "estimated_clearance" if seen else "true_clearance",
            "wind": "zero_wind",
        }
        words = PREDICTORS[self.predictor].description
        if self.wind is not None:
            bindings["wind"], described = _WINDS[self.wind]
            words = f"{words}; {described}"
        return Wiring(f"{words[0].upper()}{words[1:]}.", bindings)


def choices(options: QuadrotorOptions) -> Iterator[Choice]:
    """Yield every way to wire the quadrotor under these options."""
    if _has_wind(options.predictor):
        for wind in _WINDS:
            yield Choice(wind, options.predictor, options.predictor_seed, wind)
    for name in PREDICTORS:
        if not _has_wind(name):
            yield Choice(name, name, None, None)
            continue
        yield Choice(name, name, None, ZERO_WIND)
        for wind in _WINDS:
            yield Choice(f"{name}/{wind}", name, None, wind)


def _has_wind(name: str) -> bool:
    return "wind_map" in predictor(name, None).reads
