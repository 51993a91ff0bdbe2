"""Libraries of scenes: the three frozen ones of the package, and a user's own files.

A library file is JSON, one scene per line, with a content hash of each scene and of all. The frozen
files can be made again, to the byte, from the seeds below. Only the making needs torch.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.files.opening import LARGEST_TEXT, contents
from faultpath.files.plain import read_json
from faultpath.misfits import misfit_of
from faultpath.quadrotor.scenes.scene import Scene, digest
from faultpath.quadrotor.scenes.soundness import misnamed, unfit_name, unsound

FORMAT = "faultpath-scenes/1"

FROZEN_SEEDS = {"training": 101, "selection": 202, "held-out": 303}
"""The libraries of the package and the seeds that made them, 100 scenes each [paper, setup]."""


@dataclass(frozen=True)
class Library:
    """Scenes that belong together.

    Attributes:
        name: The library's name.
        scenes: Its scenes in order; scene i has index i.
        content_hash: Hexadecimal digest of the name and of every scene.
    """

    name: str
    scenes: tuple[Scene, ...]
    content_hash: str

    @classmethod
    def of(cls, name: str, scenes: tuple[Scene, ...]) -> "Library":
        """Return the library of some scenes, with its hash."""
        return cls(name, scenes, digest([name, *(scene.content_hash for scene in scenes)]))

    def __len__(self) -> int:
        return len(self.scenes)

    def __iter__(self) -> Iterator[Scene]:
        return iter(self.scenes)

    def __getitem__(self, index: int) -> Scene:
        return self.scenes[index]


def load_library(name: str | Path) -> Library:
    """Return a frozen library by its name, or a library from a file that can be flown.

    Args:
        name: One of `FROZEN_SEEDS`, or the path of a file that `write_library` made.

    Raises:
        UserError: If there is no such library or file, the file is damaged, or a scene cannot be
            flown; names the scene and the field.
    """
    if isinstance(name, str) and name in FROZEN_SEEDS:
        return _read(frozen_file(name), f"frozen library {name!r}")
    path = Path(name)
    if not path.exists():
        raise UserError(
            f"There is no scene library {str(name)!r}: give one of {', '.join(FROZEN_SEEDS)}, or "
            "the path of a file that write_library made."
        )
    return _read(path, f"scene library {str(path)!r}")


def frozen_file(name: str) -> Traversable:
    """Return the file of a frozen library inside the package."""
    return files("faultpath.quadrotor.scenes") / "frozen" / f"{name}.json"


def _read(file: Traversable | Path, what: str) -> Library:
    """Read a library file and check it against its hash; `what` names it in errors."""
    remedy = f"make it again with write_library, or use one of {', '.join(FROZEN_SEEDS)}"
    try:
        data = contents(file, LARGEST_TEXT) if isinstance(file, Path) else file.read_bytes()
        content = read_json(data)
        if content["format"] != FORMAT:
            raise UserError(
                f"The {what} has the format {content['format']!r}, but this version reads "
                f"{FORMAT!r}: {remedy}."
            )
        entries: list[object] = list(content["scenes"])
        scenes = tuple(_scene(place, entry) for place, entry in enumerate(entries))
        library, promised = Library.of(str(content["name"]), scenes), content["content_hash"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        reason = (str(said).splitlines() or [type(error).__name__])[0]
        raise UserError(f"The {what} cannot be read as a library ({reason}): {remedy}.") from error
    if library.content_hash != promised:
        raise UserError(
            f"The {what} was changed after it was written (content hash {library.content_hash}, "
            f"but the file says {promised}): {remedy}."
        )
    if wrong := _refusal(library):
        raise UserError(f"The {what} cannot be flown: {wrong}; correct it, or {remedy}.")
    return library


def _scene(place: int, entry: object) -> Scene:
    try:
        return Scene.model_validate_json(json.dumps(entry), strict=True)
    except ValidationError as error:
        found = misfit_of(error, Scene)
        raise ValueError(f"scene {place}, {f'field {found}' if found.where else found}") from None


def _refusal(library: Library) -> str:
    if library.name in FROZEN_SEEDS:
        frozen = json.loads(frozen_file(library.name).read_text(encoding="utf-8"))
        if library.content_hash != frozen["content_hash"]:
            return f"its name {library.name!r} belongs to the package"
    if wrong := misnamed(library.name, library.scenes):
        return wrong
    for place, scene in enumerate(library.scenes):
        if wrong := unsound(scene):
            return f"scene {place}, field {wrong}"
    return ""


def generate_library(
    name: str, seed: int, count: int, progress: Callable[[int], None] = lambda made: None
) -> Library:
    """Return `count` new scenes; the same name, seed and count give the same scenes.

    `progress` is told after each how many there are.
    """
    from faultpath.quadrotor.scenes.generate import generate_scene

    scenes: list[Scene] = []
    for index in range(count):
        scenes.append(generate_scene(name, index, seed))
        progress(len(scenes))
    return Library.of(name, tuple(scenes))


def as_text(library: Library) -> str:
    """Return a library as the text of its file, one scene per line."""
    head = {"format": FORMAT, "name": library.name, "content_hash": library.content_hash}
    lines = ",\n".join(
        json.dumps(scene.model_dump(mode="json"), separators=(",", ":")) for scene in library.scenes
    )
    return f'{json.dumps(head)[:-1]}, "scenes": [\n{lines}\n]}}\n'


def write_library(
    path: str | Path,
    seed: int,
    count: int,
    name: str,
    progress: Callable[[int], None] = lambda made: None,
) -> Library:
    """Generate a library and write it to a file.

    Args:
        path: The file to write; it must not exist yet.
        seed: Seed of the library.
        count: How many scenes.
        name: Name of the library; it becomes part of every scene's id. The names of the frozen
            libraries are taken, so that no scene of a user's can pass for one of theirs.
        progress: Told after each scene how many there are.

    Raises:
        UserError: If the name is taken or none, the count is not positive, or the file exists.
        OSError: The file's folder cannot be made, or the file not be written.
    """
    if name in FROZEN_SEEDS:
        raise UserError(f"The library name {name!r} belongs to the package: choose another name.")
    if wrong := unfit_name(name):
        raise UserError(f"The library cannot be made: {wrong}.")
    if count < 1:
        raise UserError(f"A library of {count} scenes cannot be made: ask for at least 1.")
    path = Path(path)
    if path.exists():
        raise UserError(f"The file {str(path)!r} exists already: remove it or name another.")
    from faultpath.store import write_text  # it brings pyarrow, which reading does not need

    path.parent.mkdir(parents=True, exist_ok=True)
    library = generate_library(name, seed, count, progress)
    write_text(path, as_text(library))
    return library
