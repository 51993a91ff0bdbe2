"""A pool of training data on disk: one file of tensors, whose note says how they were made.

A pool is made part by part. A part depends on nothing but the pool's recipe and its place, so a run
that was killed loses at most the parts at work, and the next one goes on there and ends with the
same bytes.
"""

from __future__ import annotations

import hashlib
import json
import logging
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Protocol

import torch
from pydantic import Field, JsonValue, ValidationError
from torch import Tensor

from faultpath import __version__
from faultpath.plugin.data import Root, locked, packages, sweep, trees_of, write
from faultpath.plugin.system import Frozen, Misread, UserError
from faultpath.plugin.training import encoded, read_note, read_tensors
from faultpath.plugin.work import local, run_all

Progress = Callable[[float, float], None]
"""Called with the amount done and the total; its first call counts existing files."""


@dataclass(frozen=True)
class DataFile:
    """A file and the function that makes it; it counts as made once the file exists."""

    path: Path
    make: Callable[[], None]
    """A function of a module bound to its arguments, so that a worker process can call it."""
    size: int = 1
    """Its weight in the progress."""


def make_missing(
    stages: Sequence[Sequence[DataFile]], workers: int, progress: Progress | None
) -> None:
    """Make what is missing, one stage after the other, with so many processes (0: this one).

    Raises the error of the first part that fails.
    """
    report = progress or (lambda done, total: None)
    missing = [[part for part in stage if not part.path.exists()] for stage in stages]
    total = sum(part.size for stage in stages for part in stage)
    done = total - sum(part.size for stage in missing for part in stage)
    report(done, total)
    with local(workers) as executor:
        for stage in missing:
            for place, _ in run_all(executor, [part.make for part in stage]):
                done += stage[place].size
                report(done, total)


FORMAT = 3

_log = logging.getLogger("faultpath")


class PoolRecipe(Frozen):
    """Settings that decide every number of a pool."""

    format: int = FORMAT
    pool: str
    episodes: int
    """Flights, or scenes of depth images."""
    seed: int
    code_sha256: str
    """Hash of the code that makes the data, with all its settings."""
    settings: dict[str, JsonValue] = Field(default_factory=dict[str, JsonValue])
    """What else the caller may choose."""


class Provenance(PoolRecipe):
    """A recipe, the versions it was made with, and the digest of the result."""

    faultpath_version: str
    packages: dict[str, str]
    content_sha256: str


class PartData(Protocol):
    """What a part holds."""

    def tensors(self) -> Mapping[str, Tensor]:
        """Return them by name, the samples along the first axis."""
        ...


@dataclass(frozen=True)
class PoolPart:
    """Data that are made together."""

    name: str
    size: int
    """Its weight in the progress."""
    make: Callable[[], PartData]
    """A function of a module bound to its arguments, so that a worker process can call it."""


def pool_path(folder: Path, name: str) -> Path:
    """Return the file of a pool, which is there once the pool is whole."""
    return folder / f"{name}.safetensors"


def make_pool(
    folder: Path,
    recipe: PoolRecipe,
    parts: Sequence[PoolPart],
    workers: int,
    progress: Progress | None = None,
) -> Path:
    """Make the parts of a pool that are missing, join them, and return the pool's file.

    The folder of the parts changes with anything that decides them. The number of episodes does
    not: a larger pool uses the parts that are there. Raises `UserError` for a pool of another
    recipe, and when `folder` cannot be written.
    """
    path = pool_path(folder, recipe.pool)
    if is_there(path, recipe):
        return path
    content = json.dumps([recipe.model_dump(mode="json", exclude={"episodes"}), packages()])
    place = folder / f".{recipe.pool}-{hashlib.sha256(content.encode()).hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, _log.warning):
            sweep(folder)
            if is_there(path, recipe):  # made by another process meanwhile
                return path
            place.mkdir(exist_ok=True)
            sweep(place)
            files = [pool_path(place, part.name) for part in parts]
            missing = [
                DataFile(file, partial(store, file, part.make), part.size)
                for file, part in zip(files, parts, strict=True)
            ]
            make_missing([missing], workers, progress)
            tensors = joined(files)
            provenance = Provenance(
                **dict(recipe),
                faultpath_version=__version__,
                packages=packages(),
                content_sha256=_digest(tensors),
            )
            write(path, encoded(tensors, provenance.model_dump(mode="json")))
            for old in folder.glob(f".{recipe.pool}-*"):  # also of outdated recipes
                shutil.rmtree(old)
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to "
            "and that has room."
        ) from error
    return path


def is_there(path: Path, recipe: PoolRecipe) -> bool:
    """Return whether a pool is finished; `UserError` for one of another recipe."""
    provenance = read_provenance(path)
    if provenance is None:
        return False
    for field in PoolRecipe.model_fields:
        if getattr(provenance, field) != getattr(recipe, field):
            how = "by other code" if field == "code_sha256" else f"with another '{field}'"
            raise UserError(
                f"the pool at {path} was collected {how}, with faultpath "
                f"{provenance.faultpath_version}: choose another folder, or delete the file to "
                "collect it again."
            )
    return True


def read_provenance(path: Path) -> Provenance | None:
    """Return where a pool comes from, `None` where there is none; `UserError` if damaged."""
    try:
        return Provenance.model_validate(read_note(path))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, Misread, ValidationError) as error:
        raise _damaged(path) from error


def read_pool(path: Path) -> tuple[str, dict[str, Tensor]]:
    """Return a pool's name and tensors; `UserError` when it is missing or damaged."""
    provenance = read_provenance(path)
    if provenance is None:
        raise UserError(f"there is no finished pool at {path}: collect it first.")
    try:
        tensors = read_tensors(path)[1]
    except (OSError, Misread) as error:
        raise _damaged(path) from error
    if _digest(tensors) != provenance.content_sha256:
        raise _damaged(path)
    return provenance.pool, tensors


def pools_sha256(data: Path, pools: Iterable[str]) -> dict[str, str]:
    """Return the digest of each pool in a folder, as far as it is finished."""
    known = {name: read_provenance(pool_path(data, name)) for name in pools}
    return {name: pool.content_sha256 for name, pool in known.items() if pool is not None}


def store(path: Path, make: Callable[[], PartData]) -> None:
    """Make and write a part; `OSError` when the disk will not."""
    write(path, encoded(make().tensors()))


def joined(files: Iterable[Path]) -> dict[str, Tensor]:
    """Return the tensors of some parts that `store` wrote, one behind the other."""
    parts = [read_tensors(file)[1] for file in files]
    return {name: torch.cat([part[name] for part in parts]) for name in parts[0]}


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


def _digest(tensors: Mapping[str, Tensor]) -> str:
    digest = hashlib.sha256()
    for name, value in sorted(tensors.items()):
        digest.update(f"{name} {value.dtype} {list(value.shape)}".encode())
        digest.update(value.contiguous().numpy().tobytes())
    return digest.hexdigest()


def _damaged(path: Path) -> UserError:
    return UserError(f"{path} is damaged, or no pool: delete it and collect it again.")
