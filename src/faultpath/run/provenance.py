"""Where a result comes from."""

from typing import Annotated

from pydantic import ConfigDict, Field, StringConstraints

from faultpath.core.results import Frozen, Shown
from faultpath.run.findings import Recheck

FileName = Annotated[str, StringConstraints(pattern=r"^[a-z_]+\.[a-z]+$")]

Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]


class RunCode(Frozen):
    """Code and data that ran."""

    faultpath_version: str
    commit: str | None
    """Of faultpath's own checkout."""
    dirty: bool | None
    system_fingerprint: str
    """Hash of the sources, data files and packages at the time, and of what the system says."""
    system_commit: str | None = None
    """Commit of the repository in which the system's file is tracked."""
    system_dirty: bool | None = None
    """Whether a file that ran differs from that commit."""
    sources: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each package that ran, and of each source in a folder of the user's."""
    data: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each data file that the system names."""


class RunMachine(Frozen):
    """What the code ran on."""

    python: str
    packages: dict[str, str]
    platform: str
    processor: str
    backend: str = ""
    """Name of what computed the trials, where a system says so."""
    workers: int
    executor: str = ""
    """On what they were, where that is not this machine; platform and processor are this one's."""


class RunProvenance(Shown):
    """The conditions under which a run was made; written as `provenance.json`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    command: tuple[str, ...]
    code: RunCode
    machine: RunMachine
    started: str
    finished: str
    wall_s: float
    """Wall time of the last invocation; shards kept from earlier ones are not counted."""
    blocks_computed: int
    blocks_kept: int
    library_hash: str
    rechecks: tuple[Recheck, ...] = ()
    """Trials that ran a second time, to see whether results repeat."""
    files: dict[FileName, Sha256] = Field(default_factory=dict[str, str])
    """The files beside this one that a report is made from, so that a change of one is seen."""
