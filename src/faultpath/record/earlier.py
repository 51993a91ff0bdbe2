"""Another conclusion from the same trials, as data."""

from faultpath.frozen import Frozen
from faultpath.statistics import RuleName


class EarlierLook(Frozen):
    """What was asked when an audit was concluded before; a record cannot allow for that."""

    scenes: int | None
    """`None` of a sequential audit, which allows for its number."""
    primary: str
    generalise: str = "scenes"
    rule: RuleName = "exact"
