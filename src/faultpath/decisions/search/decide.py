"""From the faults tried and the confirming audit to the record, and what is said of it."""

from collections.abc import Iterator, Sequence

from faultpath.decisions.fault_groups import JOINED
from faultpath.decisions.model import DecisionRecord, Effect
from faultpath.decisions.search.model import ResolvedSearch, SearchRecord, Tried
from faultpath.decisions.sentences.answers import reach
from faultpath.decisions.sentences.headline import reversed_at
from faultpath.decisions.sentences.phrases import change
from faultpath.decisions.sentences.wording import counted, where

_OPEN = "Not confirmed is not absent: other faults within the bounds may reverse the ranking."
_WORSE = "Another fault within the bounds may be worse: none but this one was put to the test."


def best(tried: Sequence[Tried]) -> str:
    """Return the fault to be put to the test, the first of equals; empty where none showed that
    the isolated choice loses anything."""
    chosen = max(tried, key=lambda candidate: candidate.regret_pp)
    return chosen.fault if chosen.regret_pp > 0.0 else ""


def conclude(
    question: ResolvedSearch,
    tried: Sequence[Tried],
    confirmed: DecisionRecord | None,
    confirmation: str = "",
    failed: int = 0,
    findings: Sequence[str] = (),
) -> SearchRecord:
    """Return the record of a search; nothing is decided but what its confirming audit decides."""
    all_findings = (*findings, *(confirmed.findings if confirmed else ()))
    return SearchRecord(
        question=question,
        tried=tuple(tried),
        best=best(tried),
        confirmation=confirmation,
        confirmed=confirmed,
        failed=failed,
        headline=_headline(question, confirmed),
        sentences=tuple(_sentences(question, tried, confirmed)),
        findings=tuple(dict.fromkeys(all_findings)),
    )


def _headline(question: ResolvedSearch, confirmed: DecisionRecord | None) -> str:
    alone = where(question.bounds.isolated)
    if confirmed is None:
        return f"No reversal was confirmed: no fault that was tried showed one {alone}."
    if confirmed.few:
        return (
            f"No reversal was confirmed: {counted(confirmed.scenes, 'scene')} compared, and no "
            f"difference can be significant with fewer than {confirmed.scenes_needed}."
        )
    turned, fault = _turned(question, confirmed), confirmed.question.fault
    one = JOINED not in fault  # several do not fit into a headline
    if turned is None:
        return f"No reversal was confirmed {alone}{f', at {fault}' if one else ''}."
    return (
        f"A reversal was confirmed{f' at {fault}' if one else ''}: {confirmed.winner(turned.sign)} "
        f"is ahead {alone}, {confirmed.winner(-turned.sign)} with it shared."
    )


def _sentences(
    question: ResolvedSearch, tried: Sequence[Tried], confirmed: DecisionRecord | None
) -> Iterator[str]:
    isolated = question.bounds.isolated
    yield (
        f"{counted(len(tried), 'fault')} {'was' if len(tried) == 1 else 'were'} tried in "
        f"{counted(question.finding, 'scene')} that find; the seed of the search was "
        f"{question.search_seed}. What those scenes show is no evidence: it serves to choose "
        "a fault."
    )
    if confirmed is None:
        yield (
            "In those scenes no choice by the isolated fault lost anything under the shared one. "
            f"So nothing was put to the test: the {counted(question.confirming, 'scene')} that "
            "confirm were not run."
        )
        yield _OPEN
        return
    yield (
        f"One was chosen, {confirmed.question.fault}, and audited in "
        f"{counted(question.confirming, 'scene')} that confirm, which had no part in the choice. "
        "No other was audited, so nothing has to be corrected for the search; within the audit "
        "all contrasts are, as in any."
    )
    yield from (change(confirmed, e) for e in confirmed.changes if e.isolated == isolated)
    yield f"The audit says: {confirmed.headline}"
    yield from reach(confirmed)
    yield _WORSE if _turned(question, confirmed) else _OPEN


def _turned(question: ResolvedSearch, confirmed: DecisionRecord) -> Effect | None:
    """Return the isolated effect that sharing reverses, where that is decided."""
    effects = (
        effect for effect in reversed_at(confirmed) if effect.path == question.bounds.isolated
    )
    return next(effects, None)
