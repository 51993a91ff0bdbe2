"""Wording of the figures of claims, on the page and in the terminal."""

import re
from collections.abc import Sequence

from faultpath.core.text import capital, counted
from faultpath.report.escapes import unbroken
from faultpath.report.sentences import wording
from faultpath_paper.answers import Answer, ClaimVerdict, Ledger, Size, StatementPart
from faultpath_paper.cells import data

QUICK = "quick"
"""The profile whose runs are too small to be compared with the paper."""
_WORDS = data("words.yaml")
VERDICTS, NON_DETECTION = _WORDS["verdicts"], _WORDS["non_detection"]
SIGNS: dict[Answer, str] = _WORDS["signs"]
SHOWN: dict[Answer, str] = _WORDS["answers"]
"""How pages call an answer of the ledger."""
ANSWERS: tuple[Answer, ...] = tuple(SHOWN)
BESIDE: dict[Size, str] = _WORDS["sizes"]
"""How pages call a size: what our figure is beside the paper's."""
_COUNTED_SIZES: dict[Size, tuple[str, str]] = _WORDS["counted_sizes"]
"""The same of one figure and of several."""
SIZES: tuple[Size, ...] = tuple(_COUNTED_SIZES)
"""From the nearest to the paper's figure to the farthest."""
KINDS: dict[str, str] = _WORDS["kinds"]
"""Names of the kinds of claims: findings are tested, properties were matched beforehand."""
KIND: dict[str, str] = _WORDS["kind"]
"""The same of one claim."""
_HYPHEN_FOR_MINUS = re.compile(r"(?<![\w.)\]])-(?=\d)")
_SIGNS_IN_TEXT = ((">=", "≥"), ("<=", "≤"), ("->", "→"))
_DIGITS = {"pp": 1, "percent": 1, "cm": 1, "errors": 0, "seeds": 0}
_COUNTED = ("errors", "seeds")
_DIFFERENCES = ("pp", "s", "m")
_SHARES = {"times": "×", "percent": " %"}
"""Units that are not those of a difference, as written behind a number."""


def typeset(text: str) -> str:
    """Return a claim's words with the signs that plain text has no letters for."""
    for plain, sign in _SIGNS_IN_TEXT:
        text = text.replace(plain, sign)
    return _HYPHEN_FOR_MINUS.sub(wording.MINUS, text)


def on_page(text: str) -> str:
    """Return these words for a page, where no line breaks between a number and its unit."""
    return unbroken(typeset(text))


def figure(of: ClaimVerdict | StatementPart) -> str:
    """Return the estimate with its unit, nothing without one; differences carry their sign."""
    if of.estimate is None:
        return ""
    write = wording.signed if of.unit in _DIFFERENCES else wording.plain
    if of.unit in _COUNTED:
        return counted(round(of.estimate), of.unit.removesuffix("s"))
    return f"{write(of.estimate, _DIGITS.get(of.unit, 2))}{behind(of.unit)}"


def interval(of: ClaimVerdict | StatementPart) -> str:
    """Return `[48.3, 66.3]`, or nothing without an interval."""
    return wording.bracket(of.interval, _DIGITS.get(of.unit, 2)) if of.interval else ""


def estimate(of: ClaimVerdict | StatementPart) -> str:
    """Return estimate and interval; nothing where there is no estimate."""
    return f"{figure(of)} {interval(of)}".rstrip() if figure(of) else ""


def least_detectable(of: ClaimVerdict | StatementPart) -> str:
    """Return the minimum detectable difference from 0; nothing where there is none."""
    if of.mde is None or of.unit in _SHARES:
        return ""
    return f"{wording.plain(of.mde, _DIGITS.get(of.unit, 2))}{behind(of.unit)}"


def evidence(part: StatementPart) -> tuple[str, ...]:
    """Return the evidence for a part's answer, phrase by phrase."""
    p_value = "" if part.p_value is None else wording.p_equals(part.p_value)
    detectable = least_detectable(part)
    phrases = (
        f"{p_value} ({part.test})" if p_value and part.test else p_value or part.test,
        detectable and f"smallest detectable difference {detectable}",
        part.score
        and f"score interval {interval(part.model_copy(update={'interval': part.score}))}",
        part.counts and f"scenes in which only one succeeds, first:second by seed, {part.counts}",
        papers(part) and f"the paper {papers(part)}: {BESIDE[part.size]}",
        part.reason,
    )
    return tuple(phrase for phrase in phrases if phrase)


def papers(part: StatementPart) -> str:
    """Return the paper's figure for a part as ours is written; nothing where it prints none."""
    theirs = {"estimate": part.paper, "interval": part.paper_interval}
    return estimate(part.model_copy(update=theirs)) if part.unit else ""


def farthest(claim: ClaimVerdict) -> Size:
    """Return the size that is farthest from the paper's figure, of the parts that have one."""
    compared: list[Size] = [part.size for part in claim.parts if part.size in SIZES]
    return max(compared, key=SIZES.index) if compared else "not comparable"


def size(claim: ClaimVerdict) -> str:
    """Return how our figures stand to the paper's; nothing where the paper prints none."""
    sizes: list[Size] = [part.size for part in claim.parts if part.paper is not None]
    if not sizes:
        return ""
    return counts(sizes) or BESIDE["not comparable"]


def counts(sizes: Sequence[Size]) -> str:
    """Return `2 figures agree, 1 has a different size`; nothing where none can be compared."""
    compared = [size for size in sizes if size in SIZES]
    clauses: list[str] = []
    for size in SIZES:
        if count := compared.count(size):
            number = str(count) if clauses else counted(count, "figure")
            clauses.append(f"{number} {_COUNTED_SIZES[size][count > 1]}")
    return ", ".join(clauses)


def sizes(ledger: Ledger) -> str:
    """Return in one sentence how our figures stand to those that the paper prints."""
    parts = [part for claim in ledger.claims for part in claim.parts]
    printed: list[Size] = [part.size for part in parts if part.paper is not None]
    compared: list[Size] = [label for label in printed if label in SIZES]
    if not printed:
        return ""
    figures = counted(len(printed), "figure")
    if not compared:
        return f"The paper prints {figures} for these claims; this run can be compared with none."
    return (
        f"The paper prints {figures} for these claims, of which {len(compared)} can be compared "
        f"with ours: {counts(compared)}."
    )


def headline(ledger: Ledger, profile: str) -> str:
    """Return the outcome of all claims in one sentence, kind by kind; a quick run has none."""
    if profile == QUICK:
        return "The quick profile tests the pipeline and says nothing about the paper’s claims"
    clauses = [tally(ledger, kind) for kind in KINDS if any(c.kind == kind for c in ledger.claims)]
    return capital("; ".join(clauses)) or "This run is about none of the paper’s claims"


def tally(ledger: Ledger, kind: str) -> str:
    """Return how many claims of a kind got which answer, as a clause."""
    verdicts = [claim.verdict for claim in ledger.claims if claim.kind == kind]
    confirmed, refuted, undecided = map(verdicts.count, ANSWERS)
    about = " that this run is about" if ledger.left_out else ""
    if kind == "finding":
        return (
            f"Of the paper’s {counted(len(verdicts), 'finding')}{about}, {confirmed} "
            f"{'was' if confirmed == 1 else 'were'} reproduced, {refuted} "
            f"{'was' if refuted == 1 else 'were'} refuted and {undecided} "
            f"{'is' if undecided == 1 else 'are'} inconclusive"
        )
    noun, hold = "property" if len(verdicts) == 1 else "properties", "hold" + "s" * (confirmed == 1)
    return (
        f"of {len(verdicts)} {noun} that the simulator was matched to, {confirmed} {hold} on these "
        "scenes"
    )


def is_non_detection(claim: ClaimVerdict) -> bool:
    """Return whether a claim is confirmed by differences that are not significant."""
    return claim.verdict == "confirmed" and all(NOT_SIGNIFICANT in p.words for p in claim.parts)


NOT_SIGNIFICANT = "is not significantly"


def behind(unit: str) -> str:
    """Return a unit as written behind a number."""
    return _SHARES.get(unit, f" {unit}" if unit else "")
