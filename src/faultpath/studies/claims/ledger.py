"""Every claim of the paper, answered from the tables of one run."""

from collections.abc import Mapping, Sequence

from faultpath.record import ClaimVerdict, Ledger
from faultpath.studies.claims import (
    calibration,
    compensation,
    others,
    paying,
    predictors,
    shared,
    wind,
)
from faultpath.studies.claims.statement import Statements, verdict
from faultpath.studies.published import published_claims
from faultpath.studies.results import Results

SUBJECTS = (predictors, calibration, wind, shared, compensation, paying, others)

STATEMENTS: Mapping[str, Statements] = {
    claim: statements for subject in SUBJECTS for claim, statements in subject.CLAIMS.items()
}
"""What each claim consists of, by its id."""

TOPICS: Mapping[str, tuple[str, ...]] = {
    title: tuple(subject.CLAIMS)
    for title, subject in (
        ("Predictors with correct inputs", predictors),
        ("Calibration error, and DCC against it", calibration),
        ("Wind and its reconstruction", wind),
        ("The same error isolated and shared", shared),
        ("Why: errors that cancel", compensation),
        ("When the repair pays", paying),
        ("Other", others),
    )
}
"""The claims by topic, by their ids."""

LIMITS = {
    claim: tuple(statement.limits for statement in statements)
    for claim, statements in STATEMENTS.items()
}
"""By claim, what each of its statements is decided at, in the unit of its estimate."""

UNMATCHED: Mapping[str, tuple[str, ...]] = {"first": ("C02", "C03")}
"""Platform claims, by platform, to whose figures it was not matched: it was frozen before."""


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
    note: str = "",
    platform: str = "first",
) -> Ledger:
    """Return all answers with what they were answered on; `note` and `platform` as in `Ledger`.

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
        note=note,
        platform=platform,
        unmatched=UNMATCHED.get(platform, ()),
    )


def again(results: Results, old: Ledger) -> Ledger:
    """Return a ledger answered anew, every claim of it, by the rules that are here."""
    asked = old.library, old.library_hash, old.scenes, old.seeds
    return ledger(results, *asked, note=old.note, platform=old.platform)
