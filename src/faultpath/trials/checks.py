"""What a system of one's own must be like, so that nothing fails halfway for want of it."""

from collections.abc import Iterable, Mapping
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, cast

from faultpath.errors import SystemMistake, UserError
from faultpath.interface import Interface
from faultpath.taps.tap import wire
from faultpath.text import one_line, steers

if TYPE_CHECKING:
    from faultpath.trials.system import Library, SceneRef, System, Variant

_LONGEST_NAME = 200
_LARGEST_INDEX = 2**63 - 1
"""What the tables hold."""


def check_name(what: str, name: Any) -> None:
    """Raise `SystemMistake` for what cannot be a name in tables, files and on the terminal."""
    if not isinstance(name, str):
        raise SystemMistake(f"{what} is {_shown(name)}: it must be text")
    if not name:
        raise SystemMistake(f"{what} is empty: give it a name")
    if len(name) > _LONGEST_NAME:
        raise SystemMistake(
            f"{what} has {len(name)} characters: a name has at most {_LONGEST_NAME}"
        )
    if steers(name):
        raise SystemMistake(f"{what} is {_shown(name)}: a name holds no control characters")


def check_scene(scene: "SceneRef") -> None:
    """Raise `SystemMistake` for a scene that no table could hold."""
    check_name("the id of a scene", scene.id)
    index: Any = scene.index
    if not isinstance(index, Integral) or not 0 <= int(index) <= _LARGEST_INDEX:
        raise SystemMistake(
            f"scene '{scene.id}' has the index {_shown(index)}: it is its place in the library, a "
            "whole number from 0 to 2^63 - 1"
        )
    if scene.topology != "":
        check_name(f"the topology of scene '{scene.id}'", scene.topology)


def check_library(library: "Library") -> None:
    """Raise `SystemMistake` for scenes that are none, or that share a name."""
    from faultpath.trials.system import SceneRef

    check_name("the name of a library", library.name)
    said = f"library '{library.name}'"
    check_name(f"the content hash of {said}", library.content_hash)
    seen: set[str] = set()
    for scene in _items(f"{said}: scenes", library.scenes):
        if not isinstance(scene, SceneRef):
            raise SystemMistake(f"{said} holds {_shown(scene)}: every scene is a SceneRef")
        if scene.id in seen:
            raise SystemMistake(f"{said} holds scene '{scene.id}' twice: name each scene once")
        seen.add(scene.id)


def library_of(system: "System", name: str) -> "Library":
    """Return a library of a system; `SystemMistake` for what is none, `UserError` for no name."""
    from faultpath.trials.system import Library

    found: Any = system.library(name)
    if not isinstance(found, Library):
        raise SystemMistake(
            f"system '{system.name}': `library` returned {_shown(found)}: it must return a Library"
        )
    return found


def fingerprint_of(system: "System") -> str:
    """Return what the system says of itself; `SystemMistake` for what is no text."""
    found: Any = system.fingerprint()
    if not isinstance(found, str):
        raise SystemMistake(
            f"system '{system.name}': `fingerprint` returned {_shown(found)}: it must return text"
        )
    return found


def check_variant(variant: "Variant") -> None:
    """Raise `SystemMistake` for a variant whose parts are of other types than declared."""
    check_name("the name of a variant", variant.name)
    said = f"variant '{variant.name}'"
    for what in ("consumers", "privileged"):
        for name in _items(f"{said}: {what}", getattr(variant, what)):
            check_name(f"{said}: one of {what}", name)
    bindings: Any = variant.bindings
    if not isinstance(bindings, Mapping):
        raise SystemMistake(f"{said}: bindings is {_shown(bindings)}: map channels to sources")


def check_system(system: "System", name: str) -> None:
    """Raise `SystemMistake` unless `system` declares what every audit asks of it.

    `name` is what the user calls it by.
    """
    from faultpath.trials.system import Variant

    said = f"system {name!r}"
    check_name(f"{said}: `name`", _declared(system, "name", said))
    step = _declared(system, "control_dt_s", said)
    if not isinstance(step, Real) or not 0 < float(step) < float("inf"):
        raise SystemMistake(
            f"{said}: `control_dt_s` is {_shown(step)}: give the seconds of a control step"
        )
    block: Any = system.block_size
    if not isinstance(block, Integral) or int(block) < 1:
        raise SystemMistake(
            f"{said}: `block_size` is {_shown(block)}: give a whole number, 1 or more"
        )
    interface = _declared(system, "interface", said)
    if not isinstance(interface, Interface):
        raise SystemMistake(
            f"{said}: `interface` is {_shown(interface)}: give what `read_interface` returns"
        )
    variants = _declared(system, "variants", said)
    if not isinstance(variants, Mapping) or not variants:
        raise SystemMistake(f"{said}: `variants` is {_shown(variants)}: map names to variants")
    for key, variant in cast("Mapping[Any, Any]", variants).items():
        if not isinstance(variant, Variant) or variant.name != key:
            raise SystemMistake(
                f"{said}: `variants` holds {_shown(variant)} under {_shown(key)}: map the name of "
                "each Variant to it"
            )
        try:
            wire(interface, variant.bindings, variant.consumers, variant.privileged, 0)
        except UserError as error:
            raise SystemMistake(f"{said}: variant '{key}': {error}") from None


def _declared(system: "System", attribute: str, said: str) -> Any:
    try:
        found = getattr(system, attribute)
    except AttributeError:
        if hasattr(type(system), attribute):  # a property of the system's that fails
            raise
        found = None
    if found is None:
        raise SystemMistake(f"{said} declares no `{attribute}`: set it in the class")
    return found


def _items(what: str, found: Any) -> Iterable[Any]:
    if isinstance(found, (str, bytes)) or not isinstance(found, Iterable):
        raise SystemMistake(f"{what} is {_shown(found)}: give several, as a tuple or a set")
    return cast("Iterable[Any]", found)


def _shown(found: Any) -> str:
    text = one_line(repr(found))
    return text if len(text) <= 80 else f"{text[:80]}…"
