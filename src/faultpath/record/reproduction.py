"""Everything that a reproduction concludes: pages are made from this alone."""

from pydantic import BaseModel, ConfigDict

from faultpath.record.claim import Ledger
from faultpath.record.table import Sweep, Table


class SceneShown(BaseModel):
    """A scene of the gallery."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: str
    topology: str


class Reproduction(BaseModel):
    """Ledger, tables and figures of one run, in the order in which they are read."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    profile: str
    ledger: Ledger
    tables: tuple[Table, ...]
    figures: tuple[Sweep, ...]
    gallery: tuple[SceneShown, ...]
    trials: int
    failed_trials: int
