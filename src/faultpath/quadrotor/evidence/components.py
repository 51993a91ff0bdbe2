"""What the components of the quadrotor's vectors are called in a report.

East is to the right of a scene seen from above, north is up there. They stand here and not in
`interface.yaml`, which is among what flies.
"""

from typing import Final

WORLD: Final = ("east", "north", "up")
_RATES = ("roll", "pitch", "yaw")

COMPONENTS: Final = {
    **dict.fromkeys(("position_estimate", "velocity_estimate", "mission_goal"), WORLD),
    **dict.fromkeys(("zero_wind", "reconstructed_wind", "true_wind"), WORLD),
    **dict.fromkeys(("vehicle.position", "vehicle.velocity"), WORLD),
    **dict.fromkeys(("body_rate_measurement", "vehicle.body_rate"), _RATES),
    "commanded_action": ("thrust", "roll rate", "pitch rate", "yaw rate"),
    "geofence": ("lowest", "highest"),
}
