"""The frozen platforms, and the one that flies unless another is asked for."""

from collections.abc import Mapping
from types import MappingProxyType

from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platform_name import DEFAULT_NAME, PlatformName

FIRST = Platform()

PLATFORMS: Mapping[PlatformName, Platform] = MappingProxyType({PlatformName.FIRST: FIRST})
DEFAULT = PLATFORMS[DEFAULT_NAME]


def name_of(platform: Platform) -> PlatformName | None:
    """Return the name under which a platform is frozen, `None` for one that is not."""
    return next((name for name, frozen in PLATFORMS.items() if frozen == platform), None)
