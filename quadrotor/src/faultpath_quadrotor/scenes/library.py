"""Libraries of scenes: the frozen ones of the package, and a user's own files that can be flown.

A library file is JSON, one scene per line, with a content hash of each scene and of all.
`experiments/scene-libraries` makes them from a seed.
"""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from math import ceil, dist, prod
from pathlib import Path

from pydantic import ValidationError

from faultpath.plugin.system import LARGEST_TEXT, UserError, contents, misfit_of, read_json
from faultpath_quadrotor.scenes.prisms import arena, solids
from faultpath_quadrotor.scenes.scene import Point, Scene, digest
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M

MOST_OBSTACLES = 256
"""Boxes and pillars of a scene: all scenes of a block are padded to as many."""
FURTHEST_M = 1000.0
"""Largest coordinate: single precision still resolves tenths of a millimetre there."""
MOST_CELLS = 2**22
"""Cells of 0.1 m in an arena: 16 MB of baked distance a scene."""
CELL_M = 0.1
GOAL_RADIUS_M = 0.5  # paper, Section IV-B
_NAME = re.compile(r"\w[\w .+-]{0,63}")


def misnamed(name: str, scenes: Sequence[Scene]) -> str:
    """Return in words what is wrong with the names of a library; empty when nothing is.

    A scene's id keys its wind and the planner's noise, so no id may belong to another library.
    """
    if not _NAME.fullmatch(name):
        return (
            f"its name {name!r:.80} is none; up to 64 letters, digits, spaces and . _ + - make "
            "one, a letter or digit first"
        )
    if not scenes:
        return "it holds no scene"
    for place, scene in enumerate(scenes):
        if scene.library != name:
            return f"scene {place}, field library: {scene.library!r:.80} is not {name!r}"
        if scene.index != place:
            return f"scene {place}, field index: {scene.index} is not its place in the file"
        if scene.id != f"{name}/{place:03d}":
            return f"scene {place}, field id: {scene.id!r:.80} is not '{name}/{place:03d}'"
    return ""


def unsound(scene: Scene) -> str:
    """Return field and fault of a scene that cannot be flown; empty for a sound one."""
    return next(_faults(scene), "")


def clearance_m(scene: Scene, point: Point) -> float:
    """Return the signed distance from a point to the nearest surface, m."""
    return min(prism.distance(point) for prism in (arena(scene), *solids(scene)))


def _faults(scene: Scene) -> Iterator[str]:
    bounds = scene.bounds
    for axis, low, high in zip("xyz", bounds.low_m, bounds.high_m, strict=True):
        if low >= high:
            yield f"bounds: low_m {low:g} is not below high_m {high:g} along {axis}"
    for place, at in _points(scene):
        if any(abs(value) > FURTHEST_M for value in at):
            yield f"{place}: lies beyond {FURTHEST_M:g} m"
    sides = (high - low for low, high in zip(bounds.low_m, bounds.high_m, strict=True))
    cells = prod(ceil(side / CELL_M) for side in sides)
    if cells > MOST_CELLS:
        yield f"bounds: {cells:,} cells of {CELL_M} m are too many; at most {MOST_CELLS:,}"
    count = len(scene.boxes) + len(scene.cylinders)
    if count > MOST_OBSTACLES:
        yield f"boxes and cylinders: {count} obstacles are too many; at most {MOST_OBSTACLES}"
    for index, box in enumerate(scene.boxes):
        if min(box.half_extents_m) <= 0:
            yield f"boxes.{index}.half_extents_m: {box.half_extents_m} are not all positive"
    for index, pillar in enumerate(scene.cylinders):
        if pillar.low_m >= pillar.high_m:
            yield (
                f"cylinders.{index}: low_m {pillar.low_m:g} is not below high_m {pillar.high_m:g}"
            )
    for place, at in (("start_m", scene.start_m), ("goal_m", scene.goal_m)):
        yield from _not_free(scene, place, at)
    if dist(scene.start_m, scene.goal_m) <= GOAL_RADIUS_M:
        yield f"goal_m: within {GOAL_RADIUS_M:g} m of start_m, so a flight is over at its start"
    if not scene.vehicle.is_rigid:
        yield "vehicle.inertia_kgm2: no rigid body has a moment above the sum of the others"
    if scene.vehicle.thrust_to_weight <= 1:
        ratio = scene.vehicle.thrust_to_weight
        yield f"vehicle: thrust over weight is {ratio:.2f}, so it cannot lift itself"


def _not_free(scene: Scene, place: str, at: Point) -> Iterator[str]:
    bounds = scene.bounds
    if not all(a < p < b for p, a, b in zip(at, bounds.low_m, bounds.high_m, strict=True)):
        yield f"{place}: {at} lies outside the bounds"
    elif (free := clearance_m(scene, at)) < COLLISION_RADIUS_M:
        where = "lies in an obstacle" if free < 0 else f"is {free:.2f} m from a surface"
        yield f"{place}: {at} {where}; the vehicle needs {COLLISION_RADIUS_M:g} m around it"


def _points(scene: Scene) -> Iterator[tuple[str, tuple[float, ...]]]:
    yield "bounds.low_m", scene.bounds.low_m
    yield "bounds.high_m", scene.bounds.high_m
    yield "start_m", scene.start_m
    yield "goal_m", scene.goal_m
    yield "start_yaw_rad", (scene.start_yaw_rad,)
    for index, box in enumerate(scene.boxes):
        yield f"boxes.{index}", (*box.centre_m, *box.half_extents_m, box.yaw_rad)
    for index, pillar in enumerate(scene.cylinders):
        sizes = (pillar.radius_m, pillar.low_m, pillar.high_m)
        yield f"cylinders.{index}", (*pillar.centre_m, *sizes)


FORMAT = "faultpath-scenes/1"

FROZEN = ("training", "selection", "held-out", "confirmation", "decision")
"""The libraries of the package, 100 scenes each [paper, setup]; `confirmation` has 300 and
`decision` 400."""


@dataclass(frozen=True)
class SceneLibrary:
    """Scenes that belong together."""

    name: str
    scenes: tuple[Scene, ...]  # in order; scene i has index i
    content_hash: str  # hexadecimal digest of the name and of every scene

    @classmethod
    def of(cls, name: str, scenes: tuple[Scene, ...]) -> "SceneLibrary":
        """Return the library of some scenes, with its hash."""
        return cls(name, scenes, digest([name, *(scene.content_hash for scene in scenes)]))


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
