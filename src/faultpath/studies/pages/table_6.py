"""Table VI: how reconstruction bias and calibration error compensate, and the negative offset."""

from faultpath.evidence import Measurement
from faultpath.studies.cells import Cell, calibration
from faultpath.studies.pages.table_1 import recording
from faultpath.studies.pages.table_4 import ERROR, METHODS, PATHS, WINDY

INTERFACES: dict[str, tuple[str, ...]] = {
    "correct": PATHS["correct"],
    "reconstruction-only": PATHS["reconstruction-only"],
    "predictor-only": (calibration(ERROR, "predictor"),),
    "shared": PATHS["shared"],
}
"""(e_R, e_P) = (0, 0), (+0.1, 0), (0, +0.1), (+0.1, +0.1)."""

NEGATIVE: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(-ERROR, "reconstruction"),),
    "shared": (calibration(-ERROR),),
}
"""(e_R, e_P) = (0, 0), (-0.1, 0), (-0.1, -0.1)."""

WINDOWS = recording(Cell(WINDY, "gru"))
"""Common windows: recorded with the reference reconstruction of seed 0 under correct inputs."""


def seeds(method: str) -> tuple[int, ...]:
    """Return the seeds of a method: the observer learns nothing."""
    return (0,) if method == "dob" else (0, 1, 2)


def acceleration_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the analytic acceleration error of a method."""
    return _measure("acceleration-error", method, interface, seed)


def wind_term_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the error of the wind's part of that acceleration alone."""
    return _measure("wind-term-error", method, interface, seed)


def position_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the 20-step position error of the predictor with a method's wind."""
    return _measure("position-error", method, interface, seed)


def negative(method: str, path: str) -> Cell:
    """Return a method under the negative offset, seed 0."""
    return Cell(WINDY, method, NEGATIVE[path])


def _measure(quantity: str, method: str, interface: str, seed: int) -> Measurement:
    return Measurement.model_validate(
        {
            "recording": WINDOWS,
            "quantity": quantity,
            "subject": method,
            "seed": seed,
            "faults": INTERFACES[interface],
        }
    )


CELLS = tuple(negative(method, path) for method in ("gru", "gru+dcc") for path in NEGATIVE)
MEASUREMENTS = (
    *(
        acceleration_error(method, interface, seed)
        for method in METHODS
        for interface in INTERFACES
        for seed in seeds(method)
    ),
    *(
        wind_term_error("gru", interface, seed)
        for interface in ("reconstruction-only", "shared")
        for seed in seeds("gru")
    ),
    *(
        position_error(method, interface, seed)
        for method in METHODS
        for interface in PATHS
        for seed in seeds(method)
    ),
)
