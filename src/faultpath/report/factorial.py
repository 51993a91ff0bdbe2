"""Main effects and interactions of a factorial as a table."""

from faultpath.record.factors import OUTCOMES, FactorialEffect
from faultpath.record.model import DecisionRecord
from faultpath.report import wording
from faultpath.tables import Entry, Table, line


def by_factors(record: DecisionRecord) -> Table | None:
    """Return the effects of a factorial, main effects first; `None` where none was asked for.

    Bold is decided within the family of the factorial.
    """
    found, asked = record.factorial, record.question
    if found is None:
        return None
    held = {(each.factors, each.of): each for each in found.effects}
    lines = tuple(
        line(" × ".join(factors), *(_entry(held[factors, of]) for of in OUTCOMES))
        for factors in dict.fromkeys(each.factors for each in found.effects)
    )
    return Table(
        title=f"Factorial of the fault over {', '.join(found.factors)}: effects on success, pp",
        corner="struck",
        columns=(asked.baseline, asked.repair, f"{asked.repair} minus {asked.baseline}"),
        lines=lines,
        notes=tuple(map(wording.typeset, found.words)),
    )


def _entry(found: FactorialEffect) -> Entry:
    return Entry(text=wording.with_interval(found.effect), detected=found.sign != 0)
