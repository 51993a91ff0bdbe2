"""The records of one question under several sizes of the fault, side by side."""

from collections.abc import Sequence

from faultpath.record.model import DecisionRecord
from faultpath.report import wording
from faultpath.tables import MISSING, Entry, Table, line


def by_size(records: Sequence[DecisionRecord]) -> Table:
    """Return the difference in success on each path, with a row for each size of the fault.

    Bold is decided within its own record.
    """
    titles = {path.name: path.title for record in records for path in record.paths}
    lines = [
        line(record.question.fault, *(_entry(record, path) for path in titles))
        for record in records
    ]
    asked = records[0].question
    return Table(
        title=f"{asked.repair} minus {asked.baseline}, success, pp",
        corner="Fault",
        columns=tuple(titles.values()),
        lines=tuple(lines),
        notes=(
            "Each size is an audit of its own: the correction is for the contrasts of one size, "
            "not for the number of sizes.",
        ),
    )


def _entry(record: DecisionRecord, path: str) -> Entry:
    effect = next((each for each in record.effects if each.path == path), None)
    if effect is None:
        return Entry(text=MISSING)
    value, interval = wording.signed(effect.success.value), wording.interval(effect.success)
    return Entry(text=f"{value} {interval or ''}".strip(), detected=effect.detected)
