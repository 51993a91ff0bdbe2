"""Which code a stored result came from."""

import hashlib
from functools import cache
from importlib.resources import files
from typing import Literal

_DECISIVE = {
    "flights": ("training/closed_loop.py", "training/flight.py", "training/pool.py"),
    "windows": (
        "evidence/compensation.py",
        "evidence/inputs.py",
        "evidence/quantities.py",
        "evidence/recording.py",
        "training/quality_reconstructions.py",
        "training/replay.py",
        "training/windows.py",
    ),
}


@cache
def digest(what: Literal["flights", "windows"]) -> str:
    """Return a hash of the files that decide flights or measurements, beside the system's own.

    Where one of them changes, what is stored is made anew.
    """
    package = files("faultpath.quadrotor")
    found = hashlib.sha256()
    for name in _DECISIVE[what]:
        found.update(name.encode() + package.joinpath(name).read_bytes())
    return found.hexdigest()
