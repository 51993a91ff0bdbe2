"""Provenance of a pool: what decides its numbers, and the digests of the result."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from faultpath.plugin.data import Root, trees_of
from faultpath.plugin.system import Frozen, Misread, UserError, contents, model_of

FORMAT = 2


class PoolRecipe(Frozen):
    """Settings that decide every number of a pool."""

    format: int = FORMAT
    pool: str
    episodes: int
    seed: int
    code_sha256: str
    """Hash of the code that draws and flies the episodes, with all its settings."""


class PoolProvenance(PoolRecipe):
    """A recipe, the versions it was made with, and the digests of the result."""

    faultpath_version: str
    packages: dict[str, str]
    rows_sha256: str
    episodes_sha256: str

    def encode(self) -> bytes:
        """Return the file's contents."""
        content = self.model_dump(mode="json")
        return (json.dumps(content, indent=2, sort_keys=True) + "\n").encode()


def provenance_path(path: Path) -> Path:
    """Return where the provenance of the pool whose rows are in `path` stands."""
    return path.with_suffix(".json")


@cache
def code_of(*packages: str) -> str:
    """Return a hash of the Python sources of some packages, of the quadrotor and of faultpath.

    Data that they made are made again when one of these files changes.
    """
    names = (*packages, "faultpath_quadrotor", "faultpath")
    trees = [tree for tree in trees_of(map(Root, names))[0] if tree.package in names]
    digests = {
        (tree.package, path.relative_to(tree.folder).as_posix()): digest
        for tree in trees
        for path, digest in tree.digests.items()
        if path.suffix == ".py"
    }
    return hashlib.sha256(repr(sorted(digests.items())).encode()).hexdigest()[:32]


def rows_sha256(data: Path, pools: Iterable[str]) -> dict[str, str]:
    """Return the digest of the rows of each pool in a folder, as far as it is finished."""
    sources = (read_provenance(data / f"{name}.parquet") for name in pools)
    return {source.pool: source.rows_sha256 for source in sources if source is not None}


def read_provenance(path: Path) -> PoolProvenance | None:
    """Return the provenance of the pool at `path`, `None` without one; `UserError` if damaged."""
    place = provenance_path(path)
    try:
        return model_of(contents(place), PoolProvenance)
    except FileNotFoundError:
        return None
    except (OSError, Misread) as error:
        raise UserError(
            f"{place} cannot be read as a pool's provenance: delete the pool and collect it again."
        ) from error
