"""The state of the code behind a result: one digest, and what it is made of."""

import gc
import json
import platform
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from faultpath.code.graph import Graph, Root
from faultpath.errors import UserError


class CodeState(BaseModel):
    """Digests of everything outside installed packages that decides a result, and versions."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    files: dict[str, str]
    """SHA-256 of each source file, by module."""
    data: dict[str, str] = {}
    """SHA-256 of each data file."""
    packages: dict[str, str]
    """Versions of the installed packages that these files import."""
    python: str
    given: str = ""
    """What the system says of itself beside."""

    @property
    def digest(self) -> str:
        """Hash of all of it."""
        return _hash(self.model_dump(mode="json"))

    @property
    def sources(self) -> str:
        """Hash of the source files alone."""
        return _hash(self.files)

    def changed(self, other: "CodeState") -> tuple[str, ...]:
        """Say what `other` has otherwise: files, data files, packages, Python."""
        found = [
            *_differences(self.files, other.files),
            *_differences(self.data, other.data),
            *_differences(self.packages, other.packages),
        ]
        if self.python != other.python:
            found.append("Python")
        if self.given != other.given:
            found.append("what fingerprint() returns")
        return tuple(found)


def code_state(
    roots: Iterable[Root], data: Iterable[Path] = (), base: Path | None = None, given: str = ""
) -> CodeState:
    """Return the state of what `roots` import and of some data files and folders.

    Paths of data are taken from `base`. `UserError` for a data file that cannot be read.
    """
    graph = Graph()
    with _no_collection():
        for root in roots:
            graph.add(root)
    return CodeState(
        files={name: digest for name, (_, digest) in sorted(graph.files.items())},
        data=_data(data, base or Path()),
        packages=dict(sorted(graph.packages.items())),
        python=platform.python_version(),
        given=given,
    )


@contextmanager
def _no_collection() -> Iterator[None]:
    """Keep the garbage collector from looking through all of torch for the sake of syntax trees."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _data(paths: Iterable[Path], base: Path) -> dict[str, str]:
    found: dict[str, str] = {}
    for path in paths:
        place = base / path
        try:
            files = sorted(p for p in place.rglob("*") if p.is_file()) if place.is_dir() else [place]
            for file in files:
                name = file.relative_to(base) if file.is_relative_to(base) else file
                found[name.as_posix()] = sha256(file.read_bytes()).hexdigest()
        except OSError as error:
            raise UserError(
                f"cannot read {place} ({error.strerror}), which the system names among its data "
                "files: put it there, or take it out of data_files"
            ) from error
    return dict(sorted(found.items()))


def _differences(mine: dict[str, str], theirs: dict[str, str]) -> list[str]:
    return sorted(name for name in {*mine, *theirs} if mine.get(name) != theirs.get(name))


def _hash(content: object) -> str:
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
