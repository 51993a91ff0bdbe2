"""The plan of a run folder, and whether the folder may go on with the one that is asked for."""

import json
from pathlib import Path
from typing import Any

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import check_folder
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.plain import Misread, model_of, read_json
from faultpath.core.results import Frozen
from faultpath.run.code import CodeState, named
from faultpath.run.plan import Plan

FORMAT = 3
"""Version of the folder's layout and of its columns."""


class Manifest(Frozen):
    """The plan of a run folder and the exact system and scenes that it was run with."""

    format: int = FORMAT
    faultpath_version: str
    code: CodeState
    """Source files, data files, packages."""
    library_hash: str
    plan: Plan

    def encode(self) -> bytes:
        """Return the file's contents."""
        content = self.model_dump(mode="json")
        return (json.dumps(content, indent=2, sort_keys=True) + "\n").encode()


def read_manifest(path: Path) -> Manifest | None:
    """Read a manifest, `None` when there is none; `UserError` when this version cannot use it."""
    check_folder(path.parent)
    try:
        data = contents(path, LARGEST_TEXT)
        content: Any = read_json(data)
        # Before the model, which other formats do not fit.
        if content["format"] != FORMAT:
            raise UserError(
                f"{path.parent} was written in format {content['format']} and this faultpath reads "
                f"format {FORMAT}: choose another folder, or the version of faultpath that wrote it"
            )
        return model_of(data, Manifest)
    except FileNotFoundError:
        return None
    except (OSError, Misread, TypeError, KeyError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise UserError(
            f"{path} cannot be read as a manifest ({why}): choose a new folder, or delete this one"
        ) from error


def check_same(folder: Path, previous: Manifest, manifest: Manifest, shared: bool = False) -> None:
    """Raise `UserError` unless `folder` may go on with the plan that is asked for.

    The selection of scenes may differ: a quick look at some scenes grows into the whole library
    in the same folder, and keeps what it has. In a folder that the rounds of one map or
    scan share, their treatments may differ as well.
    """
    mine, theirs = manifest.plan, previous.plan
    compared: dict[str, tuple[object, object]] = {
        "version of faultpath": (previous.faultpath_version, manifest.faultpath_version),
        "question": (theirs.name, mine.name),
        "system": (theirs.system, mine.system),
        "library": (theirs.library, mine.library),
        "state of the library": (previous.library_hash, manifest.library_hash),
    }
    if not shared:
        compared["set of variants, faults or seeds"] = (theirs.rows, mine.rows)
        per_analysis = theirs.scenes_per_analysis, mine.scenes_per_analysis
        compared["number of scenes from analysis to analysis"] = per_analysis
    differences = [what for what, (before, now) in compared.items() if before != now]
    changed = previous.code.changed(manifest.code)
    if changed and not differences:
        raise UserError(
            f"{folder} holds trials of other code than this (changed since: {named(changed)}): "
            "they are kept and not mixed with new ones; choose a new folder, or go back to that "
            "code to resume"
        )
    if differences:
        raise UserError(
            f"{folder} holds another run, with another {differences[0]}: choose a new folder, or "
            "repeat the command that made this one"
        )
