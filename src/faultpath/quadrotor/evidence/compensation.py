"""The acceleration that nominal dynamics and a wind explain together.

Paper, Section "Calibration-Dependent Compensation": a_0(eta) from thrust, gravity and linear drag,
plus the wind map B_eta. Both are those of the disturbance observer, so what the observer takes out
of an acceleration is put back here.
"""

from torch import Tensor

from faultpath.quadrotor.predictors import Calibration
from faultpath.quadrotor.predictors.drag import LinearDrag
from faultpath.quadrotor.reconstruction import DisturbanceObserver, Sensed
from faultpath.quadrotor.training.replay import inputs_at, remembered
from faultpath.quadrotor.training.windows import HISTORY, Windows


def nominal(windows: Windows, calibration: Calibration) -> Tensor:
    """Return a_0 over the interval that ends at the present, `[3, W]`, m/s^2.

    An observer told this calibration follows the whole history, for the thrust that the motors
    hold; the start of its belief has decayed by a factor of a million.
    """
    observer = DisturbanceObserver()
    delivered = {
        ("mass", "reconstruction.nominal_model"): calibration.mass_kg,
        ("thrust_scale", "reconstruction.nominal_model"): calibration.thrust_scale,
        ("mass", "reconstruction.wind_map"): calibration.mass_kg,
    }
    memory = remembered(observer, windows, delivered, HISTORY - 1)
    return observer.nominal(memory, Sensed.of(inputs_at(observer, windows, delivered, HISTORY)))


def wind_term(windows: Windows, map_mass_kg: Tensor, wind_mps: Tensor) -> Tensor:
    """Return B_eta w at the present, `[3, W]`, m/s^2; the nominal drag coefficients are fixed."""
    return LinearDrag().force(windows.rotation[:, :, HISTORY], wind_mps) / map_mass_kg
