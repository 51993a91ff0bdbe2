"""The paper's claims: their statements, and a run's answers to them."""

from collections.abc import Mapping, Sequence

from faultpath_paper.answers import ClaimVerdict, Ledger
from faultpath_paper.cells import data, published_claims
from faultpath_paper.claims.statement import Statements, verdict
from faultpath_paper.claims.terms import statement
from faultpath_paper.results import Results

SUBJECTS: Mapping[str, Mapping[str, Statements]] = {
    subject: {
        claim: tuple(statement(*entry) for entry in entries.items())
        for claim, entries in claims.items()
    }
    for subject, claims in data("statements.yaml").items()
}
"""Claims by subject, with its place in the paper."""
STATEMENTS: Mapping[str, Statements] = {
    claim: statements for claims in SUBJECTS.values() for claim, statements in claims.items()
}
"""Statements of each claim, by its id."""


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
    """Return all answers, with the library, scenes and seeds of the run.

    `only_run` leaves claims out of which a part was not run: a run of some pages is not about them.
    """
    verdicts = evaluate(results)
    kept = [c for c in verdicts if not (only_run and any(part.not_run for part in c.parts))]
    return Ledger(
        library=library,
        library_hash=library_hash,
        scenes=scenes,
        seeds=tuple(seeds),
        claims=tuple(kept),
        left_out=len(verdicts) - len(kept),
    )


def again(results: Results, old: Ledger) -> Ledger:
    """Return a ledger with every claim answered again, by the rules of this code."""
    return ledger(results, old.library, old.library_hash, old.scenes, old.seeds)
