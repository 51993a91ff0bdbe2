"""The base class of systems: the closed loop that an audit runs."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from types import MappingProxyType
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.faults import Fault, FaultPreset, FaultText, parse_fault
from faultpath.interface import Interface
from faultpath.loop import Taps
from faultpath.system.declared import FloorPlan, Library, Variant
from faultpath.system.outcome import Metric, Outcome, Status

BLOCK = 20
"""Default number of scenes in a block."""

Values: TypeAlias = NDArray[np.float64]


class TrialReadings(Protocol):
    """Readings recorded in one trial, `[T, P]`: a row a control step, NaN where nothing was read.

    `KeyError` for a source or reader that the variant does not have.
    """

    def source(self, name: str) -> Values:
        """Return the values of a source."""
        ...

    def delivered(self, channel: str, reader: str) -> Values:
        """Return the values that a tap delivered, faults included."""
        ...


@dataclass(frozen=True)
class ErrorTerm:
    """The error of one module, believed minus true."""

    words: str
    """The module, and the quantity in error: `controller: wrong gain`."""
    of: Callable[[TrialReadings], Values]
    """Computes the error from a trial, a number a step; a pure function."""


@dataclass(frozen=True)
class ErrorSum:
    """Two errors that act together: their sum acts on the system.

    A system that knows of such has one as its attribute `errors`.
    """

    words: str
    """The quantity they both change: `error of the expected acceleration`."""
    unit: str
    terms: tuple[ErrorTerm, ErrorTerm]


class System(ABC):
    """A closed loop with its information interface.

    `run` must give each scene a result that does not depend on the other scenes of the call, so
    random numbers come from `faultpath.core.streams`, keyed by scene.
    """

    name: str
    control_dt_s: float
    block_size: int | None = BLOCK
    """Scenes in one call of `run`: the unit of work, of storage and of resuming. `None`: see
    `scenes_a_block`."""
    parallel: bool = True
    """Whether several worker processes are faster than one; usually not with a GPU."""
    time_limit_s: float | None = None
    """Default time limit of a worker for one block, or for one scene of a block that failed, s;
    `None`: an hour."""
    trained: bool = False
    """Whether variants hold trained models; results are then about these models, as trained."""
    metrics: Mapping[str, Metric] = MappingProxyType({})
    """Measurements of its outcomes beside status and time, by name."""
    ends: Mapping[Status, str] = MappingProxyType({})
    """Words for a status in place of its own name, for example `missed`."""
    errors: ErrorSum | None = None
    """Two errors that act together, for the report; trials do not use them."""
    more_signals: str = ""
    """`module:function` for more signals of a recorded trial, in place of `errors`:
    `function(system, recorded, done)` returns a tuple of signals a scene. It is a name, because
    everything that a system imports counts as code of its trials."""

    @property
    @abstractmethod
    def interface(self) -> Interface:
        """Channels that the modules read, and their sources."""

    @property
    @abstractmethod
    def variants(self) -> Mapping[str, Variant]:
        """The ways to wire the system, by name."""

    @property
    def fault_presets(self) -> Mapping[str, FaultPreset]:
        """Named faults of the command line, such as `calibration`."""
        return {}

    def fault(self, text: str | FaultText) -> tuple[Fault, ...]:
        """Return the faults in a text, one for each channel; see `parse_fault`."""
        return parse_fault(text, self.interface, self.fault_presets, self.control_dt_s)

    @abstractmethod
    def library(self, name: str) -> Library:
        """Return a library of scenes; `UserError` for an unknown name."""

    @abstractmethod
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> Sequence[Outcome]:
        """Run one trial in each scene, in order; every reading goes through `taps`.

        The taps are new and for these scenes. A loop that ends with the last of them tells
        `taps.set_active` at each step which still run. The caller fills in `faulted_steps` and
        `altered_steps` from their delivery log.
        """

    def scenes_a_block(self, scenes: int) -> int:
        """Return the size of the blocks of a library of `scenes` scenes.

        It depends on counts alone, never on measured times, so that a resumed run finds its blocks
        again on any machine.
        """
        del scenes
        return self.block_size or BLOCK

    @property
    def data_files(self) -> Sequence[str | PathLike[str]]:
        """Files and folders on whose contents a result depends, such as weights.

        Relative paths start at the folder of the system's file. Like a change of the source, a
        change of their contents means that earlier trials are not reused.
        """
        return ()

    @property
    def parts(self) -> Sequence[str]:
        """Factories of the user's parts, as `path/to/file.py:factory`, if it takes any.

        Their code counts as the system's own.
        """
        return ()

    def fingerprint(self) -> str:
        """Return anything on which results depend and that is in no file: a device, a service.

        Source, data files and versions of packages are found without it; see `faultpath.run.code`.
        """
        return ""

    @property
    def backend(self) -> str:
        """Name of the library or device that computes trials, if it depends on the machine."""
        return ""

    def floor_plan(self, scene: str) -> FloorPlan | None:
        """Return the shapes that a report draws for a scene, if the system has any."""
        del scene
        return None
