"""A figure of lines of a study: what pages draw."""

from pydantic import BaseModel, ConfigDict


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Point(_Frozen):
    """One point of a series, with its interval."""

    x: float
    y: float
    low: float | None = None
    high: float | None = None


class Series(_Frozen):
    """One line of a figure."""

    label: str
    points: tuple[Point, ...]


class Sweep(_Frozen):
    """A figure of lines."""

    name: str
    title: str
    x_title: str
    y_title: str
    series: tuple[Series, ...]
    published: str
    """What the paper says of its figure."""
    notes: tuple[str, ...] = ()
