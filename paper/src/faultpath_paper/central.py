"""The paper's central question, whether sharing the error reverses the ranking, and our answers.

Audits that ask it besides the reproduction itself stand in a file that comes with the package; the
last of them was designed to decide it, and leads.
Sentences come from what is significant, never from an estimate.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pydantic import TypeAdapter

from faultpath.core.results import Frozen
from faultpath.report.sentences import wording
from faultpath.report.tables import MISSING, Entry, Table, line
from faultpath.stats.estimate import Sign
from faultpath_paper.answers import Reproduction
from faultpath_paper.cells import data
from faultpath_paper.pages.table_4 import GRID, NAMES, PAGE
from faultpath_paper.report import words

CLAIM = "C26"
BASELINE, REPAIR = "gru", "gru+dcc"
ELSEWHERE = Path(__file__).parent / "data" / "reversal.json"
WEIGHTS = "checkpoints/gru-trajectory-0.safetensors"
"""Weights that are fitted anew for every change of the platform."""
_WORDS = data("words.yaml")
QUESTION, QUICK_RUN, COLUMNS = _WORDS["question"], _WORDS["quick_run"], tuple(_WORDS["columns"])


class PrintedEffect(Frozen):
    """Success of the retrained estimator minus the original one."""

    text: str
    """Percentage points with their interval, such as `+6.7 [3.0, 11.0]`."""
    sign: Sign
    """Side of zero on which a difference is detected; 0 where none is."""

    @classmethod
    def of(cls, text: str, detected: bool) -> "PrintedEffect":
        """Return the effect that a table prints."""
        if not detected:
            return cls(text=text, sign=0)
        return cls(text=text, sign=-1 if text.startswith(wording.MINUS) else 1)


class Case(Frozen):
    """A run that asks the question, and what it detected."""

    place: str
    """Such as `300 scenes of confirmation, seeds 0, 1, 2`."""
    isolated: PrintedEffect
    shared: PrintedEffect
    change: PrintedEffect | None = None
    """From the wrong values at the estimator alone to the shared ones, where a run tests that."""
    ahead: str | None = None
    """Who is ahead at which frequencies of the shared wrong values; empty for nobody, `None` where
    a run does not ask."""
    reversal: bool
    """Whether the run decides that the ranking reverses."""
    reversing: int | None = None
    """In how many trainings the estimates alone reverse, as the paper counts them."""
    trainings: int = 1
    weights: str = ""
    """Digest of `WEIGHTS` as it flew: runs with another one are of another platform."""


CASES: TypeAdapter[tuple[Case, ...]] = TypeAdapter(tuple[Case, ...])


def elsewhere() -> tuple[Case, ...]:
    """Return what audits besides the reproduction detected."""
    return CASES.validate_json(ELSEWHERE.read_bytes())


def case_of(reproduction: Reproduction) -> Case | None:
    """Return what a run of the paper detected, by the paper's rules; `None` without the claim."""
    ledger = reproduction.ledger
    claim = next((claim for claim in ledger.claims if claim.id == CLAIM), None)
    table = next((table for table in reproduction.tables if table.name == PAGE.name), None)
    if claim is None or table is None:
        return None
    labels = [row.label for row in table.lines]
    at = labels.index(f"{NAMES[REPAIR]} minus {NAMES[BASELINE]}, success (pp)")
    differences, intervals = table.lines[at + 1].entries, table.lines[at + 2].entries
    isolated, shared = (
        PrintedEffect.of(f"{difference.text} {ends.text}", difference.detected)
        for difference, ends in zip(differences[1:], intervals[1:], strict=True)
    )
    return Case(
        place=f"{ledger.scenes} scenes of {ledger.library}, {wording.seeds(ledger.seeds)}",
        isolated=isolated,
        shared=shared,
        reversal=claim.parts[0].answer == "confirmed",
        reversing=None if claim.parts[1].estimate is None else round(claim.parts[1].estimate),
        trainings=len(ledger.seeds),
    )


def answer(cases: Sequence[Case]) -> str:
    """Return our answer in a few words."""
    if not cases:
        return "No run here asked the paper's central question"
    lead = cases[-1]
    fell = lead.change is not None and lead.change.sign < 0
    if not (lead.isolated.sign > 0 >= lead.shared.sign and fell):
        return "We did not reproduce the paper's reversal"
    behind, runs = sum(case.reversal for case in cases), len(cases)
    lost = (
        f"in {behind} of our {runs} sets of scenes the retrained one even lost, as in the paper"
        if behind and runs > 1
        else f"a loss there, as in the paper, is {'' if behind else 'not '}shown"
    )
    return f"The gain does not carry over to the shared error; {lost}"


def detail(cases: Sequence[Case]) -> str:
    """Return what the answer rests on, which is the last run, and which other one reverses."""
    if not cases:
        return ""
    *others, lead = cases
    alone = clause("With wrong values at the wind estimator alone", lead.isolated)
    shared = clause("with the predictor sharing them", lead.shared)
    parts = [f"{alone}; {shared} ({lead.place})."]
    if lead.change is not None:
        state = "significant" if lead.change.sign else "not significant"
        parts.append(f"The change between the two, {lead.change.text} pp, is {state}.")
    parts += [by_training(lead)]
    parts += [
        f"In {case.place}, the loss was significant ({case.shared.text} pp)."
        for case in others
        if case.reversal and not lead.reversal
    ]
    return " ".join(filter(None, parts))


def clause(where: str, effect: PrintedEffect) -> str:
    """Return what is significant under a condition, as a clause."""
    if not effect.sign:
        return f"{where} the difference between the two is not significant ({effect.text} pp)"
    than = "more" if effect.sign > 0 else "less"
    return f"{where} the retrained estimator succeeds {than} often ({effect.text} pp)"


def by_training(case: Case) -> str:
    """Return in how many trainings the estimates reverse, as the paper counts them."""
    if case.reversing is None or case.trainings == 1:
        return ""
    show = "shows" if case.reversing == 1 else "show"
    return (
        f"Taken one at a time, without a significance test, {case.reversing} of {case.trainings} "
        f"trained models {show} the reversal; in the paper all three do."
    )


def table_of(cases: Sequence[Case]) -> Table:
    """Return the question's numbers run by run, the paper's below."""
    theirs = (GRID.contrast(REPAIR, BASELINE, where) for where in GRID.columns[1:])
    printed = [
        f"{wording.signed(c.value)} {wording.bracket(c.interval or ())}" for c in theirs if c
    ]
    rows = [
        line(
            case.place[:1].upper() + case.place[1:],
            *(
                Entry(text=e.text, detected=bool(e.sign)) if e else MISSING
                for e in (case.isolated, case.shared, case.change)
            ),
            MISSING if case.ahead is None else case.ahead or "neither ahead at any frequency",
            "yes" if case.reversal else "not significant",
        )
        for case in reversed(cases)
    ]
    return Table(
        name="central",
        title="Success of the retrained wind estimator minus the original one (pp), strong wind",
        columns=COLUMNS,
        lines=(*rows, line("The paper", *printed, MISSING, MISSING, "yes")),
        words=COLUMNS[-2:],
        notes=(
            "".join(_terms(cases))
            + "Rows are separate tests; they are not compared with each other. Intervals of the "
            "paper and of its reproduction are percentile bootstraps of scenes, those of audits "
            "score intervals.",
        ),
    )


def _terms(cases: Sequence[Case]) -> Iterator[str]:
    """Explain the words of the table that a first reader does not know."""
    if any(case.ahead == "" for case in cases):
        yield (
            "Neither ahead at any frequency: however often the fault is shared, the difference is "
            "not significant. "
        )
    if len(cases) > 1:
        yield (
            "Each of our rows is a set of scenes of its own, all of them kept apart (held out) "
            "from those of training and tuning; seeds are trained models. "
        )


def shipped() -> str:
    """Return what audits of more scenes found, as the main job shows it below its own result."""
    cases = elsewhere()
    return (
        "\nThe same question with more scenes and trainings, as the package ships it (make "
        f"decision runs it again):\n{answer(cases)}. {detail(cases)}"
    )


def of_page(reproduction: Reproduction, data: Mapping[str, str]) -> tuple[str, str, Table] | None:
    """Return our answer, what it rests on, and its table for the page of a run.

    `data` are digests of the data that flew: what other platforms showed is left out. `None` where
    the run is not about the question; a quick run has only the answers of others.
    """
    if all(claim.id != CLAIM for claim in reproduction.ledger.claims):
        return None
    cases = tuple(case for case in elsewhere() if case.weights == data.get(WEIGHTS))
    if reproduction.profile != words.QUICK:
        own = case_of(reproduction)
        cases = (*([own] if own else []), *cases)
        return answer(cases), detail(cases), table_of(cases)
    return answer(cases), f"{detail(cases)} {QUICK_RUN}", table_of(cases)
