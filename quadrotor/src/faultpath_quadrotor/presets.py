"""Named faults of the quadrotor: the paper's coupled calibration error, and a noisy state."""

from faultpath.core.errors import UserError
from faultpath.faults import Coupled, Delay, Fault, Noise, Scale, Sequence

STATE_NOISE_STD = {"position": 0.02, "velocity": 0.05, "attitude": 0.01, "body_rate": 0.05}
"""Standard deviations of `noisy_state=1`: m, m/s, entries of the rotation matrix, rad/s. About the
errors of visual-inertial odometry indoors (derived; the paper states none)."""
STATE_DELAY_STEPS = 1
"""50 ms, one control interval (derived)."""


def calibration(error: float) -> Coupled:
    """Return the fault m~ = m (1 + e), T~ = T (1 - e) (paper, Section IV-B).

    The implied thrust acceleration scales by (1 - e)/(1 + e). Raises `UserError` for an error that
    leaves no positive mass or thrust scale.
    """
    if not -1 < error < 1:
        raise UserError(
            f"calibration={error:g} leaves no positive mass or thrust scale: "
            "choose an error between -1 and 1."
        )
    return Coupled(
        name="calibration",
        faults=(
            Fault(channel="mass", intervention=Scale(factor=1 + error)),
            Fault(channel="thrust_scale", intervention=Scale(factor=1 - error)),
        ),
    )


def noisy_state(size: float) -> Coupled:
    """Return Gaussian noise of `size` times `STATE_NOISE_STD`, and a delay, on the whole state.

    Channels draw apart; every reader of one gets the same noise, for it is the estimator's (paper,
    Section IV-A: the supplementary evaluation). Raises `UserError` for a negative size.
    """
    if size < 0:
        raise UserError(f"noisy_state={size:g}: choose a size of 0 or more; 1 is the standard.")
    return Coupled(
        name="noisy_state",
        faults=tuple(
            Fault(
                channel=channel,
                cause=f"noisy_state/{channel}",
                intervention=Sequence(
                    parts=(Noise(std=size * std), Delay(steps=STATE_DELAY_STEPS))
                ),
            )
            for channel, std in STATE_NOISE_STD.items()
        ),
    )
