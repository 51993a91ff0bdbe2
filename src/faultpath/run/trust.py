"""Code that a received file names, which may be anybody's: imported once a person says so."""

import re
from collections.abc import Collection, Iterator, Sequence

from faultpath.core.errors import UserError
from faultpath.core.text import one_line
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import factory_name, installed_systems

PART = re.compile(r"([^:]+:[A-Za-z_]\w*)(?:/|$)")
"""A part of the user's own, in the name of a variant or in an option."""


def check_named(
    file: str, spec: SystemSpec, variants: Sequence[str], named: Collection[str], trusted: bool
) -> None:
    """Raise `UserError` where building `spec`, which `file` describes, would import code that is
    not installed and that the person has not `named` too, unless everything is `trusted`."""
    again = {*named, *map(factory_name, named)}
    unnamed = [one_line(name) for name in _names(spec, variants) if name not in again]
    if unnamed and not trusted:
        raise UserError(
            f"{file} names {', '.join(unnamed)}, and importing that runs it: look at it first, "
            "then name it too, with --code, or give --trust"
        )


def _names(spec: SystemSpec, variants: Sequence[str]) -> Iterator[str]:
    """Yield what names code that is not installed: the system, then whatever may name a part.

    How a system reads its options is its own affair, so each that could name code counts whole.
    """
    if spec.name not in installed_systems():
        yield spec.name
    pieces = [piece.strip() for value in spec.options.values() for piece in value.split(",")]
    pieces += [name for variant in variants for name in PART.findall(variant)]
    yield from dict.fromkeys(piece for piece in pieces if ":" in piece or ".py" in piece)
