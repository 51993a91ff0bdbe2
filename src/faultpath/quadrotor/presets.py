"""The coupled calibration fault of the paper."""

from faultpath.errors import UserError
from faultpath.faults import Coupled, Fault, Scale


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
