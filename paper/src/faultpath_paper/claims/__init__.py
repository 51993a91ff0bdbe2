"""The paper's claims: what each consists of, and what a run says of it."""

from collections.abc import Mapping, Sequence

from faultpath_paper.answers import ClaimVerdict, Ledger
from faultpath_paper.cells import published_claims
from faultpath_paper.claims import (
    calibration,
    compensation,
    others,
    paying,
    predictors,
    shared,
    wind,
)
from faultpath_paper.claims.statement import Statements, verdict
from faultpath_paper.results import Results

SUBJECTS: Mapping[str, Mapping[str, Statements]] = {
    "Predictors (Table I)": predictors.CLAIMS,
    "Calibration errors (Table II, Figure 3)": calibration.CLAIMS,
    "Wind (Table III)": wind.CLAIMS,
    "Shared errors (Tables IV, VI (b))": shared.CLAIMS,
    "Compensation (Table VI (a))": compensation.CLAIMS,
    "Decision record (Table V)": paying.CLAIMS,
    "Histories, planning, perception (text)": others.CLAIMS,
}
"""The claims by what they are about, and where the paper has it."""
STATEMENTS: Mapping[str, Statements] = {
    claim: statements for claims in SUBJECTS.values() for claim, statements in claims.items()
}
"""What each claim consists of, by its id."""


def evaluate(results: Results) -> tuple[ClaimVerdict, ...]:
    """Answer every published claim, in the paper's order; what was not run leaves it undecided."""
    return tuple(verdict(claim, STATEMENTS[claim.id], results) for claim in published_claims())


def ledger(
    results: Results,
    library: str,
    library_hash: str,
    scenes: int,
    seeds: Sequence[int],
    *,
    only_run: bool = False,
) -> Ledger:
    """Return all answers with what they were answered on.

    `only_run` leaves claims out of which a part was not run: a run of some pages is not about them.
    """
    every = evaluate(results)
    kept = [c for c in every if not (only_run and any(part.not_run for part in c.parts))]
    return Ledger(
        library=library,
        library_hash=library_hash,
        scenes=scenes,
        seeds=tuple(seeds),
        claims=tuple(kept),
        left_out=len(every) - len(kept),
    )


def again(results: Results, old: Ledger) -> Ledger:
    """Return a ledger answered anew, every claim of it, by the rules that are here."""
    return ledger(results, old.library, old.library_hash, old.scenes, old.seeds)
