"""Another conclusion from the same trials, as data."""

from faultpath.results import Result
from faultpath.statistics import RuleName


class EarlierLook(Result):
    """What was asked when an audit was concluded before; a record cannot allow for that."""

    scenes: int | None
    """`None` of a sequential audit, which allows for its number."""
    primary: str
    generalise: str = "scenes"
    rule: RuleName = "exact"
