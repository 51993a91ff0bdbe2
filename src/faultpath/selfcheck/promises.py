"""What the statistics promise, and which settings broke it by more than chance."""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

from faultpath.selfcheck.audits import EQUAL, REVERSAL, TRAININGS
from faultpath.selfcheck.coverage import BREAK_EVEN, INTERVAL, MODELS
from faultpath.selfcheck.detection import DETECTION
from faultpath.selfcheck.model import Cell, Report
from faultpath.selfcheck.plane import CORRELATION, EQUAL_MAPS, PLACES, TURNS
from faultpath.selfcheck.records import DYING, EXTENDED, LOPSIDED
from faultpath.selfcheck.sequential import ANY_LOOK, AT_ODDS, EVERY_LOOK


@dataclass(frozen=True)
class Promise:
    """The rate of every setting of a section lies between two limits."""

    section: str
    what: str
    least: float = 0.0
    most: float = 1.0
    concerns: Callable[[Cell], bool] = lambda _: True

    def broken(self, cell: Cell) -> bool:
        """Return whether a rate is beyond a limit by more than three standard errors."""
        rate, runs = float(cell["measured"]), float(cell["runs"])
        slack = [3.0 * sqrt(p * (1.0 - p) / runs) if runs else 0.0 for p in (self.least, self.most)]
        return rate < self.least - slack[0] or rate > self.most + slack[1]


PROMISES = (
    Promise(INTERVAL, "the 95 % interval of an effect covers the truth", least=0.93),
    Promise(BREAK_EVEN, "the break-even set covers the true frequency", least=0.93),
    Promise(
        MODELS,
        "the 95 % interval for newly trained models that do not differ covers the truth",
        least=0.93,
        concerns=lambda cell: not cell["own rates"],
    ),
    Promise(
        MODELS,
        "the 95 % interval for newly trained models, each with its own rate, covers the truth",
        least=0.9,
        concerns=lambda cell: bool(cell["own rates"]),
    ),
    Promise(
        DETECTION,
        "a true difference of the reported size is detected",
        0.75,
        0.85,
        concerns=lambda cell: cell["seeds"] == 1,
    ),
    Promise(
        DETECTION,
        "a true difference of the reported size is detected",
        least=0.7,
        concerns=lambda cell: cell["seeds"] != 1,
    ),
    Promise(EQUAL, "an audit of equal arms announces anything", most=0.05),
    Promise(
        REVERSAL,
        "an audit announces a reversal that is not there",
        most=0.015,
        concerns=lambda cell: cell["isolated pp"] == 0,
    ),
    Promise(
        TRAININGS,
        "equal methods are told apart by their trainings",
        most=0.05,
        concerns=lambda cell: cell["generalise"] == "models",
    ),
    Promise(EQUAL_MAPS, "a map of equal arms announces anything", most=0.05),
    Promise(
        PLACES,
        "the side that is decided at every place of a map is the true one",
        least=0.95,
        concerns=lambda cell: cell["straight"] == 1,
    ),
    Promise(CORRELATION, "the set of correlations covers the true one", least=0.93),
    Promise(
        TURNS,
        "all that a map says of its paths is true",
        least=0.95,
        concerns=lambda cell: cell["straight"] == 1,
    ),
    Promise(LOPSIDED, "an audit of lopsided arms of one mean announces anything", most=0.05),
    Promise(DYING, "an audit of equal arms, of which one dies, announces anything", most=0.05),
    Promise(
        EXTENDED,
        "an audit announces something after a look and does not say that there was one",
        most=0.05,
        concerns=lambda cell: cell["finding"] == "without",
    ),
    Promise(ANY_LOOK, "a sequential audit of equal arms announces anything at any look", most=0.05),
    Promise(AT_ODDS, "p and interval of a sequential audit say otherwise of 0", most=0.0),
    Promise(EVERY_LOOK, "the confidence sequence holds the truth at every look", least=0.95),
)


def failures(report: Report) -> list[str]:
    """Return one sentence for each setting that breaks a promise."""
    said: list[str] = []
    names = {section.name for section in report.sections}
    for promise in (each for each in PROMISES if each.section in names):
        for cell in report.section(promise.section).cells():
            if promise.concerns(cell) and promise.broken(cell):
                setting = ", ".join(f"{name} {value}" for name, value in list(cell.items())[:-2])
                limits = f"{promise.least:g} to {promise.most:g}"
                said.append(
                    f"{promise.what} in {cell['measured']} of cases, not in {limits}: {setting}."
                )
    return said
