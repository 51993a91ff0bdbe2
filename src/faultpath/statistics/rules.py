"""The rules by which audits with a fixed number of scenes are decided, and since when."""

from typing import Literal, NamedTuple, TypeAlias

RuleName: TypeAlias = Literal["exact", "unconditional"]


class Rule(NamedTuple):
    """How effects are tested and adjusted for each other."""

    tests: str
    """In words."""
    weighted: bool
    """Whether half of the error rate is the primary contrast's, and the others share the rest."""
    prior: float
    """Of `score.reach`: scenes of the largest possible difference that several seeds are given."""
    period: str
    """When audits took it unless told otherwise."""

    @property
    def words(self) -> str:
        """The rule and its time."""
        return f"{self.tests}, in force {self.period}"


RULES: dict[RuleName, Rule] = {
    "exact": Rule("exact McNemar or sign test and Holm", False, 3.0, "until 2026-11-22"),
    "unconditional": Rule(
        "E+M test (sign flips and score of several seeds and changes) and weighted Holm",
        True,
        12.0,
        "since 2026-11-23",
    ),
}
IN_FORCE: RuleName = "unconditional"
EM = "E+M (Lloyd)"
"""Name of the test of one seed under the rule in force."""
FLIPS = "sign flips and score of scenes"
"""Name of that of several seeds, and of changes."""
