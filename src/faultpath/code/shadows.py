"""Modules of which a folder holds another file than an import finds."""

import os
from dataclasses import dataclass
from pathlib import Path

from faultpath.code.graph import Graph, Root
from faultpath.code.places import Kind, file_of, kind_of, locate


@dataclass(frozen=True)
class Shadowed:
    """A module that is another one than the folder's own."""

    module: str
    found: Path
    own: Path


def shadowed(root: Root, folder: Path) -> Shadowed | None:
    """Return the first module that `root` imports and that is not the one in `folder`.

    A process holds one module of a name. Where two systems have a `helper.py` each, the second
    would run the first one's, and its own would count for nothing. Modules of Python and of
    installed packages go before a file of that name, as everybody expects who writes
    `import logging` in a package that has a `logging.py`.
    """
    graph = Graph()
    graph.add(root)
    for name in sorted(graph.modules):
        own, spec = _own(name, folder), locate(name)
        found = None if spec is None else file_of(spec)
        if own is None or found is None or name.partition(".")[0] == "faultpath":
            continue
        if os.path.realpath(own) != os.path.realpath(found) and kind_of(found) is Kind.LOCAL:
            return Shadowed(name, found, own)
    return None


def _own(name: str, folder: Path) -> Path | None:
    place = folder.joinpath(*name.split("."))
    files = (place / "__init__.py", place.with_name(f"{place.name}.py"))
    return next((file for file in files if os.path.isfile(file)), None)
