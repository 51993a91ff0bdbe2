"""What a run folder says about itself, whether it may go on, and which one a question has."""

import json
from pathlib import Path
from typing import Any

from faultpath.core.errors import UserError
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.plain import Misread, model_of, read_json
from faultpath.core.frozen import Frozen
from faultpath.trials.arm import Study
from faultpath.trials.code import CodeState, named

FORMAT = 2
"""Version of the folder's layout and of its columns."""


class Manifest(Frozen):
    """The study of a run folder and the exact system and scenes that it was run with."""

    format: int = FORMAT
    faultpath_version: str
    code: CodeState
    """Source files, data files, packages."""
    library_hash: str
    study: Study

    def encode(self) -> bytes:
        """Return the file's contents."""
        content = self.model_dump(mode="json")
        return (json.dumps(content, indent=2, sort_keys=True) + "\n").encode()


def read_manifest(path: Path) -> Manifest | None:
    """Read a manifest, `None` when there is none; `UserError` when this version cannot use it."""
    try:
        data = contents(path, LARGEST_TEXT)
        content: Any = read_json(data)
        found: Any = content["format"]
    except FileNotFoundError:
        return None
    except (OSError, Misread, TypeError, KeyError) as error:
        raise _damaged(path, error) from error
    if found != FORMAT:
        raise UserError(
            f"{path.parent} was written in format {found} and this faultpath reads format "
            f"{FORMAT}: choose another folder, or the version of faultpath that wrote it"
        )
    try:
        return model_of(data, Manifest)
    except Misread as error:
        raise _damaged(path, error) from error


def check_same(folder: Path, found: Manifest, asked: Manifest, shared: bool = False) -> None:
    """Raise `UserError` unless `folder` may go on with the study that is asked for.

    The selection of scenes may differ: a quick look at some scenes grows into the whole library
    in the same folder, and keeps what it has. In a folder that studies of one system share, their
    names and arms may differ as well.
    """
    same_study = (
        ("study", found.study.name, asked.study.name),
        ("set of variants, faults or seeds", found.study.rows, asked.study.rows),
        ("number of scenes from look to look", found.study.look, asked.study.look),
    )
    differences = [
        what
        for what, one, two in (
            ("version of faultpath", found.faultpath_version, asked.faultpath_version),
            ("system", found.study.system, asked.study.system),
            ("library", found.study.library, asked.study.library),
            ("state of the library", found.library_hash, asked.library_hash),
            *(() if shared else same_study),
        )
        if one != two
    ]
    changed = found.code.changed(asked.code)
    if changed and not differences:
        raise UserError(
            f"{folder} holds trials of other code than this (changed since: {named(changed)}): "
            "they are kept and not mixed with new ones; choose a new folder, or go back to that "
            "code to resume"
        )
    if differences:
        raise UserError(
            f"{folder} holds the run of another study, with another {differences[0]}: choose a "
            "new folder, or repeat the command that made this one"
        )


def _damaged(path: Path, error: Exception) -> UserError:
    why = error.strerror if isinstance(error, OSError) else error
    return UserError(
        f"{path} cannot be read as a manifest ({why}): choose a new folder, or delete this one"
    )


def keyed(place: Path, name: str, code: CodeState) -> Path:
    """Return the folder for a question, run by `code`."""
    return place / f"{name}-{code.digest[:8]}"
