"""Code that a received file names, which may be anybody's: imported once a person trusts it."""

import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.text import one_line
from faultpath.trials.arm import SystemSpec
from faultpath.trials.code import named, source_state
from faultpath.trials.registry import factory_root, installed_systems

PART = re.compile(r"([^:]+:[A-Za-z_]\w*)(?:/|$)")
"""A part of the user's own, in the name of a variant or in an option."""


@dataclass(frozen=True)
class ReceivedCode:
    """A file that names code: what it is called, and whether that code may be imported."""

    name: str
    trusted: bool
    say: Callable[[str], None]
    sources: Mapping[str, str] = field(default_factory=dict[str, str])
    """SHA-256 of each source file that ran, by module; empty of a file that keeps none."""

    def check(self, spec: SystemSpec, variants: Sequence[str]) -> None:
        """Say what building `spec` with its `variants` would import, and what of it has changed.

        `UserError` for code that is not installed, unless the person trusts it.
        """
        path = list(sys.path)
        try:  # nothing is imported, and a folder of a stranger's stays no place to import from
            names = list(_names(spec, variants))
            shown = ", ".join(_shown(name) for name in names)
            state = source_state(spec).files if self.sources else {}
        finally:
            sys.path[:] = path
        changed = [name for name in state if state[name] != self.sources.get(name)]
        if self.sources:
            kept = set(self.sources.values())
            parts = (name for name in names if name != spec.name)
            changed += [name for name in parts if not kept.issuperset(_digests(name))]
        changed.sort(key=lambda name: name.startswith("faultpath"))  # the user's own first
        differs = f"this is not the code of the run ({named(changed)} changed since)"
        if shown and not self.trusted:
            raise UserError(
                f"{self.name} names {shown}, and importing that runs it"
                f"{f'; {differs}' if changed else ''}: look at it first, then give --trust"
            )
        self.say(f"Importing {shown or spec.name}, which {self.name} names.")
        if changed:
            self.say(f"{differs[0].upper()}{differs[1:]}.")


def _names(spec: SystemSpec, variants: Sequence[str]) -> Iterator[str]:
    """Yield what names code that is not installed: the system, then whatever may name a part.

    How a system reads its options is its own affair, so each that could name code counts whole.
    """
    if spec.name not in installed_systems():
        yield spec.name
    pieces = [piece.strip() for value in spec.options.values() for piece in value.split(",")]
    pieces += [name for variant in variants for name in PART.findall(variant)]
    yield from dict.fromkeys(piece for piece in pieces if ":" in piece or ".py" in piece)


def _files(name: str) -> list[Path]:
    """Return the files that a name of code may mean, whatever stands before and behind them."""
    texts = (name, name.rpartition(":")[0], name.partition("/")[2].rpartition(":")[0])
    files = [Path(os.path.realpath(text)) for text in texts if os.path.isfile(text)]
    if not files and ".py" not in name:
        module = factory_root(SystemSpec(name=name)).path
        files = [] if module is None else [module]
    return files


def _digests(name: str) -> list[str]:
    return [sha256(file.read_bytes()).hexdigest() for file in _files(name)]


def _shown(name: str) -> str:
    """Return a name of code with its files and the beginnings of their SHA-256."""
    pairs = zip(_files(name), _digests(name), strict=True)
    files = "; ".join(f"{file}, SHA-256 {digest[:16]}..." for file, digest in pairs)
    return f"{one_line(name)} ({files or 'no file found'})"
