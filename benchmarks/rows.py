"""All rows of the benchmarks, as `rows.yaml` has them: sides that are compared, and targets."""

from pathlib import Path

import yaml
from pydantic import BaseModel

from benchmarks.results import Target


class MeasuredSide(BaseModel):
    build: str
    environment: dict[str, str] = {}
    once: bool = False
    python: str = ""


class Row(BaseModel):
    name: str
    unit: str
    ours: str
    peer: str = ""
    target: Target | None = None


_STORED = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text("utf-8"))
SIDES = {name: MeasuredSide(**side) for name, side in _STORED["sides"].items()}
ROWS = tuple(Row(**row) for row in _STORED["rows"])
