"""What the numbers of a reading are called, where there are several.

It is for pictures only: nothing that flies reads it, so naming them makes no trial stale.
"""

import importlib
import math
from collections.abc import Mapping, Sequence
from typing import TypeAlias, cast

from faultpath.errors import SystemMistake
from faultpath.trials import System

Components: TypeAlias = Mapping[str, Sequence[str]]
"""By source, or by `plant.truth` as for signals: a name for each number of a reading."""

_ELSEWHERE = {"faultpath.quadrotor.system": "faultpath.quadrotor.evidence.components"}
"""By the module of a system: that with its `COMPONENTS`, where its own code must stay as it flew.
They are strings, so that naming one imports nothing."""


def components_of(system: System) -> Components:
    """Return what a system names, as its attribute `components`: source to names.

    `SystemMistake` where these are not as many as a reading has numbers.
    """
    place = _ELSEWHERE.get(type(system).__module__)
    if place:
        return cast("Components", importlib.import_module(place).COMPONENTS)
    named = cast("object", getattr(system, "components", {}))
    shapes = {source.name: source.shape for source in system.interface.sources}
    if not isinstance(named, Mapping):
        raise SystemMistake(f"system '{system.name}': `components` is no mapping of sources")
    for source, names in cast("Mapping[str, object]", named).items():
        if source not in shapes:
            raise SystemMistake(f"system '{system.name}': `components` names no source '{source}'")
        many = math.prod(shapes[source])
        words = list(cast("Sequence[object]", names)) if isinstance(names, (list, tuple)) else []
        if len(words) != many or not all(isinstance(each, str) and each for each in words):
            raise SystemMistake(
                f"system '{system.name}': `components` has to name the {many} of '{source}'"
            )
    return cast("Components", named)
