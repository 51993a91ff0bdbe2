"""Libraries of scenes: the frozen ones of the package, and a user's own files.

A library file is JSON, one scene per line, with a content hash of each scene and of all.
`experiments/scene-libraries` makes them from a seed.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from pydantic import ValidationError

from faultpath.plugin.system import LARGEST_TEXT, UserError, contents, misfit_of, read_json
from faultpath_quadrotor.scenes.scene import Scene, digest
from faultpath_quadrotor.scenes.soundness import misnamed, unsound

FORMAT = "faultpath-scenes/1"

FROZEN = ("training", "selection", "held-out", "confirmation", "decision")
"""The libraries of the package, 100 scenes each [paper, setup]; `confirmation` has 300 and
`decision` 400."""


@dataclass(frozen=True)
class SceneLibrary:
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
    def of(cls, name: str, scenes: tuple[Scene, ...]) -> "SceneLibrary":
        """Return the library of some scenes, with its hash."""
        return cls(name, scenes, digest([name, *(scene.content_hash for scene in scenes)]))

    def __len__(self) -> int:
        return len(self.scenes)

    def __iter__(self) -> Iterator[Scene]:
        return iter(self.scenes)

    def __getitem__(self, index: int) -> Scene:
        return self.scenes[index]


def load_library(name: str | Path) -> SceneLibrary:
    """Return a frozen library by its name, or a library from a file that can be flown.

    Raises `UserError` where there is no such file, it is damaged, or a scene cannot be flown.
    """
    if isinstance(name, str) and name in FROZEN:
        return _read(frozen_file(name), f"frozen library {name!r}")
    path = Path(name)
    if not path.exists():
        raise UserError(
            f"There is no scene library {str(name)!r}: give one of {', '.join(FROZEN)}, or "
            "the path of a library file."
        )
    return _read(path, f"scene library {str(path)!r}")


def frozen_file(name: str) -> Traversable:
    """Return the file of a frozen library inside the package."""
    return files("faultpath_quadrotor.scenes") / "frozen" / f"{name}.json"


def _read(file: Traversable | Path, what: str) -> SceneLibrary:
    """Read a library file and check it against its hash; `what` names it in errors."""
    remedy = f"make it again, or use one of {', '.join(FROZEN)}"
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
        library, promised = SceneLibrary.of(str(content["name"]), scenes), content["content_hash"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        cause = error.strerror if isinstance(error, OSError) else str(error)
        reason = (str(cause).splitlines() or [type(error).__name__])[0]
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
        misfit = misfit_of(error, Scene)
        field = f"field {misfit}" if misfit.where else misfit
        raise ValueError(f"scene {place}, {field}") from None


def _refusal(library: SceneLibrary) -> str:
    if library.name in FROZEN:
        frozen = json.loads(frozen_file(library.name).read_text(encoding="utf-8"))
        if library.content_hash != frozen["content_hash"]:
            return f"its name {library.name!r} belongs to the package"
    if wrong := misnamed(library.name, library.scenes):
        return wrong
    for place, scene in enumerate(library.scenes):
        if wrong := unsound(scene):
            return f"scene {place}, field {wrong}"
    return ""


def as_text(library: SceneLibrary) -> str:
    """Return a library as the text of its file, one scene per line."""
    head = {"format": FORMAT, "name": library.name, "content_hash": library.content_hash}
    lines = ",\n".join(
        json.dumps(scene.model_dump(mode="json"), separators=(",", ":")) for scene in library.scenes
    )
    return f'{json.dumps(head)[:-1]}, "scenes": [\n{lines}\n]}}\n'
