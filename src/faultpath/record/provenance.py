"""Where a result comes from."""

from pydantic import BaseModel, ConfigDict


class RunProvenance(BaseModel):
    """The conditions under which a run was made; written as `provenance.json`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    faultpath_version: str
    commit: str | None
    dirty: bool | None
    command: tuple[str, ...]
    python: str
    packages: dict[str, str]
    platform: str
    processor: str
    backend: str = ""
    """What computed the trials, where a system says so."""
    workers: int
    started: str
    finished: str
    wall_s: float
    """Of the last invocation; shards kept from earlier ones are not counted."""
    blocks_computed: int
    blocks_kept: int
    system_fingerprint: str
    library_hash: str
    outcomes_sha256: str
