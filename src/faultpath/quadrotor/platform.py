"""What the platform search froze, as one hash."""

import hashlib
import json
from dataclasses import asdict
from typing import Any

from faultpath.quadrotor.options import PlannerSettings
from faultpath.quadrotor.perception import camera, seen
from faultpath.quadrotor.vehicle import VehicleParameters, VehicleRanges
from faultpath.quadrotor.wind import WIND_LEVELS


def platform() -> dict[str, Any]:
    """Return planner settings, wind levels, vehicles and what perception decides, as plain data."""
    return {
        "perception": {
            "width": camera.WIDTH,
            "height": camera.HEIGHT,
            "field_of_view_deg": camera.FIELD_OF_VIEW_DEG,
            "range_m": camera.RANGE_M,
            "unseen_m": seen.UNSEEN_M,
            "near_m": seen.NEAR_M,
        },
        "planner": PlannerSettings().model_dump(mode="json"),
        "wind": {name: asdict(level) for name, level in WIND_LEVELS.items()},
        "vehicle": VehicleParameters().model_dump(mode="json"),
        "ranges": asdict(VehicleRanges()),
    }


def platform_hash() -> str:
    """Return the hash of the platform; `docs/design/platform-search/frozen.json` holds it."""
    content = json.dumps(platform(), sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()[:16]
