"""Code that a received file names, which may be anybody's: imported once a person trusts it."""

import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256

from faultpath.core.errors import UserError
from faultpath.trials.arm import SystemSpec
from faultpath.trials.code import named, source_state
from faultpath.trials.registry import factory_root, installed_systems

PART = re.compile(r"([^:]+:[A-Za-z_]\w*)(?:/|$)")
"""A part of the user's own, in the name of a variant or in an option."""


@dataclass(frozen=True)
class Received:
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
            shown = ", ".join(_shown(name) for name in _names(spec, variants))
            state = source_state(spec).files if self.sources else {}
        finally:
            sys.path[:] = path
        changed = [name for name in state if state[name] != self.sources.get(name)]
        differs = f"this is not the code of the run ({named(changed)} changed since)"
        if shown and not self.trusted:
            raise UserError(
                f"{self.name} names {shown}, and importing that runs it"
                f"{f'; {differs}' if changed else ''}: look at it first, then give --trust "
                "(in Python trust=True)"
            )
        self.say(f"Importing {shown or spec.name}, which {self.name} names.")
        if changed:
            self.say(f"{differs[0].upper()}{differs[1:]}.")


def _names(spec: SystemSpec, variants: Sequence[str]) -> Iterator[str]:
    """Yield the names of code that is not installed: of the system, then of its parts."""
    if spec.name not in installed_systems():
        yield spec.name
    options = (part for value in spec.options.values() for part in value.split(","))
    yield from dict.fromkeys(name for text in (*variants, *options) for name in PART.findall(text))


def _shown(name: str) -> str:
    """Return a name of code with its file and the beginning of the file's SHA-256."""
    file = factory_root(SystemSpec(name=name)).path
    if file is None:
        return f"{name} (no file of its own)"
    return f"{name} ({file}, SHA-256 {sha256(file.read_bytes()).hexdigest()[:16]}...)"
