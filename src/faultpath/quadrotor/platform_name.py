"""Names of platforms, apart from all that a platform is: listing models must not load it."""

from enum import StrEnum

from faultpath.errors import UserError


class PlatformName(StrEnum):
    """Platforms that are frozen; `platforms.PLATFORMS` says what each is."""

    FIRST = "first"
    MATCHED = "matched"


DEFAULT_NAME = PlatformName.MATCHED
"""What flies, is fitted and is shown unless another one is asked for."""


def platform_name(text: str) -> PlatformName:
    """Return the frozen platform of that name; `UserError` where there is none."""
    try:
        return PlatformName(text)
    except ValueError:
        known = ", ".join(PlatformName)
        raise UserError(f"there is no platform '{text}': choose from {known}.") from None
