"""The closed loop that an audit runs, as the rest of faultpath sees it."""

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
"""Scenes of a block, unless the system states its own."""

Values: TypeAlias = NDArray[np.float64]


class TrialReadings(Protocol):
    """Readings recorded in one trial, `[T, P]`: a row a control step, not a number where nothing
    was read. `KeyError` for what the variant has not got."""

    def held(self, source: str) -> Values:
        """Return what a source held."""
        ...

    def got(self, channel: str, reader: str) -> Values:
        """Return what a tap delivered, faults included."""
        ...


@dataclass(frozen=True)
class ErrorTerm:
    """The error of one module, believed minus true."""

    words: str
    """The module, and what it has wrong: `controller: gain`."""
    of: Callable[[TrialReadings], Values]
    """Takes it from a trial, a number a step; a pure function."""


@dataclass(frozen=True)
class ErrorSum:
    """Two errors that act together: what the system feels is their sum.

    A system that knows of such has one as its attribute `errors`.
    """

    words: str
    """Quantity that both change: `error of the expected acceleration`."""
    unit: str
    terms: tuple[ErrorTerm, ErrorTerm]


class System(ABC):
    """A closed loop with its information interface.

    `run` must give each scene a result that does not depend on which other scenes are in the call:
    randomness comes from `faultpath.core.streams`, keyed by scene.
    """

    name: str
    control_dt_s: float
    block_size: int | None = BLOCK
    """Scenes handed to one call of `run`: the unit of work, of storage and of resuming. `None`: as
    `scenes_a_block` says."""
    parallel: bool = True
    """Whether several worker processes are faster than one; not where a GPU does the work."""
    time_limit_s: float | None = None
    """Seconds that a worker may take over one block, or one scene of a block that failed, unless
    the user says otherwise; `None`: an hour."""
    trained: bool = False
    """Whether variants hold trained models: results then speak of these models, as trained."""
    metrics: Mapping[str, Metric] = MappingProxyType({})
    """Measurements of its outcomes beside status and time, by name."""
    ends: Mapping[Status, str] = MappingProxyType({})
    """Words for a trial's end where it is not called by its status, for example `missed`."""
    errors: ErrorSum | None = None
    """Two errors that act together, for the report; no trial reads them."""
    more_signals: str = ""
    """`module:function` of what a recorded trial says beside its readings, in place of `errors`:
    `function(system, recorded, done)` returns a tuple of signals a scene. It is a name, since
    whatever a system imports counts as run."""

    @property
    @abstractmethod
    def interface(self) -> Interface:
        """Channels that the modules read, and the sources they come from."""

    @property
    @abstractmethod
    def variants(self) -> Mapping[str, Variant]:
        """The ways to wire the system, by name."""

    @property
    def fault_presets(self) -> Mapping[str, FaultPreset]:
        """Named faults of the command line, such as `calibration`."""
        return {}

    def fault(self, text: str | FaultText) -> tuple[Fault, ...]:
        """Return the faults that a text states, one for each channel; see `parse_fault`."""
        return parse_fault(text, self.interface, self.fault_presets, self.control_dt_s)

    @abstractmethod
    def library(self, name: str) -> Library:
        """Return a library of scenes; `UserError` for an unknown name."""

    @abstractmethod
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> Sequence[Outcome]:
        """Run one trial in each scene, in order; every reading goes through `taps`.

        The taps are new and for these scenes. The caller fills in `faulted_steps` and
        `altered_steps` from their delivery log.
        """

    def scenes_a_block(self, scenes: int) -> int:
        """Return the size of the blocks of a library with so many scenes.

        It follows from counts alone, never from how long a block took, so that a run that is
        resumed, on whatever machine, finds its blocks again.
        """
        del scenes
        return self.block_size or BLOCK

    @property
    def data_files(self) -> Sequence[str | PathLike[str]]:
        """Files and folders whose contents decide a result, such as weights.

        Relative ones are looked for beside the file of the system. A change of their contents is
        noticed as one of the source is: trials of before are not taken for trials of now.
        """
        return ()

    @property
    def parts(self) -> Sequence[str]:
        """Factories of parts that the user named, as `path/to/file.py:factory`, if it takes any.

        Their code counts as the system's own does.
        """
        return ()

    def fingerprint(self) -> str:
        """Return what decides a result and stands in no file: a device, an option, a service.

        Source, data files and versions of packages are found without it; see
        `faultpath.run.code`.
        """
        return ""

    @property
    def backend(self) -> str:
        """Name of what computes the trials, where that depends on the machine."""
        return ""

    def floor_plan(self, scene: str) -> FloorPlan | None:
        """Return the shapes that a report draws for a scene, if the system has any."""
        del scene
        return None
