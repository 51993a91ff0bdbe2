"""Several sizes of one fault decided as one family: from the records of their audits."""

from collections.abc import Collection, Sequence

from faultpath.analyses.contrasts import alpha_shares, change_name, effect_name
from faultpath.analyses.model import AuditResult
from faultpath.stats.decisions import holm
from faultpath.stats.estimate import ALPHA, Sign


def contrasts(record: AuditResult) -> dict[str, tuple[float, float]]:
    """Return p and weight of every contrast that a record tested, by its name."""
    tested = [effect for effect in record.effects if effect.corrected_p is not None]
    p_values = {effect_name(effect.condition): effect.p_value for effect in tested}
    p_values |= {change_name(change.isolated): change.p_value for change in record.changes}
    parts = alpha_shares([effect.condition for effect in tested], record.facts.primary)
    return {name: (p, parts[name]) for name, p in p_values.items()}


def decide_sizes(
    records: Sequence[AuditResult], once: Collection[str] = ()
) -> list[dict[str, tuple[Sign, float]]]:
    """Return for each size, by condition, the side that is decided over all sizes, and the adjusted
    p.

    Holm's procedure over every contrast of every size, weighted as each audit by itself: whatever
    is decided then holds with an error of at most 5 % for all sizes together. A size decides no
    more than by itself. Contrasts named in `once` are the same trials at every size, and one.
    """

    def key(size: int, name: str) -> str:
        return name if name in once else f"{size}/{name}"

    tested = {
        key(size, name): contrast
        for size, record in enumerate(records)
        for name, contrast in contrasts(record).items()
    }
    adjusted = holm(
        {name: p for name, (p, _) in tested.items()},
        {name: weight for name, (_, weight) in tested.items()},
    )
    families: list[dict[str, tuple[Sign, float]]] = []
    for size, record in enumerate(records):
        family: dict[str, tuple[Sign, float]] = {}
        for effect in record.effects:
            if effect.corrected_p is not None:
                p = adjusted[key(size, effect_name(effect.condition))]
                family[effect.condition] = effect.sign if p <= ALPHA else 0, p
        families.append(family)
    return families
