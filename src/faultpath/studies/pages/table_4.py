"""Table IV: reconstructions of the wind under an isolated and under a shared calibration error."""

from faultpath.studies.cells import SEEDS, Cell, Setting, calibration

WINDY = Setting(wind="L3")
METHODS = ("gru", "gru+dcc", "dob")
ERROR = 0.1

PATHS: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(ERROR, "reconstruction"),),
    "shared": (calibration(ERROR),),
}
"""Faults by interface: (e_R, e_P) = (0, 0), (+0.1, 0), (+0.1, +0.1)."""

CONTRASTS = (("gru+dcc", "gru"), ("dob", "gru"), ("dob", "gru+dcc"))


def cell(method: str, path: str) -> Cell:
    """Return a method on an interface, all seeds.

    The observer is not trained; it meets the planner noise of every seed, to pair with each.
    """
    return Cell(WINDY, method, PATHS[path], seeds=SEEDS)


CELLS = tuple(cell(method, path) for method in METHODS for path in PATHS)
MEASUREMENTS = ()
