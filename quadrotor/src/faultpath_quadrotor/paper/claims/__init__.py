"""The paper's claims: what each consists of, and what a run says of it."""

from collections.abc import Mapping, Sequence

from faultpath_quadrotor.paper.answers import ClaimVerdict, Ledger
from faultpath_quadrotor.paper.cells import published_claims
from faultpath_quadrotor.paper.claims import (
    calibration,
    compensation,
    others,
    paying,
    predictors,
    shared,
    wind,
)
from faultpath_quadrotor.paper.claims.statement import Statements, verdict
from faultpath_quadrotor.paper.results import Results

STATEMENTS: Mapping[str, Statements] = {
    claim: statements
    for subject in (predictors, calibration, wind, shared, compensation, paying, others)
    for claim, statements in subject.CLAIMS.items()
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
