"""A library of the user's own in the place of the held-out one: which pages it changes."""

from collections.abc import Iterable
from pathlib import Path

from faultpath.errors import UserError
from faultpath.studies.cells import HELD_OUT, Profile
from faultpath.studies.page import Page
from faultpath.trials import Library


def shown(name: str) -> str:
    """Return how a library is called in notes: a file without its folder and ending."""
    return Path(name).stem


def words(pages: Iterable[Page], profile: Profile, given: str, library: Library) -> str:
    """Return which library flies, and which pages stay, in whole or in part, on another.

    Raises `UserError` where all of `pages` stay: the library `given` would not be flown.
    """
    roles = {page.name: _roles(page, profile) for page in pages}
    kept = [name for name, found in roles.items() if found and HELD_OUT not in found]
    mixed = [name for name, found in roles.items() if HELD_OUT in found and len(found) > 1]
    others = sorted({role for found in roles.values() for role in found} - {HELD_OUT})
    elsewhere = f"the {' and '.join(others)} library"
    if len(kept) == len(roles):
        flown = "is flown" if len(kept) == 1 else "are flown"
        raise UserError(
            f"{', '.join(kept)} {flown} on {elsewhere}, as in the paper, so '{given}' would change "
            "nothing: leave --library out, or name a page that is flown on held-out scenes."
        )
    said = [f"The library {shown(library.name)} takes the place of the held-out one."]
    if kept:
        said.append(f"On {elsewhere} stay, as in the paper: {', '.join(kept)}.")
    if mixed:
        said.append(f"In part on it: {', '.join(mixed)}.")
    return " ".join(said)


def _roles(page: Page, profile: Profile) -> set[str]:
    flown = {cell.setting.library for cell in profile.cells(page.cells)}
    measured = {m.recording.library for m in page.measurements if m.seed in profile.seeds}
    return flown | measured
