"""Run folders that are named after a question and the code that flew."""

import re
from pathlib import Path

from faultpath.code import CodeState, named
from faultpath.errors import UserError
from faultpath.store.manifest import Manifest, read_manifest

_KEY = 8
"""Digits of the code's digest in a folder's name."""


def keyed(place: Path, name: str, code: CodeState) -> tuple[Path, str]:
    """Return the folder for a question, flown by `code`, and a sentence for the user.

    The sentence says where the same question was flown by other code, which is kept; it is empty
    where it was not, and where this code has begun already.
    """
    folder = place / f"{name}-{code.digest[:_KEY]}"
    others = {} if folder.exists() or not place.is_dir() else _others(place, name)
    if not others:
        return folder, ""
    latest = max(others, key=lambda path: path.stat().st_mtime)
    manifest = others[latest]
    changed = "" if manifest is None else f" ({named(manifest.code.changed(code))})"
    return folder, (
        f"The code has changed since {latest}{changed}: that run is kept, and this one starts anew "
        f"in {folder}."
    )


def _others(place: Path, name: str) -> dict[Path, Manifest | None]:
    """Return the folders of the same name, each with its manifest where it can be read."""
    key = re.compile(re.escape(name) + rf"-[0-9a-f]{{{_KEY}}}")
    found: dict[Path, Manifest | None] = {}
    for path in place.iterdir():
        if key.fullmatch(path.name):
            try:
                found[path] = read_manifest(path / "manifest.json")
            except UserError:  # of another format, or damaged
                found[path] = None
    return found
