"""The planning problem that every planner is given: WM-A with wind, 512 candidates, 20 steps.

States, calibrations and commands are drawn about what flights have; how long a rollout takes does
not depend on them.
"""

import numpy as np
import torch
from torch import Tensor

from faultpath.quadrotor import native, so3
from faultpath.quadrotor.models import Shelf, predictor
from faultpath.quadrotor.planners import AutoregressiveSampler, SamplerSettings
from faultpath.quadrotor.platforms import FIRST
from faultpath.quadrotor.predictors import AnchoredPredictor, Calibration, PredictorInputs
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2
from faultpath.streams import generator

CANDIDATES = 512
HORIZON = 20
MODEL = "wm-a-wind"
CHECKED = 32
"""Candidates whose positions are compared between planners."""
GOAL_M = (6.0, 0.5, 1.2)


def model() -> AnchoredPredictor:
    """Return the predictor of the first platform, seed 0, whose drag is the same along all axes."""
    found = predictor(MODEL, 0, shelf=Shelf(FIRST))
    assert isinstance(found, AnchoredPredictor)
    return found


def inputs(scenes: int = 1) -> PredictorInputs:
    """Return what the taps would deliver for some scenes, batch `[S, 1]`, float32."""
    draws = [generator("benchmark", f"scene/{i}", 0) for i in range(scenes)]

    def column(rows: int, low: float, high: float) -> Tensor:
        values = np.stack([draw.uniform(low, high, rows) for draw in draws], axis=-1)
        return torch.from_numpy(values).float()[..., None]

    def lane(low: float, high: float) -> Tensor:
        return column(1, low, high)[0]

    calibration = Calibration(lane(0.8, 1.2), lane(0.8, 1.2))
    return PredictorInputs(
        state=State(
            position=column(3, 1.0, 2.0),
            velocity=column(3, -2.0, 2.0),
            rotation=so3.exp(column(3, -0.4, 0.4)),
            rate=column(3, -1.0, 1.0),
        ),
        trim=calibration,
        dynamics=calibration,
        wind_map_mass_kg=calibration.mass_kg,
        wind_mps=column(3, -5.0, 5.0),
        thrust_mass_kg=calibration.mass_kg,
        code=column(32, -0.8, 0.8),
    )


def commands(scenes: int = 1, candidates: int = CANDIDATES, horizon: int = HORIZON) -> Tensor:
    """Return candidates about hover, `[H, 4, S, K]`."""
    sampler = AutoregressiveSampler(SamplerSettings(candidates=candidates, horizon=horizon))
    hover = inputs(scenes).trim.hover_thrust(GRAVITY_MPS2)[:, 0]
    plan = torch.zeros(horizon, 4, scenes)
    plan[:, 0] = hover
    with native.using(native.PORTABLE):  # the same numbers for every side
        noise = sampler.noise([f"scene/{i}" for i in range(scenes)], 0, 0)
        return sampler.candidates(plan, hover, noise)
