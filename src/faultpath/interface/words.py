"""Sentences for names that do not exist."""

from collections.abc import Iterable
from difflib import get_close_matches


def listed(names: Iterable[str]) -> str:
    """Return names in one line, `none` when there are none."""
    return ", ".join(sorted(names)) or "none"


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """Return `unknown WHAT 'NAME'`, a close match where there is one, and the known names."""
    known = tuple(known)
    close = get_close_matches(name, known, n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"unknown {what} '{name}'; {hint}known: {listed(known)}"
