"""What a self-check found: for each kind of simulation one table of settings and a rate."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from faultpath.statistics.estimate import FrozenResult

Value: TypeAlias = int | float | str
Setting: TypeAlias = Mapping[str, Value]
Cell: TypeAlias = dict[str, Value]
"""A setting with what was measured in it: rate, then runs."""


class Section(FrozenResult):
    """One kind of simulation: ``rows`` under ``columns``, the last two being rate and runs.

    ``runs`` is 0 where the rate is exact, by enumeration.
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]

    def cells(self) -> list[Cell]:
        """Return each row as a mapping from its columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


class Report(FrozenResult):
    """A run of the self-check."""

    format: int = 1
    profile: str
    seconds: float
    sections: tuple[Section, ...]

    def text(self) -> str:
        """Return the report as JSON, one setting a line."""
        head = self.model_dump(mode="json", exclude={"sections"})
        parts = [
            f' {{"name": {json.dumps(each.name)}, "columns": {json.dumps(each.columns)},\n'
            + '  "rows": [\n'
            + ",\n".join(f"  {json.dumps(row)}" for row in each.rows)
            + "]}"
            for each in self.sections
        ]
        start = json.dumps(head).removesuffix("}")
        return f'{start}, "sections": [\n' + ",\n".join(parts) + "]}\n"

    def section(self, name: str) -> Section:
        """Return a section by its name; `KeyError` without it."""
        for section in self.sections:
            if section.name == name:
                return section
        raise KeyError(name)


@dataclass(frozen=True)
class Measured:
    """The rate found in one setting."""

    section: str
    setting: Setting
    rate: float
    runs: int
