"""What the numbers were measured on."""

import os
import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import distributions
from pathlib import Path

import faultpath
from benchmarks.results import Machine
from faultpath.execution.provenance import checkout, processor
from faultpath.quadrotor import native

PACKAGES = ["numpy", "scipy", "torch", "jax", "mujoco", "pytorch-mppi", "rotorpy", "torchrl"]


def describe() -> Machine:
    """Return this machine and the code on it."""
    kernels = native.kernels()
    commit, dirty = checkout(Path(faultpath.__file__).parent)
    installed = {each.name.replace("_", "-"): each.version for each in distributions()}
    return Machine(
        processor=processor(),
        cores=len(os.sched_getaffinity(0)),
        memory_gib=os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30,
        system=platform.platform(aliased=True),
        python=platform.python_version(),
        packages={name: installed[name] for name in PACKAGES if name in installed},
        kernels=native.PORTABLE if kernels is None else kernels.isa,
        compiler=_compiler(),
        commit=commit,
        dirty=dirty,
        date=datetime.now(UTC).date().isoformat(),
    )


def _compiler() -> str:
    command = [os.environ.get("CXX", "c++"), "--version"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.partition("\n")[0]
