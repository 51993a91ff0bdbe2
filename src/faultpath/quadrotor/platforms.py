"""The frozen platforms, and the one that flies unless another is asked for."""

from collections.abc import Mapping
from types import MappingProxyType

from faultpath.quadrotor.perception import PerceptionSettings
from faultpath.quadrotor.planners import CostWeights
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platform import PlannerSettings, Platform, SceneVehicles
from faultpath.quadrotor.platform_name import DEFAULT_NAME, PlatformName

FIRST = Platform()

_WEIGHTS = CostWeights(goal=8.0, risk=36.0, margin_m=0.3, rate_effort=0.4, thrust_effort=12.0)
MATCHED = FIRST.with_drag((0.5, 0.5, 1.2)).model_copy(
    update={
        "planner": PlannerSettings(
            goal_running=0.4,
            weights=_WEIGHTS,
            running=_WEIGHTS.model_copy(update={"thrust_effort": 5.0}),
            temperature=0.1,
        ),
        "winds": Winds(means_mps=(0.0, 0.831, 1.766, 3.2), pool_mean_mps=(0.0, 6.0)),
        "scene_vehicles": SceneVehicles(drag_drawn=False),
        "perception": PerceptionSettings(unseen_m=0.3),
        "follows_motors": True,
    }
)
"""The one whose baselines are nearest the paper's: chosen by `tools/platform_search.py`."""

PLATFORMS: Mapping[PlatformName, Platform] = MappingProxyType(
    {PlatformName.FIRST: FIRST, PlatformName.MATCHED: MATCHED}
)
DEFAULT = PLATFORMS[DEFAULT_NAME]


def name_of(platform: Platform) -> PlatformName | None:
    """Return the name under which a platform is frozen, `None` for one that is not."""
    return next((name for name, frozen in PLATFORMS.items() if frozen == platform), None)
