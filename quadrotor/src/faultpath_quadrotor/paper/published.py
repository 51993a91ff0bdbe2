"""The paper's figures and claims, read from the files that carry them."""

from functools import cache
from importlib.resources import files
from typing import Any, Literal, NamedTuple

import yaml
from pydantic import BaseModel, ConfigDict


class PublishedClaim(BaseModel):
    """A finding of the paper, stated so that our own runs can confirm or refute it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str
    kind: Literal["platform", "finding"]
    """`platform`: a property that the selection library could be used to match."""
    claim: str
    paper: str
    """What the paper reports."""


class Printed(NamedTuple):
    """A figure of the paper, in the unit of what is compared with it."""

    value: float
    interval: tuple[float, float] | None = None
    """95 %, where the paper prints one: a figure worked out from two others has none."""


def published(*keys: str | int) -> Any:
    """Return a figure of the paper by its keys in `paper/published.yaml`; `KeyError` for none."""
    found: Any = _figures()
    for key in keys:
        found = found[key]
    return found


def published_claims() -> tuple[PublishedClaim, ...]:
    """Return every claim of `paper/claims.yaml`, in its order."""
    return tuple(PublishedClaim.model_validate(entry) for entry in _read("claims.yaml"))


@cache
def _figures() -> Any:
    return _read("published.yaml")


def _read(name: str) -> Any:
    return yaml.safe_load((files("faultpath_quadrotor.paper") / "paper" / name).read_text("utf-8"))
