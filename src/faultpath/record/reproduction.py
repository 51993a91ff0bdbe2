"""Everything that a reproduction concludes: pages are made from this alone."""

from pydantic import BaseModel, ConfigDict

from faultpath.record.claim import Ledger
from faultpath.record.sweep import Sweep
from faultpath.tables import Table


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class SceneShown(_Frozen):
    """A scene of the gallery."""

    scene: str
    topology: str


class Configuration(_Frozen):
    """One setting of the system as it was flown."""

    setting: str
    library: str
    library_hash: str
    system_fingerprint: str
    """Hash of code, weights, kernels and options: everything frozen that decides a trial."""
    arms: int
    trials: int


class Reproduction(_Frozen):
    """Ledger, tables and figures of one run, in the order in which they are read."""

    profile: str
    ledger: Ledger
    tables: tuple[Table, ...]
    figures: tuple[Sweep, ...]
    gallery: tuple[SceneShown, ...]
    configurations: tuple[Configuration, ...]
    trials: int
    failed_trials: int
    flown: tuple[str, str] | None
    """When the first and the last block of trials were written, over all invocations; `None` where
    nothing had to be flown."""
