"""Which columns of a log hold what, in which units and frames."""

from importlib import resources
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.files.plain import Misread, read_yaml

HEAVIEST_KG = 1e6
Mass: TypeAlias = Annotated[float, Field(ge=1e-6, le=HEAVIEST_KG)]
Drag: TypeAlias = Annotated[float, Field(ge=1e-9, le=1e6)]
Factor: TypeAlias = Annotated[float, Field(ge=-1e9, le=1e9)]
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
SPEED_UNITS = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
PX4 = "px4"
"""The map that ships, for ULog files of PX4."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class TimeColumn(_Frozen):
    """When a row was recorded; ULog files bring a time with every message, and need none."""

    column: str
    unit: Literal["s", "ms", "us", "ns"]


class Attitude(_Frozen):
    """A unit quaternion from the body to the world."""

    columns: tuple[str, str, str, str]
    order: Literal["wxyz", "xyzw"]


class Velocity(_Frozen):
    """Velocity in the world frame."""

    columns: tuple[str, str, str]
    unit: Literal["m/s", "cm/s", "mm/s"] = "m/s"


class Thrust(_Frozen):
    """The collective thrust that was commanded."""

    column: str
    newton_per_unit: Factor | Literal["fit"] = 1.0
    """`fit` chooses the factor with which thrust explains the motion best, as for normalised
    commands; the sign is then found as well."""


class ColumnMap(_Frozen):
    """What a log's columns mean, and what is known of its vehicle."""

    time: TimeColumn | None = None
    attitude: Attitude
    velocity: Velocity
    thrust: Thrust
    frame: Literal["NED", "ENU"]
    """NED with a body whose z axis points down, or ENU with one whose z axis points up."""
    mass_kg: Mass | None = None
    drag_kgps: tuple[Drag, Drag, Drag] | None = None
    """Linear drag along the body's axes; `None`: what thrust and weight leave is one force."""
    motor_time_constant_s: float = Field(default=0.0, ge=0, le=60)

    @property
    def names(self) -> tuple[str, ...]:
        """The columns that are read, time apart."""
        return (*self.attitude.columns, *self.velocity.columns, self.thrust.column)


def read_columns(where: str) -> ColumnMap:
    """Return the map in a YAML file, or the one that ships as `px4`.

    Raises `UserError` for a file that cannot be read or says something else.
    """
    try:
        if where == PX4:
            data = resources.files("faultpath.flightlog").joinpath("px4.yaml").read_bytes()
        else:
            data = contents(where)
        return read_yaml(data).fill(ColumnMap)
    except OSError as error:
        raise UserError(
            f"{where}: cannot be read ({error.strerror}): give the YAML file that says which "
            "columns hold what, or px4"
        ) from None
    except Misread as error:
        raise UserError(f"{error.at(where)}; see the example in docs/recorded-flights.md") from None
