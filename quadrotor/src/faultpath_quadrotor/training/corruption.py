"""Noise on calibration (DCC) and motion for training, by the taps and faults of audits."""

from collections.abc import Collection, Iterable, Mapping

from torch import Tensor

from faultpath.faults import ALL, Bias, Fault, UniformScale, resolve
from faultpath.loop import Reading
from faultpath.plugin.training import window_taps
from faultpath_quadrotor.interface import quadrotor_interface
from faultpath_quadrotor.training.windows import DeliveredInputs
from faultpath_quadrotor.vehicle import CONTROL_DT_S

CALIBRATION = ("mass", "thrust_scale")
DCC_HALF_RANGE = 0.2  # paper, Section IV-B


def dcc(readers: Iterable[str], half_range: float = DCC_HALF_RANGE) -> tuple[Fault, ...]:
    """Return independent uniform noise on mass and thrust scale at `readers`.

    Each channel has its own cause: the two factors are independent, and all readers of a
    channel get the same one (paper, Section IV-B and appendix). Readers that read neither are
    left alone, and one may read one channel only.
    """
    interface = quadrotor_interface()
    noise = UniformScale(half_range=half_range)
    known = {name for channel in CALIBRATION for name in interface.channel(channel).readers}
    aim = tuple(sorted(known & set(readers))) or (ALL,)
    return tuple(
        Fault(channel=channel, intervention=noise, cause=f"dcc/{channel}", readers=aim)
        for channel in CALIBRATION
    )


STATE_STD = {"position": 0.012, "velocity": 0.026, "attitude": 0.005, "body_rate": 0.002}
"""Standard deviations of the errors of motion, m, m/s, entries of the rotation matrix and rad/s:
those that the error-state filter's own covariance gives after some seconds (derived)."""


def state_noise(reader: str) -> tuple[Fault, ...]:
    """Return independent Gaussian errors of the whole state at a reader, one draw a window.

    The law is that of `dcc`: each channel has its own cause, and an error stays for the window.
    """
    return tuple(
        Fault(
            channel=channel, intervention=Bias(std=std), cause=f"state/{channel}", readers=(reader,)
        )
        for channel, std in STATE_STD.items()
    )


def corrupted(
    faults: Iterable[Fault],
    readers: Collection[str],
    windows: tuple[str, ...],
    seed: int,
    readings: Mapping[str, Tensor],
) -> DeliveredInputs:
    """Return each window's readings as each reader gets them, by (channel, reader), `[W]`.

    Windows are the scenes of the taps: each has one draw for the whole fit, held throughout it,
    keyed by its id and the model's seed (paper, Section IV-B). The draws come from streams of the
    faults' own, so initial weights and the order of minibatches are untouched.

    Raises `UserError` for a name that is unknown and for faults that reach none of the readers, and
    `NotDelivered` for a fault that missed a reader that it names.
    """
    interface = quadrotor_interface()
    resolved = resolve(faults, interface, readers)
    taps = window_taps(interface, resolved, windows, CONTROL_DT_S, seed, 0, readers)
    delivered = {
        (channel, reader): taps.deliver(
            channel, reader, Reading(value, taps.bindings[channel], 0), 0
        )
        for channel, value in readings.items()
        for reader in interface.channel(channel).readers
        if reader in readers
    }
    taps.verify(last_step=0)
    return delivered
