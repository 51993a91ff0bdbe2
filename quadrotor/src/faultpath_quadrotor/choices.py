"""Options that a user chooses. Nothing here needs torch, so that listing them is quick.

A new option is one field of `QuadrotorChoices`: flags, help and messages follow from it.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated

from pydantic import Field

from faultpath.faults import Delay, Fault, Noise, Rotate, Scale, Sequence
from faultpath.plugin.system import Frozen, UserError
from faultpath.system import Offered


class Wind(StrEnum):
    """Wind levels (paper, Section IV-B)."""

    L0 = "L0"
    L1 = "L1"
    L2 = "L2"
    L3 = "L3"


class Environment(StrEnum):
    """Whether the scene's obstacles are there or only its outer boundaries."""

    OBSTACLES = "obstacles"
    FREE_SPACE = "free-space"


class ClearanceName(StrEnum):
    """Source of the clearance channel."""

    DEPTH = "depth"
    TRUE = "true"


class Fixes(StrEnum):
    """Where position fixes come from; see `estimators.sensors`."""

    OPTICAL = "optical"
    SATELLITE = "satellite"


class SamplerName(StrEnum):
    """Samplers of candidates; see `planners.sampler`."""

    AUTOREGRESSIVE = "autoregressive"
    MODE_PRESERVING = "mode-preserving"


class DeviceName(StrEnum):
    """Where worlds and planners are computed."""

    CPU = "cpu"
    CUDA = "cuda"


PREDICTORS: Mapping[str, str] = {
    "dki": "physics without drag",
    "dki-drag": "physics with nominal drag",
    "true-parameter": "the simulator's physics and parameters",
    "wm-a": "physics with a learned correction",
    "wm-a+dcc": "physics with a learned correction, trained with errors of mass and thrust",
    "wm-u": "a learned model without physics",
    "wm-u+dcc": "a learned model without physics, trained with errors of mass and thrust",
    "wm-a-wind": "physics with a learned correction and a wind input",
    "wm-a-nowind": "physics with a learned correction, trained in wind that it is not told",
}
"""The shipped predictors, in words; `models` builds them."""

INERTIAL = "dob-inertial"
"""The one that reads a raw sensor: a variant only with a shipped filter, which reads them too."""
_GRU = "a network that reads recent motion"
RECONSTRUCTIONS: Mapping[str, str] = {
    "dob": "the acceleration that mass, thrust and drag do not explain",
    INERTIAL: "the acceleration that mass, thrust and drag do not explain, by the accelerometer",
    "gru": f"{_GRU}, mass and thrust scale",
    "gru+dcc": f"{_GRU}, mass and thrust scale, and was trained with errors of both",
    "gru+state": f"{_GRU}, mass and thrust scale, and was trained with errors of motion",
    "gru-withheld": f"{_GRU}, and neither mass nor thrust scale",
    "gru-trajectory": f"{_GRU} alone, trained on flights of the planner",
}
"""The shipped wind reconstructions, in words; `models` builds them."""


ESTIMATORS: Mapping[str, str] = {
    "eskf": "a Kalman filter that estimates the biases of its inertial sensors",
    "eskf-no-bias": "a Kalman filter that takes its inertial sensors for unbiased",
    "eskf-cautious": "a Kalman filter that takes fixes for three times as noisy",
}
"""The shipped estimators that read sensors, in words; `models` builds them."""
PLANNERS = ("mppi", "cem")
"""The shipped planners; `options` builds them."""


class QuadrotorChoices(Frozen):
    """One configuration of the quadrotor, as far as a user chooses it."""

    wind: Annotated[Wind, "Wind level."] = Wind.L0
    environment: Annotated[Environment, "What is flown through."] = Environment.OBSTACLES
    clearance: Annotated[
        ClearanceName,
        "From the depth model, or the geometry's own: a reference, and the default in free space.",
    ] = ClearanceName.DEPTH
    predictor: Annotated[
        str,
        "Predictor of the variants that name none, or your own as file.py:factory.",
        Offered(*PREDICTORS, factories=True),
    ] = "wm-a-wind"
    predictor_seed: Annotated[
        int,
        "Which training of it; variants that name a predictor take the seed of their treatment.",
        Offered(0, 1, 2),
    ] = 0
    estimator: Annotated[
        str,
        "What turns sensors into the state, or your own as file.py:factory.",
        Offered("exact", *ESTIMATORS, factories=True),
    ] = "exact"
    sensor_noise: Annotated[
        float,
        Field(ge=0),
        "How large the errors of the raw sensors are; 1 is usual, and the default of our filters.",
    ] = 0.0
    fixes: Annotated[Fixes, "Where a filter's position fixes come from."] = Fixes.OPTICAL
    planner: Annotated[
        str, "What plans, or your own as file.py:factory.", Offered(*PLANNERS, factories=True)
    ] = "mppi"
    sampler: Annotated[SamplerName, "How candidates are drawn."] = SamplerName.AUTOREGRESSIVE
    candidates: Annotated[
        int,
        "Candidates a replan, in all iterations together.",
        Offered(512, 1024, 2048),  # paper, Sections IV-A and VII-B
    ] = 512
    plant: Annotated[
        str,
        "What integrates the vehicle's motion, or your own as file.py:factory.",
        Offered("torch", factories=True),
    ] = "torch"
    device: Annotated[DeviceName, "What computes worlds and planners."] = DeviceName.CPU
    bring: Annotated[
        str,
        "Parts of your own, file.py:factory, comma-separated; those that baseline and repair name "
        "are added.",
    ] = ""

    @property
    def parts(self) -> tuple[str, ...]:
        """The user's own parts that these options name, without repetition.

        A reconstruction may be named with the predictor that it feeds, `wm-a-wind/my.py:create`.
        """
        slots = (self.predictor, self.estimator, self.planner, self.plant)
        named = [*self.bring.split(","), *(name for name in slots if ":" in name)]
        parts = (name.strip().partition("/") for name in named if name.strip())
        return tuple(
            dict.fromkeys(
                rest if head in PREDICTORS else head + by + rest for head, by, rest in parts
            )
        )


STATE_NOISE_STD = {"position": 0.02, "velocity": 0.05, "attitude": 0.01, "body_rate": 0.05}
"""Standard deviations of `noisy_state=1`: m, m/s, entries of the rotation matrix, rad/s. About the
errors of visual-inertial odometry indoors (derived; the paper states none)."""
STATE_DELAY_STEPS = 1
"""50 ms, one control interval (derived)."""


def calibration(error: float) -> tuple[Fault, ...]:
    """Return the fault m~ = m (1 + e), T~ = T (1 - e) (paper, Section IV-B).

    The implied thrust acceleration scales by (1 - e)/(1 + e). Raises `UserError` for an error that
    leaves no positive mass or thrust scale.
    """
    if not -1 < error < 1:
        raise UserError(
            f"calibration={error:g} leaves no positive mass or thrust scale: "
            "choose an error between -1 and 1."
        )
    return (
        Fault(channel="mass", intervention=Scale(factor=1 + error)),
        Fault(channel="thrust_scale", intervention=Scale(factor=1 - error)),
    )


def mount(angle: float) -> tuple[Fault, ...]:
    """Return an inertial unit that is mounted askew: turned by `angle` rad about the body's y axis.

    It acts on gyroscope and accelerometer alike.
    """
    turn = Rotate(by=(0.0, angle, 0.0))
    channels = ("gyroscope", "accelerometer")
    return tuple(Fault(channel=channel, intervention=turn) for channel in channels)


def noisy_state(size: float) -> tuple[Fault, ...]:
    """Return Gaussian noise of `size` times `STATE_NOISE_STD`, and a delay, on the whole state.

    Channels draw independently; all readers of a channel get the same noise, since it is the
    estimator's (paper, Section IV-A: the supplementary evaluation). Raises `UserError` for a
    negative size.
    """
    if size < 0:
        raise UserError(f"noisy_state={size:g}: choose a size of 0 or more; 1 is the standard.")
    late = Delay(steps=STATE_DELAY_STEPS)
    return tuple(
        Fault(
            channel=channel,
            cause=f"noisy_state/{channel}",
            intervention=Sequence(parts=(Noise(std=size * std), late)),
        )
        for channel, std in STATE_NOISE_STD.items()
    )
